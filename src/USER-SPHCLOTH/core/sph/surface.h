// SPDX-License-Identifier: GPL-2.0-or-later
// A density sum that is completed at a free surface.
//
// Where the fluid ends at a plane at the distance d, the sum (1) is S = rho (1 - lambda(d/H)), and
// its gradient has the length G = -rho lambda'(d/H)/H.  Their ratio does not depend on rho and
// shows where the plane is, so
//   rho_i = S_i h(x_i),    x_i = H G_i/S_i,    h(-lambda'/(1 - lambda)) = 1/(1 - lambda).
// Nearer to a surface than any particle can be inside of it, h is 2.  Inside x is 0 and h is 1, and
// in a sheet or a drop of few particles, whose gradients cancel, the sum stays as it is.
//
// The forces are the gradient of the energy sum m e(rho_i), with
//   d rho_i = (h - x h') d S_i + h' H n_i . d grad S_i,    n_i = grad S_i/G_i.

#ifndef SPHCLOTH_CORE_SPH_SURFACE_H
#define SPHCLOTH_CORE_SPH_SURFACE_H

#include "core/sph/plane_wall.h"

namespace sphcloth {

class SurfaceTable {
 public:
  struct Value {
    double factor, slope;    // h and its derivative, that of the interpolation
  };

  explicit SurfaceTable(const WallTable &wall) : largest(gradient_ratio(wall, 0.0))
  {
    for (int k = 0; k <= PIECES; k++) {
      const double delta = k < PIECES ? delta_of(wall, largest * k / PIECES) : 0.0;
      const WallTable::Value of = wall(delta);
      const double open = 1.0 - of.lambda;
      const double rise = of.curvature * open + of.slope * of.slope;    // -dx/d(delta) open^2
      nodes[k] = {1.0 / open, rise > 0.0 ? -of.slope / rise : 0.0};
    }
    nodes[0] = {1.0, 0.0};
  }

  Value operator()(double x) const
  {
    if (!(x > 0.0)) return {1.0, 0.0};
    if (x >= largest) return {nodes[PIECES].factor, 0.0};
    const double width = largest / PIECES, table_index = x / width;
    const int k = std::min(static_cast<int>(table_index), PIECES - 1);
    const Value &a = nodes[k], &b = nodes[k + 1];
    const HermitePiece piece = hermite(a.factor, b.factor - a.factor, a.slope * width,
                                       b.slope * width, table_index - k);
    return {piece.value, piece.slope / width};
  }

 private:
  static constexpr int PIECES = 256;

  double largest;    // x at the surface itself
  std::vector<Value> nodes = std::vector<Value>(PIECES + 1);

  static double gradient_ratio(const WallTable &wall, double delta)
  {
    const WallTable::Value of = wall(delta);
    return -of.slope / (1.0 - of.lambda);
  }
  // x falls with the distance
  static double delta_of(const WallTable &wall, double x)
  {
    double low = 0.0, high = 1.0;
    for (int n = 0; n < 60; n++) {
      const double middle = 0.5 * (low + high);
      (gradient_ratio(wall, middle) > x ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
};

// H |grad grad W n| over |grad W|, n any direction, each the root of the mean square over the
// support: with it a density that is completed changes by no more than |h - x h'| + h' times this
// as much as the sum does, if its neighbors are spread evenly.

template <class Kernel> double bend_over_slope(int dim)
{
  constexpr int N = 1000;
  double bends = 0.0, slopes = 0.0;
  for (int k = 0; k < N; k++) {
    const double q = (k + 0.5) / N, ring = dim == 3 ? q * q : q;
    const double slope = Kernel::slope_over_q(q), along = q * q * Kernel::bend_over_q(q);
    bends += ring * (slope * slope + (2.0 * slope + along) * along / dim);
    slopes += ring * q * q * slope * slope;
  }
  return std::sqrt(bends / slopes);
}

}    // namespace sphcloth

#endif
