// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/point_triangle.h"
#include "core/geometry/disc_grid.h"

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <set>
#include <vector>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(disc_grid)

BOOST_AUTO_TEST_CASE(finds_the_triangles_near_a_point_and_the_nearest)
{
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto vec = [&] { return Eigen::Vector3d(u(generator), u(generator), u(generator)); };
  std::vector<std::array<Eigen::Vector3d, 3>> triangles;
  std::vector<Disc> discs, moving;
  for (int k = 0; k < 500; k++) {
    const Eigen::Vector3d at = vec();
    const double size = k % 50 == 0 ? 3.0 : 0.05;
    triangles.push_back({at, at + size * vec(), at + (k == 7 ? 0.0 : size) * vec()});
    discs.push_back(disc_around(triangles[k][0], triangles[k][1], triangles[k][2]));
  }
  const double max_distance = 0.2, slack = 0.01, room = 0.1;
  for (const Disc &disc : discs) {
    moving.push_back(disc);
    moving.back().room = room;
  }
  DiscGrid grid, roomy;
  grid.build(discs, max_distance);
  roomy.build(moving, max_distance);
  BOOST_CHECK(DiscGrid().bytes() == 0.0);
  const double of_discs = static_cast<double>(discs.size() * sizeof(Disc));
  BOOST_CHECK(grid.bytes() >= of_discs);    // holds a copy of each
  int looked = 0, seen = 0;
  for (int k = 0; k < 500; k++) {
    const Eigen::Vector3d p = 1.3 * vec();
    std::vector<double> distance;
    for (const auto &[a, b, c] : triangles) {
      Eigen::Vector3d weight;
      distance.push_back(distance_vector(p, a, b, c, weight).norm());
    }
    const double nearest = *std::min_element(distance.begin(), distance.end());
    std::set<int> near, all, more;
    grid.nearest(p, max_distance, slack, [&](int t) { BOOST_CHECK(near.insert(t).second); });
    grid.within(p, max_distance, [&](int t) { BOOST_CHECK(all.insert(t).second); });
    roomy.within(p, max_distance, [&](int t) { BOOST_CHECK(more.insert(t).second); });
    for (int t = 0; t < 500; t++) {
      if (distance[t] <= std::min(max_distance, nearest + slack)) BOOST_CHECK(near.count(t) == 1);
      if (distance[t] <= max_distance) BOOST_CHECK(all.count(t) == 1);
      if (distance[t] <= max_distance + room) BOOST_CHECK(more.count(t) == 1);
    }
    if (nearest < max_distance) looked++;
    seen += static_cast<int>(near.size());
  }
  BOOST_CHECK(looked > 100);
  BOOST_CHECK(seen < 6 * 500);    // hardly more than have to
  const double none = std::numeric_limits<double>::quiet_NaN(),
               infinite = std::numeric_limits<double>::infinity();
  grid.nearest(Eigen::Vector3d(none, 0, 0), max_distance, slack, [](int) { BOOST_CHECK(false); });
  grid.within(Eigen::Vector3d(none, 0, 0), none, [](int) { BOOST_CHECK(false); });
  int found = 0;
  grid.within(Eigen::Vector3d(0, 0, infinite), infinite, [&](int) { found++; });
  BOOST_CHECK(found <= 500);
  moving[3].center[0] = infinite;
  roomy.build(moving, max_distance);
  roomy.within(vec(), max_distance, [](int t) { BOOST_CHECK(t != 3); });
  grid.build({}, max_distance);
  grid.nearest(vec(), max_distance, slack, [](int) { BOOST_CHECK(false); });
}

BOOST_AUTO_TEST_SUITE_END()
