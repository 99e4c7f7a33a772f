// SPDX-License-Identifier: GPL-2.0-or-later
// How far the sides of many pairs of one kind are apart at least, in vectors:
// distance_along_centers() of each.

#ifndef SPHCLOTH_CORE_CONTACT_CENTER_DISTANCES_H
#define SPHCLOTH_CORE_CONTACT_CENTER_DISTANCES_H

#include "core/contact/closest_points.h"
#include "core/util/bytes.h"
#include "core/util/simd.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace sphcloth {

class CenterDistances {
 public:
  // four positions of a pair, by their numbers
  using Four = std::array<int, 4>;

  void load(const std::vector<Vec3> &positions)
  {
    at.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); i++)
      at[i] = {positions[i][0], positions[i][1], positions[i][2], 0.0};
  }

  // Of n pairs, to `to`.  Both hold whole groups: behind the n there are pairs of any vertices.
  void measure(PairKind kind, const Four *pairs, int n, double *to) const
  {
    kind == PairKind::POINT_TRIANGLE ? of_triangles(pairs, n, to) : of_edges(pairs, n, to);
  }

  double bytes() const { return bytes_of(at); }

 private:
  struct Position {
    double x, y, z, w;
  };
  AlignedVector<Position> at;

  SPHCLOTH_INLINE const Row &row(int i) const { return *reinterpret_cast<const Row *>(&at[i]); }

  // of a group: from center to center, and two vectors to corners, in columns
  struct Group {
    alignas(64) double lx[LANES], ly[LANES], lz[LANES], ax[LANES], ay[LANES], az[LANES], bx[LANES],
        by[LANES], bz[LANES], w[LANES];

    SPHCLOTH_INLINE void take(const Row *line, const Row *a, const Row *b)
    {
      for (int l = 0; l < LANES; l += 4) {
        to_columns(line + l, lx + l, ly + l, lz + l, w + l);
        to_columns(a + l, ax + l, ay + l, az + l, w + l);
        to_columns(b + l, bx + l, by + l, bz + l, w + l);
      }
    }
  };

  SPHCLOTH_MULTIVERSION void of_triangles(const Four *pairs, int n, double *to) const
  {
    constexpr double THIRD = 1.0 / 3.0;
    for (int m = 0; m < n; m += LANES) {
      Row line[LANES], first[LANES], second[LANES];
      for (int l = 0; l < LANES; l++) {
        const Four &of = pairs[m + l];
        const Row &a = row(of[1]), &b = row(of[2]), center = THIRD * (a + b + row(of[3]));
        line[l] = row(of[0]) - center;
        first[l] = a - center;
        second[l] = b - center;
      }
      Group g;
      g.take(line, first, second);
#pragma omp simd
      for (int l = 0; l < LANES; l++) {
        const double x = g.lx[l], y = g.ly[l], z = g.lz[l];
        const double a = g.ax[l] * x + g.ay[l] * y + g.az[l] * z,
                     b = g.bx[l] * x + g.by[l] * y + g.bz[l] * z, c = -(a + b);
        const double ab = a > b ? a : b, reach = ab > c ? ab : c;
        const double sq = x * x + y * y + z * z;
        to[m + l] = sq > 0.0 ? (sq - reach) / std::sqrt(sq) : sq;
      }
    }
  }

  SPHCLOTH_MULTIVERSION void of_edges(const Four *pairs, int n, double *to) const
  {
    for (int m = 0; m < n; m += LANES) {
      Row line[LANES], first[LANES], second[LANES];
      for (int l = 0; l < LANES; l++) {
        const Four &of = pairs[m + l];
        const Row &p = row(of[0]), &q = row(of[1]), &a = row(of[2]), &b = row(of[3]);
        line[l] = 0.5 * ((p + q) - (a + b));
        first[l] = 0.5 * (q - p);
        second[l] = 0.5 * (b - a);
      }
      Group g;
      g.take(line, first, second);
#pragma omp simd
      for (int l = 0; l < LANES; l++) {
        const double x = g.lx[l], y = g.ly[l], z = g.lz[l];
        const double reach = std::fabs(g.ax[l] * x + g.ay[l] * y + g.az[l] * z) +
            std::fabs(g.bx[l] * x + g.by[l] * y + g.bz[l] * z);
        const double sq = x * x + y * y + z * z;
        to[m + l] = sq > 0.0 ? (sq - reach) / std::sqrt(sq) : sq;
      }
    }
  }
};

}    // namespace sphcloth

#endif
