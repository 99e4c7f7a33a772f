// SPDX-License-Identifier: GPL-2.0-or-later
// A grid of discs around the triangles of a mesh, for those within a distance of a point.

#ifndef SPHCLOTH_CONTACT_TRIANGLE_DISCS_H
#define SPHCLOTH_CONTACT_TRIANGLE_DISCS_H

#include "contact/moving_triangles.h"
#include "core/geometry/disc_grid.h"
#include "core/util/bytes.h"

#include <vector>

namespace LAMMPS_NS {

class TriangleDiscs {
 public:
  enum Which { ALL, WATERTIGHT };    // triangles

  // at the start of the step; room(t): how far a triangle may be from there
  template <class Room>
  void build(const MovingTriangles &mesh, double distance, Room room, Which which = ALL)
  {
    discs.resize(mesh.triangles.size());
    for (std::size_t t = 0; t < discs.size(); t++) {
      const auto &[a, b, c] = mesh.triangles[t];
      discs[t] = sphcloth::disc_around(mesh.start[a], mesh.start[b], mesh.start[c]);
      discs[t].room = room(t);
      if (which == WATERTIGHT && mesh.is_porous(static_cast<int>(t))) discs[t].radius = -1.0;
    }
    grid.build(discs, distance);
  }

  const sphcloth::Disc &operator[](int triangle) const { return discs[triangle]; }

  sphcloth::DiscGrid grid;
  double bytes() const { return grid.bytes() + sphcloth::bytes_of(discs); }

 private:
  std::vector<sphcloth::Disc> discs;
};

}    // namespace LAMMPS_NS

#endif
