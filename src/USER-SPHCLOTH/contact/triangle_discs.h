// SPDX-License-Identifier: GPL-2.0-or-later
// A grid of discs around the triangles of a mesh, for those within a distance of a point.

#ifndef SPHCLOTH_CONTACT_TRIANGLE_DISCS_H
#define SPHCLOTH_CONTACT_TRIANGLE_DISCS_H

#include "contact/moving_triangles.h"
#include "core/geometry/disc_grid.h"
#include "core/util/bytes.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace LAMMPS_NS {

class TriangleDiscs {
 public:
  // at the end of the step, with room for the way back to its start
  void build(const MovingTriangles &mesh, double distance)
  {
    discs.resize(mesh.triangles.size());
    for (std::size_t t = 0; t < discs.size(); t++) {
      const auto &[a, b, c] = mesh.triangles[t];
      discs[t] = sphcloth::disc_around(mesh.end[a], mesh.end[b], mesh.end[c]);
      double displacement_sq = 0.0;
      for (int s : mesh.triangles[t])
        displacement_sq = std::max(displacement_sq, (mesh.end[s] - mesh.start[s]).squaredNorm());
      discs[t].room = std::sqrt(displacement_sq);
    }
    grid.build(discs, distance);
  }

  sphcloth::DiscGrid grid;
  double bytes() const { return grid.bytes() + sphcloth::bytes_of(discs); }

 private:
  std::vector<sphcloth::Disc> discs;
};

}    // namespace LAMMPS_NS

#endif
