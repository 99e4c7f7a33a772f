// SPDX-License-Identifier: GPL-2.0-or-later
// Finds the side of a particle from the triangle of a sheet that is nearest to it.

#include "contact/sheet_sides.h"

#include "atom.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

void SheetSides::find(double cutoff, int sheet, std::vector<Sides> &sides, SheetLayers &layers)
{
  const WallTimer clock(mesh.counts.seconds);
  mesh.load_positions();
  discs.build(mesh, cutoff, [](std::size_t) { return 0.0; }, TriangleDiscs::WATERTIGHT);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!mesh.collides(i)) continue;
    const Vec3 p = Eigen::Map<const Vec3>(atom->x[i]);
    const Nearest at = nearest_to(p, cutoff);
    if (at.triangle < 0) continue;
    const bool first = !(sides[i] & NEAR_SHEET);
    if (at.side != 0) sides[i] |= side_of_sheet(sheet, at.side > 0);
    sides[i] |= first && !sees_another_layer(p, at, cutoff) ? NEAR_SHEET : NEAR_SHEET | LAYERED;
    if (first || at.from_sheet.squaredNorm() < layers.nearest(i).squaredNorm())
      layers.set_nearest(i, -at.from_sheet);
  }
}

void SheetSides::add_triangles(SheetLayers &layers) const
{
  for (std::size_t t = 0; t < mesh.triangles.size(); t++) {
    const auto &[a, b, c] = mesh.triangles[t];
    if (!mesh.is_porous(static_cast<int>(t))) layers.add({mesh.end[a], mesh.end[b], mesh.end[c]});
  }
}

// Side 1 above, -1 below, 0 far away or beyond the border.  At an edge or a vertex several
// triangles are equally near; the one that is seen most from the front knows the side.

SheetSides::Nearest SheetSides::nearest_to(const Vec3 &p, double cutoff)
{
  Nearest at;
  double nearest = std::numeric_limits<double>::max(), height = 0.0;
  bool beyond = false;
  discs.grid.nearest(p, cutoff, SEAM * cutoff, [&](int t) {
    const auto &[v0, v1, v2] = mesh.triangles[t];
    const Vec3 &a = mesh.end[v0], &b = mesh.end[v1], &c = mesh.end[v2];
    const double at_least = distance_along_centers(PairKind::POINT_TRIANGLE, {p, a, b, c});
    if (at_least > std::min(cutoff, nearest * (1.0 + 2.0 * SEAM))) return;
    Vec3 weight;
    const Vec3 out = distance_vector(p, a, b, c, weight);
    const double distance = out.norm();
    if (distance > nearest * (1.0 + SEAM) || distance > cutoff) return;
    const Vec3 normal = (b - a).cross(c - a).normalized();
    const double over = normal.dot(out);
    if (distance < nearest * (1.0 - SEAM)) {
      height = 0.0;
      beyond = false;
      at.triangle = -1;
    }
    nearest = std::min(nearest, distance);
    if (std::fabs(over) > std::fabs(height) || at.triangle < 0) {
      height = over;
      at.triangle = t;
      at.from_sheet = out;
    }
    beyond = beyond || mesh.is_on_border(t, weight);
  });
  if (!beyond && height != 0.0) at.side = height > 0.0 ? 1 : -1;
  return at;
}

bool SheetSides::sees_another_layer(const Vec3 &p, const Nearest &at, double cutoff)
{
  const Vec3 foot = p - at.from_sheet, &normal = discs[at.triangle].normal;
  const double min_gap = MIN_GAP * cutoff;
  const auto &others = may_be_other_layers(discs.grid, p, cutoff, foot, normal, min_gap);
  return std::any_of(others.begin(), others.end(), [&](int t) {
    const auto &[v0, v1, v2] = mesh.triangles[t];
    const Vec3 &a = mesh.end[v0], &b = mesh.end[v1], &c = mesh.end[v2];
    Vec3 weight;
    return is_another_layer(foot, normal, {a, b, c}, min_gap) &&
        distance_vector(p, a, b, c, weight).norm() <= cutoff;
  });
}
