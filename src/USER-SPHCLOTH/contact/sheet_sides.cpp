// SPDX-License-Identifier: GPL-2.0-or-later
// Finds the side of a particle from the triangle of a sheet that is nearest to it.

#include "contact/sheet_sides.h"

#include "atom.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

void SheetSides::find(double cutoff, int sheet, std::vector<Sides> &sides)
{
  const WallTimer clock(mesh.counts.seconds);
  mesh.load_positions();
  discs.build(mesh, cutoff, [](std::size_t) { return 0.0; });
  for (int i = 0; i < atom->nlocal; i++) {
    if (!mesh.collides(i)) continue;
    const double *x = atom->x[i];
    const int side = side_at(Vec3(x[0], x[1], x[2]), cutoff);
    if (side != 0) sides[i] |= side_of_sheet(sheet, side > 0);
  }
}

// 1 above, -1 below, 0 far away or beyond the border.  At an edge or a vertex several triangles are
// equally near; the one that is seen most from the front knows the side.

int SheetSides::side_at(const Vec3 &p, double cutoff)
{
  double nearest = std::numeric_limits<double>::max(), height = 0.0;
  bool beyond = false;
  discs.grid.nearest(p, cutoff, SEAM * cutoff, [&](int t) {
    const auto &[v0, v1, v2] = mesh.triangles[t];
    const Vec3 &a = mesh.end[v0], &b = mesh.end[v1], &c = mesh.end[v2];
    Vec3 weight;
    const Vec3 out = distance_vector(p, a, b, c, weight);
    const double distance = out.norm();
    if (distance > nearest * (1.0 + SEAM) || distance > cutoff) return;
    const Vec3 normal = (b - a).cross(c - a).normalized();
    const double over = normal.dot(out);
    if (distance < nearest * (1.0 - SEAM)) {
      height = 0.0;
      beyond = false;
    }
    nearest = std::min(nearest, distance);
    if (std::fabs(over) > std::fabs(height)) height = over;
    beyond = beyond || mesh.is_on_border(t, weight);
  });
  return beyond || height == 0.0 ? 0 : (height > 0.0 ? 1 : -1);
}
