// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/edge_through_triangle.h"

#include <boost/test/unit_test.hpp>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(edge_through_triangle)

BOOST_AUTO_TEST_CASE(through_the_inside_in_both_directions_and_not_beside_it)
{
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), up(0.2, 0.3, 0.5), down(0.2, 0.3, -0.25);
  BOOST_CHECK(passes_through(up, down, a, b, c));
  BOOST_CHECK(passes_through(down, up, a, b, c));
  BOOST_CHECK(passes_through(up, down, a, c, b));
  BOOST_CHECK_SMALL((point_of_passing(up, down, a, b, c) - Vec3(0.2, 0.3, 0.0)).norm(), 1e-15);
  BOOST_CHECK(!passes_through(up, Vec3(0.2, 0.3, 0.1), a, b, c));    // ends above
  BOOST_CHECK(!passes_through(Vec3(2, 2, 1), Vec3(2, 2, -1), a, b, c));    // beside it
  BOOST_CHECK(!passes_through(Vec3(0.1, 0.1, 1e-17), Vec3(0.5, 0.2, -1e-17), a, b, c));    // in it
  BOOST_CHECK(!passes_through(Vec3(0.5, -1, 1), Vec3(0.5, 1.0, -1), a, b, c));    // touches an edge
}

BOOST_AUTO_TEST_SUITE_END()
