// SPDX-License-Identifier: GPL-2.0-or-later
// The edges of the triangles that a rank knows, and what lies on both sides of each.

#ifndef SPHCLOTH_CONTACT_MESH_EDGES_H
#define SPHCLOTH_CONTACT_MESH_EDGES_H

#include "contact/triangle_set.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

class MeshEdges : protected Pointers {
 public:
  // obstacle_bits: groups of vertices that are of obstacles; needed: or there are no edges
  MeshEdges(LAMMPS *lmp_, const TriangleSet &mesh_, int obstacle_bits_, bool needed_) :
      Pointers(lmp_), needed(needed_), mesh(mesh_), obstacle_bits(obstacle_bits_)
  {
  }

  // after each list build, behind the triangles
  void rebuild();

  const bool needed;
  std::vector<std::array<int, 2>> edges;    // slots
  // the third vertices of the triangles at edge e: opposite[first[e] .. first[e+1])
  std::vector<int> first, opposite;
  std::vector<tagint> lowest;    // the lower ID of the two vertices of an edge

  // The rank that owns it looks after the pairs of an edge with edges of higher IDs.
  int vertex_of_lowest(int e) const
  {
    const auto &[a, b] = edges[e];
    return tags[a] < tags[b] ? a : b;
  }
  tagint tag(int slot) const { return tags[slot]; }
  int revision() const { return n_changes; }    // another one: slots or triangles are others
  bool is_obstacle(int slot) const { return obstacle[slot]; }

  // the longest edges of cloth and of obstacles that are here, at the last list build
  std::array<double, 2> longest_here() const;

  // Are two vertices joined by a bond?
  bool joined(int slot, int other) const;

  double memory_usage() const;

 private:
  const TriangleSet &mesh;
  const int obstacle_bits;
  std::vector<std::array<int, 3>> triangles;    // that edges are of
  std::vector<tagint> tags;    // of slots
  std::vector<char> obstacle;
  std::vector<int> index;    // of slots, in the topology
  int n_changes = 0;
};

}    // namespace LAMMPS_NS

#endif
