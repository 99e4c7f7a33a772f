// SPDX-License-Identifier: GPL-2.0-or-later
// Finds edges by sorting the sides of all triangles.

#include "contact/mesh_edges.h"

#include "atom.h"
#include "core/util/bytes.h"

#include <algorithm>

using namespace LAMMPS_NS;

void MeshEdges::rebuild()
{
  const ClothTopology &cloth = mesh.mesh->topology();
  const std::vector<tagint> tags_before = tags;
  tags.resize(mesh.halo.n_slots());
  index.resize(tags.size());
  obstacle.resize(tags.size());
  for (std::size_t s = 0; s < tags.size(); s++) {
    const int i = mesh.halo.atom_of(static_cast<int>(s));
    tags[s] = atom->tag[i];
    obstacle[s] = (atom->mask[i] & obstacle_bits) != 0;
    index[s] = cloth.index_of(tags[s]);
  }

  if (!needed || (triangles == mesh.triangles && tags == tags_before)) return;
  triangles = mesh.triangles;
  n_changes++;

  std::vector<std::array<int, 3>> sides;    // both ends, and the vertex opposite to them
  sides.reserve(3 * mesh.triangles.size());
  for (const std::array<int, 3> &t : mesh.triangles)
    for (int q = 0; q < 3; q++) {
      const int a = t[(q + 1) % 3], b = t[(q + 2) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), t[q]});
    }
  std::sort(sides.begin(), sides.end());

  edges.clear();
  first.clear();
  opposite.clear();
  lowest.clear();
  for (const auto &[a, b, c] : sides) {
    if (edges.empty() || edges.back() != std::array<int, 2>{a, b}) {
      edges.push_back({a, b});
      first.push_back(static_cast<int>(opposite.size()));
      lowest.push_back(std::min(tags[a], tags[b]));
    }
    opposite.push_back(c);
  }
  first.push_back(static_cast<int>(opposite.size()));
}

std::array<double, 2> MeshEdges::longest_here() const
{
  std::array<double, 2> longest{0.0, 0.0};
  for (const auto &[a, b] : edges) {
    double &so_far = longest[is_obstacle(a) ? 1 : 0];
    so_far = std::max(so_far, (mesh.position(b) - mesh.position(a)).norm());
  }
  return longest;
}

bool MeshEdges::joined(int slot, int other) const
{
  const ClothElements<2> &bonds = mesh.mesh->topology().edges;
  const int v = index[slot], w = index[other];
  if (v < 0 || w < 0) return false;
  for (int k = bonds.first[v]; k < bonds.first[v + 1]; k++) {
    const std::array<int, 2> &ends = bonds.vertices[bonds.incident[k]];
    if (ends[0] == w || ends[1] == w) return true;
  }
  return false;
}

double MeshEdges::memory_usage() const
{
  return sphcloth::bytes_of(triangles, edges, first, opposite, lowest, tags, obstacle, index);
}
