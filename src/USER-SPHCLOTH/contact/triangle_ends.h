// SPDX-License-Identifier: GPL-2.0-or-later
// Where some triangles of a mesh end: beyond an edge is another triangle, or none.

#ifndef SPHCLOTH_CONTACT_TRIANGLE_ENDS_H
#define SPHCLOTH_CONTACT_TRIANGLE_ENDS_H

#include "core/util/bytes.h"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <vector>

namespace LAMMPS_NS {

class ClothTopology;

// triangles that share an edge

struct TrianglesAtEdge {
  int all = 0, chosen = 0;
  bool end() const { return all == 1 || (chosen > 0 && chosen < all); }
};

using ChooseTriangle = std::function<bool(std::size_t)>;

// at the three edges of each triangle, by the vertex that is opposite

std::vector<std::array<TrianglesAtEdge, 3>> count_at_edges(const ClothTopology &,
                                                           const ChooseTriangle &);

class TriangleEnds {
 public:
  TriangleEnds(const ClothTopology &, const ChooseTriangle &);

  // Is a point of a triangle, by its barycentric weights, at the end of those that are chosen?
  // Also where it is a vertex that has the end at other triangles.
  bool has(int triangle, const Eigen::Vector3d &weight) const;

  double bytes() const { return sphcloth::bytes_of(edges, vertices); }

 private:
  std::vector<std::array<bool, 3>> edges, vertices;    // of each triangle
};

}    // namespace LAMMPS_NS

#endif
