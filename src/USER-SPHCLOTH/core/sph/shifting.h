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

#include "core/neighbor/cell_lists.h"
#include "core/sph/kernel.h"
#include "core/sph/plane_wall.h"
#include "core/util/bytes.h"
#include "core/util/simd.h"

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

// What the loop over neighbors reads of each: where it is, and its volume now and at rest density

struct ShiftSites {
  struct Site {
    double x, y, z, volume;
  };
  AlignedVector<Site> sites;
  AlignedVector<double> at_rest;

  void resize(std::size_t n)
  {
    sites.resize(n);
    at_rest.resize(n);
  }
  double bytes() const { return bytes_of(sites, at_rest); }
};

// of one pair of types

struct ShiftTerms {
  KernelScale kernel;
  double inv_at_spacing;    // 1 over the kernel's shape at the spacing of the particle
  double clumping;
  int dimension;
};

// adds the neighbors of one type of particle i

template <class K>
SPHCLOTH_INLINE void add_neighbors(ConcentrationGradient &concentration, const ShiftSites &of,
                                   int i, const NeighborSpan &near, const ShiftTerms &terms)
{
  constexpr int N = GROUP<double>;
  const ShiftSites::Site self = of.sites[i];
  const double inv_support = terms.kernel.inv_support, f = terms.kernel.f,
               inv_at_spacing = terms.inv_at_spacing, clumping = terms.clumping,
               outside = self.x + 2.0 / inv_support;
  alignas(64) double x[N], y[N], z[N], volume[N], at_rest[N];
  LaneSum<N> gradient[3], cover;
  for (int from = 0; from < near.n; from += N) {
    const int *group = near.of + from;
    columns(&of.sites[0].x, group, x, y, z, volume);
    for (int k = 0; k < N; k++) at_rest[k] = of.at_rest[group[k]];
    for (int k = near.n - from; k < N; k++) x[k] = outside;
#pragma omp simd
    for (int k = 0; k < N; k++) {
      const double rx = self.x - x[k], ry = self.y - y[k], rz = self.z - z[k];
      const double r_sq = rx * rx + ry * ry + rz * rz;
      const double q = std::sqrt(r_sq) * inv_support;
      const double slope = f * K::slope_over_q(q);
      const double close = K::shape(q) * inv_at_spacing, close_sq = close * close;
      const double weight = volume[k] * slope * (1.0 + clumping * close_sq * close_sq);
      cover.of[k] += at_rest[k] * slope * r_sq;
      gradient[0].of[k] += weight * rx;
      gradient[1].of[k] += weight * ry;
      gradient[2].of[k] += weight * rz;
    }
  }
  for (int d = 0; d < 3; d++) concentration.gradient[d] += gradient[d].total();
  concentration.cover -= cover.total() / terms.dimension;
}

// What they add to the gradient of the velocity, from velocities of all, [n][3]

template <class K>
void add_velocities(ConcentrationGradient &concentration, const ShiftSites &of, int i,
                    const NeighborSpan &near, const KernelScale &s, const double *velocity)
{
  const ShiftSites::Site &self = of.sites[i];
  for (int k = 0; k < near.n; k++) {
    const int j = near.of[k];
    const ShiftSites::Site &other = of.sites[j];
    const std::array<double, 3> r{self.x - other.x, self.y - other.y, self.z - other.z};
    const double r_sq = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    const double weight = other.volume * s.f * K::slope_over_q(std::sqrt(r_sq) * s.inv_support);
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++)
        concentration.grad_v[3 * a + b] -=
            weight * (velocity[3 * i + a] - velocity[3 * j + a]) * r[b];
  }
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
