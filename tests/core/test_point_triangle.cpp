// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/point_triangle.h"

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <random>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(point_triangle)

BOOST_AUTO_TEST_CASE(weights_of_a_point_in_the_plane_give_it_back)
{
  const Vec3 a(0.1, 0, 0.7), b(1, 0.2, 0.4), c(0, 1, 0.6), weight(0.5, 0.7, -0.2);
  const Vec3 in_plane = weight[0] * a + weight[1] * b + weight[2] * c;
  const Vec3 beside = in_plane + 0.3 * (b - a).cross(c - a);
  BOOST_CHECK_SMALL((barycentric(beside, a, b, c) - weight).norm(), 1e-14);
  BOOST_CHECK(!inside(weight));
  BOOST_CHECK(inside(Vec3(0.5, 0.5, -1e-12)));
}

BOOST_AUTO_TEST_CASE(no_point_of_a_triangle_is_nearer_than_the_closest)
{
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto vec = [&] { return Vec3(u(generator), u(generator), u(generator)); };
  for (int k = 0; k < 200; k++) {
    const Vec3 a = vec(), b = vec(), c = vec(), p = 2.0 * vec();
    Vec3 weight;
    const double distance = distance_vector(p, a, b, c, weight).norm();
    BOOST_CHECK(weight.minCoeff() >= 0.0);
    BOOST_CHECK_SMALL(weight.sum() - 1.0, 1e-14);
    for (int m = 0; m < 200; m++) {
      double r = 0.5 * (u(generator) + 1.0), s = 0.5 * (u(generator) + 1.0);
      if (r + s > 1.0) {
        r = 1.0 - r;
        s = 1.0 - s;
      }
      BOOST_CHECK((p - a - r * (b - a) - s * (c - a)).norm() >= distance - 1e-12);
    }
  }
}

BOOST_AUTO_TEST_CASE(corners_may_lie_in_one_place)
{
  std::mt19937 generator(8);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto vec = [&] { return Vec3(u(generator), u(generator), u(generator)); };
  for (int k = 0; k < 500; k++) {
    const Vec3 a = vec(), b = vec(), p = 2.0 * vec();
    const double on = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0),
                 of_edge = (p - a - on * (b - a)).norm();
    Vec3 weight;
    for (const auto &[i, j, l] : {std::array<Vec3, 3>{a, a, b}, {a, b, a}, {b, a, a}}) {
      BOOST_REQUIRE_SMALL(distance_vector(p, i, j, l, weight).norm() - of_edge, 1e-12);
      BOOST_REQUIRE(weight.minCoeff() >= 0.0);
    }
    BOOST_REQUIRE_SMALL(distance_vector(p, a, a, a, weight).norm() - (p - a).norm(), 1e-14);
  }
}

BOOST_AUTO_TEST_CASE(a_line_leans_as_its_cosine)
{
  BOOST_CHECK_SMALL(leaning(Vec3(4, 0, 0), Vec3(3, 0, 1)) - 3.0, 1e-14);
  BOOST_CHECK(leaning(Vec3(0, 0, 0), Vec3(3, 0, 1)) == 0.0);
}

BOOST_AUTO_TEST_SUITE_END()
