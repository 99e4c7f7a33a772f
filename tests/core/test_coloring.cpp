// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pbd/coloring.h"
#include "core/pbd/sheet_mesh.h"

#include <boost/test/unit_test.hpp>

#include <array>
#include <set>
#include <utility>
#include <vector>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(coloring)

BOOST_AUTO_TEST_CASE(no_two_constraints_of_one_color_share_a_vertex)
{
  const Sheet sheet = make_sheet(Pattern::DIAGONAL, 1.0, 1.0, 0.05);
  const MeshTopology mesh = mesh_topology(sheet.triangles);
  int n = 0;
  const auto color = color_constraints(mesh.hinges, static_cast<int>(sheet.vertices.size()), n);
  std::set<std::pair<int, int>> seen;
  for (std::size_t m = 0; m < mesh.hinges.size(); m++)
    for (int v : mesh.hinges[m]) BOOST_CHECK(seen.insert({color[m], v}).second);
  BOOST_CHECK(n > 0 && n < 40);
}

BOOST_AUTO_TEST_CASE(no_constraints_have_no_color)
{
  int n = 7;
  BOOST_CHECK(color_constraints(std::vector<std::array<int, 2>>(), 3, n).empty() && n == 0);
}

BOOST_AUTO_TEST_SUITE_END()
