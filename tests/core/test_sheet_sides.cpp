// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/sheet_sides.h"

#include <boost/test/unit_test.hpp>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(sheet_sides)

BOOST_AUTO_TEST_CASE(parted_by_the_same_sheet_only)
{
  const Sides above = side_of_sheet(0, true), below = side_of_sheet(0, false);
  const Sides other = side_of_sheet(7, false);
  BOOST_CHECK(parted(above, below) && parted(below, above));
  BOOST_CHECK(!parted(above, above) && !parted(above, 0) && !parted(above, other));
  BOOST_CHECK(parted(static_cast<Sides>(above | other),
                     static_cast<Sides>(above | side_of_sheet(7, true))));
}

BOOST_AUTO_TEST_SUITE_END()
