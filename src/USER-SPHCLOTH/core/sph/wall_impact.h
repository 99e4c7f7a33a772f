// SPDX-License-Identifier: GPL-2.0-or-later
// Artificial viscosity between a particle and the half-space of fluid at rest behind a plane that
// it approaches: the sum over boundary particles there, as an integral.
//
// For a velocity across the plane every point behind it is approached.  The pair term of Monaghan
// (1992) takes it away at the rate
//   alpha c0 h_s rho0/rho int |F| z^2/(r^2 + 0.01 h_s^2) dV = alpha c0 h_s rho0/rho D/H^2,
// z the distance across the plane, F = 1/r dW/dr.  D depends on delta = distance/H alone.

#ifndef SPHCLOTH_CORE_SPH_WALL_IMPACT_H
#define SPHCLOTH_CORE_SPH_WALL_IMPACT_H

#include "core/sph/kernel.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sphcloth {

class WallImpact {
 public:
  // D; behind the plane that on the plane
  double operator()(double delta) const
  {
    if (!(delta < 1.0)) return 0.0;
    const double at = std::max(delta, 0.0) * PIECES;
    const int k = static_cast<int>(at);
    return nodes[k] + (at - k) * (nodes[k + 1] - nodes[k]);
  }

 private:
  static constexpr int PIECES = 60;
  std::array<double, PIECES + 1> nodes{};

  template <class Kernel> friend WallImpact wall_impact(int);
};

// The mean of z^2/q^2 over the part behind the plane of a sphere, or a circle, of radius q, times
// its size, is known; what is left is an integral over q.

template <class Kernel> WallImpact wall_impact(int dim)
{
  constexpr int N = 600, EACH = N / WallImpact::PIECES;
  constexpr double SOFT = 0.01 * 0.25;    // 0.01 h_s^2/H^2
  WallImpact table;
  for (int k = 0; k < WallImpact::PIECES; k++) {
    const double delta = static_cast<double>(k) / WallImpact::PIECES;
    double sum = 0.0;
    for (int m = k * EACH; m < N; m++) {
      const double q = (m + 0.5) / N, cosine = delta / q, angle = std::acos(cosine);
      const double squares = dim == 3 ? 2.0 * PI * q * q * (1.0 - cosine * cosine * cosine) / 3.0
                                      : q * (angle + cosine * std::sqrt(1.0 - cosine * cosine));
      sum -= Kernel::slope_over_q(q) * q * q * squares / (q * q + SOFT) / N;
    }
    table.nodes[k] = Kernel::norm(dim) * sum;
  }
  return table;
}

}    // namespace sphcloth

#endif
