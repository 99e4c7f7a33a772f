// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/geometry/hull_columns.h"

#include "core/contact/closest_points.h"

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <random>

using namespace sphcloth;

namespace {

class Dice {
 public:
  Vec3 point(double size) { return size * Vec3(any(numbers), any(numbers), any(numbers)); }

 private:
  std::mt19937 numbers{4};
  std::uniform_real_distribution<double> any{-1.0, 1.0};
};

// All that are near must be found; of those beyond a larger distance, hardly any.

struct Count {
  int near = 0, remote = 0, remote_found = 0;

  void add(double distance, double max_distance, double beyond, bool is_found)
  {
    if (distance <= max_distance) BOOST_TEST(is_found);
    near += distance <= max_distance;
    remote += distance > beyond;
    remote_found += distance > beyond && is_found;
  }
  void check() const
  {
    BOOST_TEST(near > 100);
    BOOST_TEST(remote > 1000);
    BOOST_TEST(remote_found < 0.02 * remote);
  }
};

constexpr int N = 101, BEGIN = 3, END = 99;
constexpr double MAX_DISTANCE = 0.3, REMOTE = 0.6;

bool holds(const std::vector<int> &found, int n)
{
  return std::find(found.begin(), found.end(), n) != found.end();
}

}    // namespace

BOOST_AUTO_TEST_SUITE(hull_columns)

BOOST_AUTO_TEST_CASE(triangles_near_a_place)
{
  Dice dice;
  Count count;
  for (int round = 0; round < 80; round++) {
    TriangleColumns triangles;
    triangles.resize(N);
    std::vector<FourPoints> corners(N);
    for (int n = 0; n < N; n++) {
      const Vec3 at = dice.point(1.0);
      corners[n] = {Vec3::Zero(), at + dice.point(0.2), at + dice.point(0.2), at + dice.point(0.2)};
      triangles.set(n, corners[n][1], corners[n][2], corners[n][3]);
    }
    const Vec3 p = dice.point(1.0);
    std::vector<int> found;
    triangles.within(BEGIN, END, p, MAX_DISTANCE, [&](int n) { found.push_back(n); });
    BOOST_TEST(std::is_sorted(found.begin(), found.end()));
    BOOST_TEST((!holds(found, 0) && !holds(found, END)));
    for (int n = BEGIN; n < END; n++) {
      corners[n][0] = p;
      count.add(closest_points(PairKind::POINT_TRIANGLE, corners[n]).vector.norm(), MAX_DISTANCE,
                REMOTE, holds(found, n));
    }
  }
  count.check();
}

BOOST_AUTO_TEST_CASE(edges_near_one_of_them)
{
  Dice dice;
  Count count;
  for (int round = 0; round < 80; round++) {
    EdgeColumns edges;
    edges.resize(N);
    std::vector<std::array<Vec3, 2>> ends(N);
    for (int n = 0; n < N; n++) {
      const Vec3 at = dice.point(1.0);
      ends[n] = {at + dice.point(0.2), at + dice.point(0.2)};
      edges.set(n, ends[n][0], ends[n][1]);
    }
    BOOST_TEST((edges.center(1) - 0.5 * (ends[1][0] + ends[1][1])).norm() < 1e-14);
    BOOST_TEST(std::fabs(2.0 * edges.radius(1) - (ends[1][1] - ends[1][0]).norm()) < 1e-14);
    std::vector<int> found;
    edges.within(BEGIN, END, 1, MAX_DISTANCE, [&](int n) { found.push_back(n); });
    for (int n = BEGIN; n < END; n++) {
      const FourPoints both{ends[1][0], ends[1][1], ends[n][0], ends[n][1]};
      count.add(closest_points(PairKind::EDGE_EDGE, both).vector.norm(), MAX_DISTANCE, REMOTE,
                holds(found, n));
    }
  }
  count.check();
}

BOOST_AUTO_TEST_SUITE_END()
