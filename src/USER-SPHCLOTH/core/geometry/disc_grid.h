// SPDX-License-Identifier: GPL-2.0-or-later
// Discs around triangles, sorted by their centers into cells: which triangles may be near a point,
// which may be the nearest?  No triangle is nearer than its disc, nor farther than the center.
//
// A query visits all cells from which the largest disc may reach the point, so small ones and
// large ones have grids of their own.

#ifndef SPHCLOTH_CORE_GEOMETRY_DISC_GRID_H
#define SPHCLOTH_CORE_GEOMETRY_DISC_GRID_H

#include "core/geometry/buckets.h"
#include "core/geometry/cell_grid.h"
#include "core/util/bytes.h"
#include "core/util/simd.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace sphcloth {

struct Disc {
  Eigen::Vector3d center, normal;    // without a normal it is a ball
  double radius;    // below 0: it is left out
  double room = 0.0;    // how far from it the triangle may be
};

inline Disc disc_around(const Eigen::Vector3d &a, const Eigen::Vector3d &b,
                        const Eigen::Vector3d &c)
{
  const Eigen::Vector3d center = (a + b + c) / 3.0, normal = (b - a).cross(c - a);
  const double radius_sq = std::max(
      {(a - center).squaredNorm(), (b - center).squaredNorm(), (c - center).squaredNorm()});
  const double area = normal.norm();
  return {center, area > 0.0 ? Eigen::Vector3d(normal / area) : Eigen::Vector3d::Zero(),
          std::sqrt(radius_sq)};
}

class DiscGrid {
 public:
  // for queries of about the distance `reach`; buffers are kept from build to build

  void build(const std::vector<Disc> &discs, double reach)
  {
    for (Size &size : sizes) size.members.clear();
    for (std::size_t d = 0; d < discs.size(); d++) {
      if (discs[d].radius < 0.0) continue;
      std::size_t n = 0;
      const double size = discs[d].radius + discs[d].room;
      for (double max = reach; size > max && n < MAX_SIZES - 1; max *= 2.0) n++;
      if (n >= sizes.size()) sizes.resize(n + 1);
      sizes[n].members.push_back(static_cast<int>(d));
    }
    for (Size &size : sizes) size.sort(discs, reach);
  }

  // calls visit(d) for every disc d that is not farther from p than `max_distance`, and for a few
  // more beside their rims

  template <class Visit> void within(const Eigen::Vector3d &p, double max_distance, Visit visit)
  {
    found.clear();
    for (Size &size : sizes)
      if (size.query(p, max_distance)) size.add_within(p, max_distance, found);
    for (const int d : found) visit(d);
  }

  // no disc is nearer to p than this, which is 0 or below inside their bounds
  double min_distance(const Eigen::Vector3d &p) const
  {
    double min = std::numeric_limits<double>::infinity();
    for (const Size &size : sizes)
      if (!size.grid.empty())
        min = std::min(min, std::sqrt(size.grid.bounds.squaredExteriorDistance(p)) - size.largest);
    return min;
  }

  // the same up to the nearest center of all, and `slack`

  template <class Visit>
  void nearest(const Eigen::Vector3d &p, double max_distance, double slack, Visit visit)
  {
    double min_sq = max_distance * max_distance;
    for (Size &size : sizes)
      if (size.query(p, max_distance)) min_sq = size.min_distance_sq(p, min_sq);
    within(p, std::min(max_distance, std::sqrt(min_sq) + slack), visit);
  }

  // Of discs that may be within `max_distance` of p those that may not lie along a plane, since the
  // cosine between the normals is smaller than `min_cos`, or since they are farther off than
  // `min_gap` and higher than aside, as seen from `origin`.
  const std::vector<int> &beside_plane(const Eigen::Vector3d &p, double max_distance,
                                       const Eigen::Vector3d &origin, const Eigen::Vector3d &normal,
                                       double min_cos, double min_gap)
  {
    found.clear();
    for (Size &size : sizes)
      if (size.query(p, max_distance))
        size.add_beside_plane(p, max_distance, origin, normal, min_cos, min_gap, found);
    return found;
  }

  double bytes() const
  {
    double sum = bytes_of(found);
    for (const Size &s : sizes)
      sum += bytes_of(s.members, s.first, s.items, s.x, s.y, s.z, s.radius, s.room) +
          bytes_of(s.across[0], s.across[1], s.across[2]);
    return sum;
  }

 private:
  static constexpr std::size_t MAX_SIZES = 32;

  struct Size {
    std::vector<int> members;
    CellGrid grid;
    double largest = 0.0;    // radius and room
    std::vector<int> first, items;
    std::vector<double> x, y, z, radius, room;    // in the order of the cells
    std::array<std::vector<double>, 3> across;    // normals
    CellGrid::Cell lo, hi;    // of the last query

    void sort(const std::vector<Disc> &discs, double reach)
    {
      Box bounds;
      largest = 0.0;
      for (const int d : members) {
        bounds.extend(discs[d].center);
        largest = std::max(largest, discs[d].radius + discs[d].room);
      }
      grid.bounds = bounds;
      if (members.empty()) return;
      grid.cut(bounds, Eigen::Vector3d::Constant(0.5 * (reach + largest)), members.size());
      const auto cell_of = [&](int d) {
        const CellGrid::Cell c = grid.of(discs[d].center);
        return grid.number(c[0], c[1], c[2]);
      };
      const auto for_each = [&](auto add) {
        for (const int d : members) add(cell_of(d), d);
      };
      sort_into_buckets(grid.size(), for_each, first, items);
      for (std::vector<double> *column :
           {&x, &y, &z, &radius, &room, &across[0], &across[1], &across[2]})
        column->assign(items.size() + LANES, std::numeric_limits<double>::infinity());
      for (std::size_t n = 0; n < items.size(); n++) {
        const Disc &disc = discs[items[n]];
        x[n] = disc.center[0];
        y[n] = disc.center[1];
        z[n] = disc.center[2];
        radius[n] = disc.radius;
        room[n] = disc.room;
        for (int d = 0; d < 3; d++) across[d][n] = disc.normal[d];
      }
    }

    // Which cells hold the centers of those within `max_distance`?  None: false.
    bool query(const Eigen::Vector3d &p, double max_distance)
    {
      const double reach = max_distance + largest;
      if (grid.empty() || !(grid.bounds.squaredExteriorDistance(p) <= reach * reach)) return false;
      lo = grid.of(p - Eigen::Vector3d::Constant(reach));
      hi = grid.of(p + Eigen::Vector3d::Constant(reach));
      return true;
    }

    // the minimum distance of a center, squared, if it is below what is known
    SPHCLOTH_MULTIVERSION double min_distance_sq(const Eigen::Vector3d &p, double known) const
    {
      const double px = p[0], py = p[1], pz = p[2];
      double min_sq[LANES];    // lane by lane, so that none waits for the one before
      for (double &lane : min_sq) lane = known;
      for (int k = lo[2]; k <= hi[2]; k++)
        for (int j = lo[1]; j <= hi[1]; j++)
          for (int n = begin_of_row(j, k), end = end_of_row(j, k); n < end; n += LANES) {
            const double *cx = &x[n], *cy = &y[n], *cz = &z[n];
#pragma omp simd
            for (int l = 0; l < LANES; l++) {
              const double dx = px - cx[l], dy = py - cy[l], dz = pz - cz[l];
              const double sq = dx * dx + dy * dy + dz * dz;
              min_sq[l] = sq < min_sq[l] ? sq : min_sq[l];
            }
          }
      return *std::min_element(min_sq, min_sq + LANES);
    }

    SPHCLOTH_MULTIVERSION void add_within(const Eigen::Vector3d &p, double max_distance,
                                          std::vector<int> &to) const
    {
      const double px = p[0], py = p[1], pz = p[2];
      for (int k = lo[2]; k <= hi[2]; k++)
        for (int j = lo[1]; j <= hi[1]; j++)
          for (int n = begin_of_row(j, k), end = end_of_row(j, k); n < end; n += LANES) {
            const double *cx = &x[n], *cy = &y[n], *cz = &z[n], *r = &radius[n], *more = &room[n];
            const double *nx = &across[0][n], *ny = &across[1][n], *nz = &across[2][n];
            double near[LANES], any = 0.0;
#pragma omp simd reduction(+ : any)
            for (int l = 0; l < LANES; l++) {
              const double dx = px - cx[l], dy = py - cy[l], dz = pz - cz[l];
              const double height = nx[l] * dx + ny[l] * dy + nz[l] * dz;
              const double max = max_distance + more[l], reach = max + r[l];
              const double sq = dx * dx + dy * dy + dz * dz;
              near[l] = (std::fabs(height) <= max) & (sq <= reach * reach) ? 1.0 : 0.0;
              any += near[l];
            }
            if (any > 0.0) add_lanes(near, n, end, to);
          }
    }

    SPHCLOTH_MULTIVERSION void add_beside_plane(const Eigen::Vector3d &p, double max_distance,
                                                const Eigen::Vector3d &origin,
                                                const Eigen::Vector3d &normal, double min_cos,
                                                double min_gap, std::vector<int> &to) const
    {
      const double reach = max_distance + largest, reach_sq = reach * reach;
      const double px = p[0], py = p[1], pz = p[2];
      const double ox = origin[0], oy = origin[1], oz = origin[2];
      const double ax = normal[0], ay = normal[1], az = normal[2];
      for (int k = lo[2]; k <= hi[2]; k++)
        for (int j = lo[1]; j <= hi[1]; j++)
          for (int n = begin_of_row(j, k), end = end_of_row(j, k); n < end; n += LANES) {
            const double *cx = &x[n], *cy = &y[n], *cz = &z[n], *r = &radius[n];
            const double *nx = &across[0][n], *ny = &across[1][n], *nz = &across[2][n];
            double beside[LANES], any = 0.0;
#pragma omp simd reduction(+ : any)
            for (int l = 0; l < LANES; l++) {
              const double fx = px - cx[l], fy = py - cy[l], fz = pz - cz[l];
              const double dx = cx[l] - ox, dy = cy[l] - oy, dz = cz[l] - oz;
              const double height = std::fabs(nx[l] * dx + ny[l] * dy + nz[l] * dz);
              const double tip = height + r[l];
              const double aside_sq = dx * dx + dy * dy + dz * dz - height * height;
              const double off = (height > min_gap) & (aside_sq < tip * tip) ? 1.0 : 0.0;
              const double bent = nx[l] * ax + ny[l] * ay + nz[l] * az < min_cos ? 1.0 : 0.0;
              beside[l] = fx * fx + fy * fy + fz * fz <= reach_sq ? off + bent : 0.0;
              any += beside[l];
            }
            if (any > 0.0) add_lanes(beside, n, end, to);
          }
    }

    // of the group at n, those that are marked
    SPHCLOTH_INLINE void add_lanes(const double *marked, int n, int end, std::vector<int> &to) const
    {
      for (int l = 0; l < std::min(LANES, end - n); l++)
        if (marked[l] > 0.0) to.push_back(items[n + l]);
    }

    // cells of a row along x lie one behind the other
    int begin_of_row(int j, int k) const { return first[grid.number(lo[0], j, k)]; }
    int end_of_row(int j, int k) const { return first[grid.number(hi[0], j, k) + 1]; }
  };

  std::vector<Size> sizes;    // of twice the radius each
  std::vector<int> found;
};

}    // namespace sphcloth

#endif
