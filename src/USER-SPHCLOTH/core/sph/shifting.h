// SPDX-License-Identifier: GPL-2.0-or-later
// Particle shifting: a small displacement along minus the gradient of the concentration
//   C_i = sum_j V_j W_ij,    grad C_i = sum_j V_j [1 + R (W_ij/W(dx))^4] grad_i W_ij,
// takes particles from where they are crowded to where they are sparse; dx is the spacing of the
// particle, R the strength of the term against clumping.
//
// The displacement of one step is -A H U dt grad C_i, with a speed U and the support H; A = 2 is
// that of Sun et al.
//
// Lind, Xu, Stansby & Rogers, J. Comput. Phys. 231 (2012) 1499, equations (16) to (25); Skillen,
// Lind, Stansby & Rogers, Comput. Methods Appl. Mech. Eng. 265 (2013) 163 (in proportion to speed
// and time); Sun, Colagrossi, Marrone & Zhang, Comput. Methods Appl. Mech. Eng. 315 (2017) 25.
//
// Whether a particle is at a free surface follows from the divergence of position, per dimension:
//   -(1/d) sum_j V_j (x_i - x_j) . grad_i W_ij,    1 inside.
// Lee et al., J. Comput. Phys. 227 (2008) 8417.

#ifndef SPHCLOTH_CORE_SPH_SHIFTING_H
#define SPHCLOTH_CORE_SPH_SHIFTING_H

#include <array>
#include <cmath>

#include "core/sph/kernel.h"
#include "core/sph/plane_wall.h"

namespace sphcloth {

struct ShiftCoefficients {
  double strength = 1.0;    // A
  double clumping = 0.2;    // R
  double surface = 0.8;    // divergence of position over d, less is a free surface
  double largest = 0.1;    // shift in one step over the spacing
};

// length of the cube (square) that the volume of a particle fills

inline double spacing_of(double volume, int dim)
{
  return dim == 3 ? std::cbrt(volume) : std::sqrt(volume);
}

// what the neighbors of one particle add up to

struct ConcentrationGradient {
  std::array<double, 3> gradient{};    // of the concentration
  double cover = 0.0;    // divergence of position over d
  std::array<double, 9> grad_v{};    // d v_a / d x_b
};

// one neighbor: r = x_i - x_j, `volume` its own now, `volume_at_rest` the one at rest density

struct NeighborTerm {
  std::array<double, 3> r;
  double volume, volume_at_rest;
};

template <class K>
void add_neighbor(ConcentrationGradient &concentration, const NeighborTerm &n, const KernelScale &s,
                  double shape_at_spacing, double clumping, int dim)
{
  const double r_sq = n.r[0] * n.r[0] + n.r[1] * n.r[1] + n.r[2] * n.r[2];
  const double q = std::sqrt(r_sq) * s.inv_support;
  const double slope = s.f * K::slope_over_q(q);
  const double close = K::shape(q) / shape_at_spacing, close_sq = close * close;
  const double weight = n.volume * slope * (1.0 + clumping * close_sq * close_sq);
  concentration.cover -= n.volume_at_rest * slope * r_sq / dim;
  for (int a = 0; a < 3; a++) concentration.gradient[a] += weight * n.r[a];
}

// what it adds to the gradient of the velocity; v = v_i - v_j

template <class K>
void add_velocity(ConcentrationGradient &concentration, const NeighborTerm &n,
                  const std::array<double, 3> &v, const KernelScale &s)
{
  const double r_sq = n.r[0] * n.r[0] + n.r[1] * n.r[1] + n.r[2] * n.r[2];
  const double weight = n.volume * s.f * K::slope_over_q(std::sqrt(r_sq) * s.inv_support);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) concentration.grad_v[3 * a + b] -= weight * v[a] * n.r[b];
}

// A plane wall at delta = distance/H, filled with fluid behind it.  The kernel's gradient
// integrates to that of lambda; the divergence of position, by Gauss's theorem, to d lambda + delta
// w.

inline double wall_cover(const WallTable::Value &wall, double delta, int dim)
{
  return wall.lambda - delta * wall.slope / dim;
}

// Shortens a displacement to `longest`; true if it had to.

inline bool cut_to(std::array<double, 3> &shift, double longest)
{
  const double length = std::sqrt(shift[0] * shift[0] + shift[1] * shift[1] + shift[2] * shift[2]);
  if (length <= longest) return false;
  for (double &s : shift) s *= longest / length;
  return true;
}

}    // namespace sphcloth

#endif
