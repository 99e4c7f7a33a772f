// SPDX-License-Identifier: GPL-2.0-or-later
// Sums over the half-space behind a plane, for what core/sph knows of plane walls as integrals.

#ifndef SPHCLOTH_TESTS_HALF_SPACE_H
#define SPHCLOTH_TESTS_HALF_SPACE_H

#include "core/sph/kernel.h"

#include <cmath>

namespace sphcloth {

// Midpoint rule over the slab between delta and 1, rings of radius t around its axis; in two
// dimensions a ring is two points.  Uses nothing of the tables that are tested.
template <class Term> double behind(double delta, int dim, const Term &term)
{
  const int n = 1000;
  const double dz = (1.0 - delta) / n, dt = 1.0 / n;
  double sum = 0.0;
  for (int a = 0; a < n; a++)
    for (int b = 0; b < n; b++) {
      const double z = delta + (a + 0.5) * dz, t = (b + 0.5) * dt, q = std::sqrt(z * z + t * t);
      if (q < 1.0) sum += term(q, z) * (dim == 3 ? 2.0 * PI * t : 2.0) * dz * dt;
    }
  return sum;
}

}    // namespace sphcloth

#endif
