// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/closest_points.h"

#include <boost/test/unit_test.hpp>

#include <limits>
#include <random>

using namespace sphcloth;

namespace {

std::mt19937 random_numbers(7);

Vec3 random_point()
{
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  return {coordinate(random_numbers), coordinate(random_numbers), coordinate(random_numbers)};
}

FourPoints random_points()
{
  return {random_point(), random_point(), random_point(), random_point()};
}

// the smallest distance of points of both sides on a fine grid

double sampled_distance(PairKind kind, const FourPoints &x, int n)
{
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= n; i++)
    for (int j = 0; j <= n; j++) {
      const double s = static_cast<double>(i) / n, t = static_cast<double>(j) / n;
      Vec3 first = x[0], second = x[2] + t * (x[3] - x[2]);
      if (kind == PairKind::EDGE_EDGE) first += s * (x[1] - x[0]);
      if (kind == PairKind::POINT_TRIANGLE) second = x[1] + s * (second - x[1]);
      smallest = std::min(smallest, (first - second).norm());
    }
  return smallest;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(closest_points_of_pairs)

BOOST_AUTO_TEST_CASE(none_are_closer)
{
  for (const PairKind kind : {PairKind::POINT_TRIANGLE, PairKind::EDGE_EDGE})
    for (int n = 0; n < 200; n++) {
      const FourPoints x = random_points();
      const double distance = closest_points(kind, x).vector.norm();
      const double sampled = sampled_distance(kind, x, 100);
      BOOST_CHECK(distance <= sampled + 1e-14);
      BOOST_CHECK(sampled < distance + 0.05);
    }
}

BOOST_AUTO_TEST_CASE(along_the_line_between_centers_they_are_no_farther)
{
  for (const PairKind kind : {PairKind::POINT_TRIANGLE, PairKind::EDGE_EDGE}) {
    double tightest = 0.0;
    for (int n = 0; n < 1000; n++) {
      const FourPoints x = random_points();
      const double distance = closest_points(kind, x).vector.norm(),
                   along = distance_along_centers(kind, x);
      BOOST_CHECK(along <= distance * (1.0 + 1e-14));
      tightest = std::max(tightest, along / distance);
    }
    BOOST_TEST(tightest > 0.99);
    const Vec3 point(0.1, -0.4, 2.0);
    BOOST_TEST(distance_along_centers(kind, {point, point, point, point}) == 0.0);
  }
}

BOOST_AUTO_TEST_CASE(weights_make_the_vector_from_the_second_side_to_the_first)
{
  for (const PairKind kind : {PairKind::POINT_TRIANGLE, PairKind::EDGE_EDGE})
    for (int n = 0; n < 100; n++) {
      const FourPoints x = random_points();
      const ClosestPoints at = closest_points(kind, x);
      double first = 0.0, second = 0.0;
      for (int k = 0; k < 4; k++) {
        const bool on_first = k < first_side(kind);
        (on_first ? first : second) += at.weight[k];
        BOOST_CHECK(on_first ? at.weight[k] >= 0.0 : at.weight[k] <= 0.0);
      }
      BOOST_CHECK_SMALL(first - 1.0, 1e-14);
      BOOST_CHECK_SMALL(second + 1.0, 1e-14);
    }
}

BOOST_AUTO_TEST_CASE(edges_that_are_parallel_points_or_ends)
{
  const Vec3 o(0, 0, 0), x(1, 0, 0), z(0, 0, 0.5);
  const auto distance = [](const FourPoints &points) {
    return closest_points(PairKind::EDGE_EDGE, points).vector.norm();
  };
  BOOST_CHECK_SMALL(distance({o, x, o + z, x + z}) - 0.5, 1e-15);
  BOOST_CHECK_SMALL(distance({o, x, 2 * x + z, 3 * x + z}) - std::sqrt(1.25), 1e-15);
  BOOST_CHECK_SMALL(distance({o, o, z, x + z}) - 0.5, 1e-15);
  BOOST_CHECK_SMALL(distance({o, x, z, z}) - 0.5, 1e-15);
  BOOST_CHECK_SMALL(distance({o, o, z, z}) - 0.5, 1e-15);
}

BOOST_AUTO_TEST_CASE(edges_count_where_they_cross_and_less_towards_ends_and_parallels)
{
  const auto share = [](double at, double turn) {
    const Vec3 along(std::cos(turn), std::sin(turn), 0.0), center(at, 0.0, 0.1);
    const FourPoints x{Vec3(0, 0, 0), Vec3(1, 0, 0), center - 0.5 * along, center + 0.5 * along};
    return share_of_edges(x, closest_points(PairKind::EDGE_EDGE, x));
  };
  BOOST_CHECK(share(0.5, 1.5) == 1.0);
  BOOST_CHECK_CLOSE(share(0.02, 1.5), 0.4, 1e-9);
  BOOST_CHECK(share(0.0, 1.5) == 0.0);
  BOOST_CHECK_CLOSE(share(0.5, std::asin(0.05)), 0.25, 1e-6);
  BOOST_CHECK(share(0.5, 0.0) == 0.0);
  BOOST_CHECK(share_of_leaning(0.0) == 1.0);
  BOOST_CHECK_CLOSE(share_of_leaning(0.05), 0.5, 1e-9);
  BOOST_CHECK(share_of_leaning(0.2) == 0.0);
}

BOOST_AUTO_TEST_SUITE_END()
