// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/geometry/oriented_surface.h"

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

using namespace sphcloth;

namespace {

using Triangles = std::vector<std::array<int, 3>>;
using Flaw = OrientedSurface::Flaw;

const Triangles TETRAHEDRON = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

// Are all edges of a closed surface run through once each way?
bool is_consistent(const OrientedSurface &surface)
{
  std::multiset<std::pair<int, int>> sides;
  for (const auto &t : surface.triangles)
    for (int k = 0; k < 3; k++) sides.insert({t[k], t[(k + 1) % 3]});
  return std::all_of(sides.begin(), sides.end(), [&](const auto &side) {
    return sides.count(side) == 1 && sides.count({side.second, side.first}) == 1;
  });
}

}    // namespace

BOOST_AUTO_TEST_SUITE(oriented_surface)

BOOST_AUTO_TEST_CASE(triangles_are_turned_as_most_of_them_are)
{
  for (std::size_t turned = 0; turned < 4; turned++) {
    Triangles mixed = TETRAHEDRON;
    std::swap(mixed[turned][0], mixed[turned][1]);
    mixed.push_back({3, 1, 0});    // again, in another order
    const OrientedSurface surface(mixed), right(TETRAHEDRON);
    BOOST_TEST(surface.triangles.size() == 4);
    BOOST_TEST((surface.triangles == right.triangles));
    BOOST_TEST(is_consistent(surface));
    BOOST_TEST(surface.is_closed(0));
    BOOST_TEST((surface.flaw == Flaw::NONE));
  }
}

BOOST_AUTO_TEST_CASE(parts_hang_together_by_edges)
{
  Triangles two = TETRAHEDRON;    // the second one touches the first at vertex 3
  for (const auto &t : TETRAHEDRON) two.push_back({t[0] + 3, t[1] + 3, t[2] + 3});
  const OrientedSurface surface(two);
  BOOST_TEST(surface.parts() == 2);
  BOOST_TEST(surface.first[0] == 0);
  BOOST_TEST(surface.first[1] == 3);
  BOOST_TEST(surface.holes.empty());
}

BOOST_AUTO_TEST_CASE(holes_are_bounded_by_loops)
{
  Triangles open = TETRAHEDRON;
  open.erase(open.begin());
  const OrientedSurface surface(open);
  BOOST_TEST_REQUIRE(surface.holes.size() == 1);
  BOOST_TEST(!surface.is_closed(0));
  std::vector<int> loop = surface.holes[0].loop;
  std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  BOOST_TEST((loop == std::vector<int>{0, 1, 2}));    // along the triangles at it
}

BOOST_AUTO_TEST_CASE(a_branched_edge_is_named)
{
  Triangles branched = TETRAHEDRON;
  branched.push_back({1, 2, 4});
  const OrientedSurface surface(branched);
  BOOST_TEST((surface.flaw == Flaw::BRANCHED));
  BOOST_TEST((surface.flawed_edge == std::array<int, 2>{1, 2}));
}

BOOST_AUTO_TEST_CASE(a_moebius_strip_is_one_sided)
{
  const OrientedSurface surface({{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {3, 4, 0}, {4, 0, 1}});
  BOOST_TEST((surface.flaw == Flaw::ONE_SIDED));
}

BOOST_AUTO_TEST_SUITE_END()
