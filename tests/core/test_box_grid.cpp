// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/geometry/box_grid.h"

#include <boost/test/unit_test.hpp>

#include <random>
#include <set>
#include <vector>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(box_grid)

BOOST_AUTO_TEST_CASE(finds_exactly_the_boxes_of_a_brute_force_search)
{
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto vec = [&] { return Eigen::Vector3d(u(generator), u(generator), u(generator)); };
  std::vector<Box> boxes;
  for (int k = 0; k < 300; k++) {
    Box box(vec());
    box.extend(Eigen::Vector3d(box.min() + 0.1 * vec()));
    boxes.push_back(box);
  }
  BoxGrid grid;
  grid.build(boxes);
  for (int k = 0; k < 300; k++) {
    Box probe(vec());
    probe.extend(Eigen::Vector3d(probe.min() + 0.2 * vec()));
    std::set<int> found, expected;
    grid.query(probe, [&](int b) {
      if (boxes[b].intersects(probe)) BOOST_CHECK(found.insert(b).second);
    });
    for (int b = 0; b < 300; b++)
      if (boxes[b].intersects(probe)) expected.insert(b);
    BOOST_CHECK(found == expected);
  }
  grid.build({});
  grid.query(Box(vec()), [](int) { BOOST_CHECK(false); });
}

BOOST_AUTO_TEST_SUITE_END()
