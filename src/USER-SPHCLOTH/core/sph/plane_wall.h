// SPDX-License-Identifier: GPL-2.0-or-later
// A plane wall as a half-space of fluid at rest density: what the kernel's part behind the plane
// adds to the density sum (1), to the momentum (2), and to the laminar friction.
//
// With delta = d/H, d the distance of the particle from the plane,
//   lambda(delta)  = int_{z > d} W dV        (1/2 at the plane, 0 from delta = 1 on)
//   -dlambda/dd    = w(delta)/H, w the integral of W over the plane itself.
// Behind the plane lambda(-delta) = 1 - lambda(delta).
// Kulasegaram, Bonet, Lewis & Profit, Comput. Mech. 33 (2004) 316; Feldman & Bonet, Int. J. Numer.
// Meth. Engng 72 (2007) 295.
//
// The laminar term of Morris, Fox & Zhu, J. Comput. Phys. 136 (1997) 214, with the velocity behind
// the plane continued linearly, u_j - u_w = -(d_j/d)(u_i - u_w), d_j the depth behind the plane,
// needs no further integral: 1 + d_j/d = z/d, so
//   int_{z > d} (1/r dW/dr) (z/d) dV = (1/d) int_{z > d} dW/dz dV = -w/(H d).

#ifndef SPHCLOTH_CORE_SPH_PLANE_WALL_H
#define SPHCLOTH_CORE_SPH_PLANE_WALL_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/sph/kernel.h"

namespace sphcloth {

// Nearer than this to the wall, in units of H, friction no longer grows as 1/d.  A particle there
// loses velocity at a rate of 2 nu w/(H d) <= 24 nu/H^2 to the wall and about half of the 28 nu/H^2
// of the interior to fluid: within the viscous limit of the time step.
inline constexpr double NEAREST_FRICTION = 0.125;

// Behind the wall a particle of mass m has the energy m c0^2 x^2/2, x the depth in units of this
// times H: what comes slower than sound is sent back before that depth.
inline constexpr double STOPPING_DEPTH = 0.5;

// A cubic Hermite piece that rises from `start`, with slopes a and b at its ends, and its
// derivatives with respect to 0 <= t <= 1

struct HermitePiece {
  double value, slope, curvature;
};

inline HermitePiece hermite(double start, double rise, double a, double b, double t)
{
  const double u = 1.0 - t;
  return {start + rise * t * t * (3.0 - 2.0 * t) + t * u * (a * u - b * t),
          6.0 * rise * t * u + a * u * (1.0 - 3.0 * t) + b * t * (1.0 - 3.0 * u),
          6.0 * rise * (u - t) + a * (6.0 * t - 4.0) + b * (6.0 * t - 2.0)};
}

// lambda and its derivatives with respect to delta, by cubic Hermite interpolation of exact values
// and slopes.  The slope is that of the interpolation, so that a force made from it is the gradient
// of an energy.

class WallTable {
 public:
  struct Value {
    double lambda, slope, curvature;
  };

  Value operator()(double delta) const
  {
    if (!(delta < 1.0)) return {0.0, 0.0, 0.0};    // nor is there a wall for what is no number
    if (delta < 0.0) {
      const Value front = (*this)(-delta);
      return {1.0 - front.lambda, front.slope, -front.curvature};
    }
    const double table_index = delta * PIECES;
    const int k = static_cast<int>(table_index);
    const Node &a = nodes[k], &b = nodes[k + 1];
    const HermitePiece piece =
        hermite(a.lambda, b.lambda - a.lambda, a.slope / PIECES, b.slope / PIECES, table_index - k);
    return {piece.value, PIECES * piece.slope,
            static_cast<double>(PIECES) * PIECES * piece.curvature};
  }

 private:
  // a multiple of 2, 3 and 5, so that the kinks of spline kernels are at ends of pieces
  static constexpr int PIECES = 480;

  struct Node {
    double lambda, slope;
  };
  std::vector<Node> nodes;    // PIECES + 1

  template <class Kernel> friend WallTable wall_table(int);
};

// Over spheres of radius q around the particle; t = sqrt(q^2 - delta^2) is the distance along the
// plane, q dq = t dt, and takes the root out of the integrand.

template <class Kernel> WallTable wall_table(int dim)
{
  static constexpr double GAUSS_X[4] = {-0.8611363115940526, -0.3399810435848563,
                                        0.3399810435848563, 0.8611363115940526};
  static constexpr double GAUSS_W[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                        0.3478548451374538};
  constexpr int N = WallTable::PIECES;
  WallTable table;
  table.nodes.resize(N + 1);
  for (int k = 0; k <= N; k++) {
    const double delta = static_cast<double>(k) / N;
    double lambda = 0.0, w = 0.0, t_low = 0.0;
    for (int p = k; p < N; p++) {
      const double q_high = (p + 1.0) / N;
      const double t_high = std::sqrt(q_high * q_high - delta * delta);
      const double half = 0.5 * (t_high - t_low), middle = 0.5 * (t_high + t_low);
      for (int g = 0; g < 4; g++) {
        const double t = middle + half * GAUSS_X[g];
        const double q = std::sqrt(delta * delta + t * t);
        const double s = half * GAUSS_W[g] * Kernel::shape(std::min(q, 1.0));
        // the part of the sphere (or circle) behind the plane over q, and the ring in the plane
        lambda += s * t * (dim == 3 ? 2.0 * PI * (q - delta) : 2.0 * std::atan2(t, delta));
        w += s * (dim == 3 ? 2.0 * PI * t : 2.0);
      }
      t_low = t_high;
    }
    table.nodes[k] = {Kernel::norm(dim) * lambda, -Kernel::norm(dim) * w};
  }
  return table;
}

// The missing part of several walls together: 1 - prod (1 - lambda_k).  For two planes at right
// angles it is exact where one is out of reach and on the edge itself.  share(k), the derivative
// with respect to lambda_k, is what wall k keeps of its force and friction beside the others.

template <class Values> double joint_lambda(const Values &walls)
{
  double open = 1.0;
  for (std::size_t l = 0; l < walls.size(); l++) open *= 1.0 - walls[l].lambda;
  return 1.0 - open;
}

template <class Values> double joint_share(const Values &walls, std::size_t k)
{
  double open = 1.0;
  for (std::size_t l = 0; l < walls.size(); l++)
    if (l != k) open *= 1.0 - walls[l].lambda;
  return open;
}

// rate at which the wall takes tangential velocity away, over 2 nu rho0/rho (1/distance^2)

inline double wall_friction(const WallTable::Value &value, double delta, double support)
{
  return -value.slope / (support * support * std::max(delta, NEAREST_FRICTION));
}

// depth behind the wall in units of its stopping depth, 0 in front of it

inline double stop_strain(double delta) { return std::max(-delta, 0.0) / STOPPING_DEPTH; }

}    // namespace sphcloth

#endif
