// SPDX-License-Identifier: GPL-2.0-or-later
// Counts triangles at the edges of a mesh.

#include "contact/triangle_ends.h"

#include "cloth/cloth_topology.h"

#include <algorithm>
#include <map>

using namespace LAMMPS_NS;

// Nearer to an edge than this part of a triangle rounding decides which of the triangles there is
// the nearest: their distances differ by the square of it.
static constexpr double AT_EDGE = 1e-6;

std::vector<std::array<TrianglesAtEdge, 3>>
LAMMPS_NS::count_at_edges(const ClothTopology &topology, const ChooseTriangle &is_chosen)
{
  const auto &elements = topology.triangles.vertices;
  std::map<std::array<int, 2>, TrianglesAtEdge> at;
  const auto edge = [](const std::array<int, 3> &t, int opposite) -> std::array<int, 2> {
    const int a = t[(opposite + 1) % 3], b = t[(opposite + 2) % 3];
    return {std::min(a, b), std::max(a, b)};
  };
  for (std::size_t m = 0; m < elements.size(); m++)
    for (int q = 0; q < 3; q++) {
      TrianglesAtEdge &here = at[edge(elements[m], q)];
      here.all++;
      if (is_chosen(m)) here.chosen++;
    }
  std::vector<std::array<TrianglesAtEdge, 3>> found(elements.size());
  for (std::size_t m = 0; m < elements.size(); m++)
    for (int q = 0; q < 3; q++) found[m][q] = at[edge(elements[m], q)];
  return found;
}

TriangleEnds::TriangleEnds(const ClothTopology &topology, const ChooseTriangle &is_chosen)
{
  const auto &elements = topology.triangles.vertices;
  const auto at = count_at_edges(topology, is_chosen);
  edges.resize(elements.size());
  vertices.resize(elements.size());
  std::vector<bool> has_end(topology.n_vertices(), false);
  for (std::size_t m = 0; m < elements.size(); m++)
    for (int q = 0; q < 3; q++) {
      edges[m][q] = at[m][q].end();
      if (!edges[m][q]) continue;
      has_end[elements[m][(q + 1) % 3]] = has_end[elements[m][(q + 2) % 3]] = true;
    }
  for (std::size_t m = 0; m < elements.size(); m++)
    for (int q = 0; q < 3; q++) vertices[m][q] = has_end[elements[m][q]];
}

bool TriangleEnds::has(int triangle, const Eigen::Vector3d &weight) const
{
  for (int q = 0; q < 3; q++) {
    if (weight[q] >= 1.0 - AT_EDGE && vertices[triangle][q]) return true;
    if (weight[q] <= AT_EDGE && edges[triangle][q]) return true;
  }
  return false;
}
