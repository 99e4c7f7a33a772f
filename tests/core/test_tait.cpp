// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/tait.h"

#include <boost/test/unit_test.hpp>

#include <cmath>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(tait)

BOOST_AUTO_TEST_CASE(rest_closed_form_sound_speed_and_energy)
{
  const Tait water{1000.0, 400.0, 7.0};
  BOOST_CHECK(water.pressure(1000.0) == 0.0);
  // (1.01)^7 - 1 by hand
  BOOST_CHECK_SMALL(water.pressure(1010.0) - 400.0 * 1000.0 / 7.0 * 0.07213535210701, 1e-7);
  BOOST_CHECK_SMALL(water.sound_speed() - 20.0, 1e-14);
  const double d = 1e-3;
  const double c2 = (water.pressure(1020.0 + d) - water.pressure(1020.0 - d)) / (2.0 * d);
  BOOST_CHECK_SMALL(water.sound_speed(1020.0) - std::sqrt(c2), 1e-6);
  const double de = (water.energy(1020.0 + d) - water.energy(1020.0 - d)) / (2.0 * d);
  BOOST_CHECK_SMALL(de - water.pressure(1020.0) / (1020.0 * 1020.0), 1e-9);
  BOOST_CHECK_SMALL(water.energy(1000.0), 1e-12);
}

BOOST_AUTO_TEST_CASE(any_exponent_small_fluctuations_and_stiffness_from_a_goal)
{
  const Tait gas{1.2, 9.0, 1.4};
  BOOST_CHECK_SMALL(gas.sound_speed(2.4) - 3.0 * std::pow(2.0, 0.2), 1e-14);
  BOOST_CHECK_SMALL(gas.pressure(2.4) - 9.0 * 1.2 / 1.4 * (std::pow(2.0, 1.4) - 1.0), 1e-12);
  const Tait water{1000.0, 100.0, 7.0};
  BOOST_CHECK_SMALL(water.pressure(1000.0 * (1.0 + 1e-9)) / (100.0 * 1000.0 * 1e-9) - 1.0, 1e-6);
  BOOST_CHECK_SMALL(Tait::stiffness_from_fluctuation(0.01, 3.0) - 900.0, 1e-10);    // c0 = 10 v
}

BOOST_AUTO_TEST_SUITE_END()
