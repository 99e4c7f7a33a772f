// SPDX-License-Identifier: GPL-2.0-or-later
// On which side of a sheet each particle near it is: above, from where its triangles run
// counter-clockwise, or below.
// Made at each list build; it holds until the next one, since particles do not pass.

#ifndef SPHCLOTH_CONTACT_SHEET_SIDES_H
#define SPHCLOTH_CONTACT_SHEET_SIDES_H

#include "contact/moving_triangles.h"
#include "contact/triangle_discs.h"
#include "core/contact/sheet_layers.h"

#include <vector>

namespace LAMMPS_NS {

class SheetSides : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  SheetSides(LAMMPS *lmp_, MovingTriangles &mesh_) : Pointers(lmp_), mesh(mesh_) {}

  // Of owned particles nearer than the cutoff, added to what is there; and whether there is more
  // than one layer.
  void find(double cutoff, int sheet, std::vector<sphcloth::Sides> &, sphcloth::SheetLayers &);
  void add_triangles(sphcloth::SheetLayers &) const;

  double memory_usage() const { return discs.bytes(); }

 private:
  MovingTriangles &mesh;
  TriangleDiscs discs;

  // the nearest triangle, or -1 if all are far away; the side of it; and the vector
  // from its nearest point
  struct Nearest {
    int triangle = -1, side = 0;
    Vec3 from_sheet;
  };
  Nearest nearest_to(const Vec3 &p, double cutoff);
  bool sees_another_layer(const Vec3 &p, const Nearest &, double cutoff);
};

}    // namespace LAMMPS_NS

#endif
