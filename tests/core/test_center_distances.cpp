// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/center_distances.h"

#include <boost/test/unit_test.hpp>

#include <random>
#include <vector>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(center_distances)

BOOST_AUTO_TEST_CASE(they_are_those_of_single_pairs_and_bounds)
{
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  std::uniform_int_distribution<int> which(0, 39);
  std::vector<Vec3> x;
  for (int i = 0; i < 40; i++) x.emplace_back(any(random), any(random), any(random));
  x[7] = x[8];    // also of no length
  CenterDistances distances;
  distances.load(x);
  BOOST_CHECK(distances.bytes() >= 40.0 * sizeof(Row));
  int apart = 0;
  for (const PairKind kind : {PairKind::POINT_TRIANGLE, PairKind::EDGE_EDGE})
    for (int n = 0; n < 60; n++) {
      std::vector<CenterDistances::Four> pairs(whole_groups(n), {0, 0, 0, 0});
      for (int k = 0; k < n; k++)
        pairs[k] = {which(random), which(random), which(random), which(random)};
      if (n > 3) pairs[3] = {7, 8, 7, 8};    // one in the other
      std::vector<double> at_least(pairs.size());
      distances.measure(kind, pairs.data(), n, at_least.data());
      for (int k = 0; k < n; k++) {
        const auto &[a, b, c, d] = pairs[k];
        const FourPoints four{x[a], x[b], x[c], x[d]};
        BOOST_REQUIRE_SMALL(at_least[k] - distance_along_centers(kind, four), 1e-14);
        BOOST_REQUIRE_LE(at_least[k], closest_points(kind, four).vector.norm() + 1e-14);
        apart += at_least[k] > 0.1;
      }
    }
  BOOST_CHECK(apart > 1000);
}

BOOST_AUTO_TEST_CASE(the_numbers_are_those_of_the_last_load)
{
  CenterDistances distances;
  const std::vector<CenterDistances::Four> pairs(LANES, {0, 1, 2, 3});
  std::vector<double> at_least(LANES);
  for (const double height : {1.0, 2.0}) {
    distances.load({{0, 0, height}, {-1, -1, 0}, {1, -1, 0}, {0, 2, 0}});
    distances.measure(PairKind::POINT_TRIANGLE, pairs.data(), 1, at_least.data());
    BOOST_CHECK_CLOSE(at_least[0], height, 1e-12);
  }
  distances.load({});
  distances.measure(PairKind::EDGE_EDGE, nullptr, 0, nullptr);
}

BOOST_AUTO_TEST_SUITE_END()
