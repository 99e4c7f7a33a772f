// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/timestep/free_flight.h"

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <limits>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(free_flight)

BOOST_AUTO_TEST_CASE(flight_lasts_until_rest_density_and_rounding_above)
{
  BOOST_TEST(flies(990.0, 1000.0, 1e-6));
  BOOST_TEST(flies(1000.0 + 0.9e-6, 1000.0, 1e-6));
  BOOST_TEST(!flies(1000.0 + 1.1e-6, 1000.0, 1e-6));
  BOOST_TEST(!flies(0.0, -std::numeric_limits<double>::infinity(), 0.0));
  BOOST_TEST(gap_to_pressure(990.0, 1000.0, 1e-6) == 10.0);
  BOOST_TEST(gap_to_pressure(1000.0 + 0.9e-6, 1000.0, 1e-6) == 1e-6);
}

BOOST_AUTO_TEST_CASE(time_to_cross_a_gap)
{
  BOOST_CHECK_SMALL(time_to_cross(2.0, 4.0, 0.0) - 0.5, 1e-16);
  BOOST_CHECK(std::isinf(time_to_cross(2.0, 0.0, 0.0)));
  BOOST_CHECK(std::isinf(time_to_cross(2.0, -4.0, 0.0)));
  BOOST_CHECK_SMALL(time_to_cross(8.0, 0.0, 4.0) - 2.0, 1e-16);
  for (const double rate : {4.0, 0.0, -4.0})
    BOOST_CHECK(time_at_rate(2.0, rate) == time_to_cross(2.0, rate, 0.0));
  for (const double rate : {3.0, -3.0}) {
    const double t = time_to_cross(2.0, rate, 5.0);
    BOOST_CHECK_SMALL(rate * t + 2.5 * t * t - 2.0, 1e-14);
  }
  BOOST_CHECK(time_to_cross(-1.0, 3.0, 5.0) == 0.0);
  BOOST_CHECK_SMALL(time_to_cross(1e-300, 1e-3, 1e-300) - 1e-297, 1e-305);
  BOOST_CHECK_SMALL(time_to_cross(0.0, -3.0, 6.0) - 1.0, 1e-16);    // away, and back again
}

BOOST_AUTO_TEST_CASE(a_rate_beyond_the_gap_takes_as_long_as_gap_and_tolerance_together)
{
  const double gap = 30.0, rate = 7.0, tolerated = 5.0;
  const double beyond = rate_beyond(gap, rate, tolerated);
  BOOST_TEST(tolerated / beyond == (gap + tolerated) / rate, boost::test_tools::tolerance(1e-15));
  BOOST_TEST(rate_beyond(gap, -rate, tolerated) == 0.0);
}

BOOST_AUTO_TEST_SUITE_END()
