// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/geometry/ball_columns.h"

#include <boost/test/unit_test.hpp>

#include <random>

using namespace sphcloth;
using Vec3 = Eigen::Vector3d;

BOOST_AUTO_TEST_SUITE(ball_columns)

BOOST_AUTO_TEST_CASE(balls_near_a_place)
{
  std::mt19937 random_numbers(4);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  const auto random = [&] {
    return Vec3(coordinate(random_numbers), coordinate(random_numbers), coordinate(random_numbers));
  };
  BallColumns balls;
  balls.resize(101);
  for (int n = 0; n < 101; n++) balls.set(n, random(), 0.2 * (1.0 + coordinate(random_numbers)));
  const Vec3 p = random();
  std::vector<int> found, expected;
  balls.within(3, 99, p, 0.4, [&](int n) { found.push_back(n); });
  for (int n = 3; n < 99; n++)
    if ((balls.center(n) - p).norm() - balls.radius(n) <= 0.4) expected.push_back(n);
  BOOST_TEST(!expected.empty());
  BOOST_TEST(found == expected, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_SUITE_END()
