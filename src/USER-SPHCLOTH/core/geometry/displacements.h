// SPDX-License-Identifier: GPL-2.0-or-later
// How far points have come: the longest displacement of all of them, in one pass.

#ifndef SPHCLOTH_CORE_GEOMETRY_DISPLACEMENTS_H
#define SPHCLOTH_CORE_GEOMETRY_DISPLACEMENTS_H

#include "core/util/simd.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sphcloth {

// Of n points, x: [n][3], from where they were: a column per coordinate.  Infinite if any is no
// number.

SPHCLOTH_MULTIVERSION inline double longest_displacement(int n, const double *x, const double *x0,
                                                         const double *y0, const double *z0)
{
  double max_sq = 0.0, none = 0.0;
#pragma omp simd reduction(max : max_sq) reduction(+ : none)
  for (int i = 0; i < n; i++) {
    const double dx = x[3 * i] - x0[i], dy = x[3 * i + 1] - y0[i], dz = x[3 * i + 2] - z0[i];
    const double sq = dx * dx + dy * dy + dz * dz;
    max_sq = std::max(max_sq, sq);
    none += 0.0 * sq;
  }
  return none == 0.0 ? std::sqrt(max_sq) : std::numeric_limits<double>::infinity();
}

}    // namespace sphcloth

#endif
