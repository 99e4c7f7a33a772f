// SPDX-License-Identifier: GPL-2.0-or-later
// Sheets in layers: folded ones, and several beside one another.  What the nearest triangle says of
// the side of a particle is not enough there: two particles may be above the same sheet in
// different folds of it, or beside layers that face one another.  A sheet parts them if one of its
// triangles crosses the straight line between the two.
//
// All is as it was at a list build, also for lists that are renewed before the next one: a pair is
// parted in the lists of both particles, on all ranks, or in none.

#ifndef SPHCLOTH_CORE_CONTACT_SHEET_LAYERS_H
#define SPHCLOTH_CORE_CONTACT_SHEET_LAYERS_H

#include "core/contact/edge_through_triangle.h"
#include "core/contact/seen_triangles.h"
#include "core/contact/sheet_sides.h"
#include "core/geometry/disc_grid.h"
#include "core/util/bytes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace sphcloth {

// Does a triangle cross the line from p to q?  Its edges belong to it, so that no line slips
// through between neighbors.  A line in its plane, or one that ends on it, does not count.  The
// same to the last bit with both ends exchanged.

inline bool crosses(Vec3 p, Vec3 q, const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  if (std::lexicographical_compare(q.data(), q.data() + 3, p.data(), p.data() + 3)) p.swap(q);
  const double above = volume_of(a, b, c, p), below = volume_of(a, b, c, q);
  if (!(above * below < 0.0)) return false;
  const double room = SEAM * (b - a).cross(c - a).norm() * (q - p).norm();
  if (std::fabs(above) < room || std::fabs(below) < room) return false;
  const double ab = volume_of(p, q, a, b), bc = volume_of(p, q, b, c), ca = volume_of(p, q, c, a);
  return (ab > -room && bc > -room && ca > -room) || (ab < room && bc < room && ca < room);
}

// Beside a foot on a triangle with a normal: what belongs to one layer with it is not bent by more
// than a right angle, with room for round-off at the edges of a box, nor does it lie off by more
// than half of that as seen from both, as on an arc.  Layers that are nearer to one another than a
// particle fits in between are one.
inline constexpr double COS_BEND = -0.05, SIN_HALF_BEND = 0.7071067811865476;
inline constexpr double MIN_GAP = 0.15;    // of the distance up to which sheets matter

inline bool is_another_layer(const Vec3 &foot, const Vec3 &normal,
                             const std::array<Vec3, 3> &triangle, double min_gap)
{
  const auto &[a, b, c] = triangle;
  const Vec3 its_normal = (b - a).cross(c - a).normalized();
  if (its_normal.dot(normal) < COS_BEND) return true;
  const double height = std::fabs(its_normal.dot(a - foot));
  if (height <= min_gap) return false;
  Vec3 weight;
  const Vec3 to = distance_vector(foot, a, b, c, weight);
  const double limit = SIN_HALF_BEND * to.norm();
  return height > limit && std::fabs(normal.dot(to)) > limit;
}

// which of those that are near p may be: quick, and none is missed

inline const std::vector<int> &may_be_other_layers(DiscGrid &grid, const Vec3 &p,
                                                   double max_distance, const Vec3 &foot,
                                                   const Vec3 &normal, double min_gap)
{
  constexpr double ROOM = 1e-9;    // for round-off
  return grid.beside_plane(p, max_distance, foot, normal, COS_BEND + ROOM, min_gap * (1.0 - ROOM));
}

class SheetLayers : public Parting {
 public:
  using Triangle = std::array<Vec3, 3>;

  // From nothing, for as many particles; sheets matter up to this distance from them.
  void start(std::size_t n, double distance)
  {
    max_distance = distance;
    to_sheet.resize(n);
    triangles.clear();
    positions = nullptr;
    discs.clear();
    particle = -1;
  }
  // the vector from a particle near a sheet to the nearest point of all
  void set_nearest(int i, const Vec3 &vector) { to_sheet[i] = vector; }
  const Vec3 &nearest(int i) const { return to_sheet[i]; }

  // if there are particles near sheets: the triangles of all, and positions of all particles
  void add(const Triangle &t) { triangles.push_back(t); }
  void finish(const double *x, int n_all)
  {
    at_build.assign(x, x + 3 * static_cast<std::size_t>(n_all));
    positions = at_build.data();
  }
  bool any() const { return positions; }

  // of two that are_doubtful()
  bool part(int i, int j, Sides of_i, Sides of_j) override
  {
    if ((of_i | of_j) & LAYERED) return is_crossed(i, j);
    return face_one_sheet(i, j) || is_crossed(i, j);
  }

  double bytes() const
  {
    return grid.bytes() + seen.bytes() + bytes_of(to_sheet, triangles, at_build, discs);
  }

 private:
  double max_distance = 0.0;
  std::vector<Vec3> to_sheet;
  std::vector<Triangle> triangles;
  std::vector<double> at_build;
  const double *positions = nullptr;
  std::vector<Disc> discs;    // with their grid, once a line is looked at
  DiscGrid grid;
  SeenTriangles seen;    // from the particle whose lines are looked at
  int particle = -1;

  Vec3 at(int i) const { return Eigen::Map<const Vec3>(positions + 3 * i); }

  // Does each of the two look at the other when it looks at its sheet?  Those on two sides of one
  // layer do.
  bool face_one_sheet(int i, int j) const
  {
    const Vec3 line = at(j) - at(i);
    return line.dot(to_sheet[i]) > 0.0 && line.dot(to_sheet[j]) < 0.0;
  }

  bool is_crossed(int i, int j)
  {
    const Vec3 p = at(i), q = at(j), line = q - p;
    // where a sheet is between, both are nearer to it than to each other
    if (to_sheet[i].norm() + to_sheet[j].norm() > (1.0 + SEAM) * line.norm()) return false;
    if (i != particle) look_from(i);
    for (const int t : seen.may_cross(line)) {
      const auto &[a, b, c] = triangles[t];
      if (crosses(p, q, a, b, c)) return true;
    }
    return false;
  }

  void look_from(int i)
  {
    if (discs.empty()) {
      discs.reserve(triangles.size());
      for (const auto &[a, b, c] : triangles) discs.push_back(disc_around(a, b, c));
      grid.build(discs, max_distance);
    }
    particle = i;
    seen.clear();
    const Vec3 p = at(i);
    grid.within(p, max_distance, [&](int t) {
      const auto &[a, b, c] = triangles[t];
      seen.add(t, a - p, b - p, c - p);
    });
    seen.fill_up();
  }
};

}    // namespace sphcloth

#endif
