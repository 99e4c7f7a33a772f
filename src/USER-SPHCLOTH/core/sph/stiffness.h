// SPDX-License-Identifier: GPL-2.0-or-later
// What a fluid particle sees of its neighbors that move, and the fastest motion that follows.
//
// Small motions obey M x'' = -K x with K = sum_k s_k^2 g_k g_k^T, s_k = c_k sqrt(m_k)/rho_k and
// g_k the gradient of the density of particle k over the positions of all, itself included.  Scaled
// with the masses, K has the same eigenvalues as the matrix of s_k s_l sum_j g_kj . g_lj/m_j over
// pairs of fluid particles under pressure: its fluid part is bounded by the largest diagonal entry
// times the factor of the lattice (core/sph/lattice_modes.h), which is largest where there is
// order.  In order there are no g_kk.  At a free surface they are large, and move a particle alone:
// with f the factor, F the sum over j != k and G = |g_kk|^2/m_k, the roots of the largest
// eigenvalues add up to no more than sqrt((f-1) F) + sqrt(G), the tangent of sqrt(f (F + G)) from
// G = F/(f-1) on.  Waves of the largest factor do so in part only: f F + G + 1.5 sqrt(F G) is the
// bound where it is smaller, found in order, disorder, films and spray (two particles alone have
// 4 F, with F = G).
//
// Fluid in free flight moves and presses on nothing: its rows are 0, and what exceeds the diagonal
// counts as far as neighbors are under pressure.  With their share p, weighted with |g_kj|^2/m_j,
// the bound is F + G + sqrt(p) (B - F - G), B that of before, found in order and disorder where one
// third of the particles, two thirds or one half of space is in flight.
//
// The spring of a wall acts on one particle, and everything else moves that one alone with F + G at
// most: with L the bound of before and S that of the spring, a matrix of the largest eigenvalue L
// and a diagonal entry d, to which S is added, has none above
//   (L + S)/2 + sqrt((L - S)^2/4 + S d).
// Where all particles of a face have springs, what moves them together is more: d = 2 (F + G).
//
// Vertices of cloth may be much lighter than the fluid, and what they do to two particles may add
// up or not.  Their part is bounded with a_kj = s_k |g_kj|/sqrt(m_j) and unit vectors e_kj along
// g_kj by the largest sum of absolute values in a row, with Cauchy's inequality for the sum over l:
//   omega^2 <= max_k sum_j a_kj sqrt(tr T_j . e_kj^T T_j e_kj),   T_j = sum_l a_lj e_lj e_lj^T.

#ifndef SPHCLOTH_CORE_SPH_STIFFNESS_H
#define SPHCLOTH_CORE_SPH_STIFFNESS_H

#include <algorithm>
#include <cmath>

namespace sphcloth {

// of a fluid particle

struct Stiffness {
  double fluid = 0.0;    // sum over fluid neighbors of |d rho/d x_j|^2/m_j
  double pressed = 0.0;    // the same, times the shares of these neighbors
  double gradient[3] = {};    // d rho/d x of itself
  // the same of walls' springs alone, along each axis, of which the largest counts
  double spring[3] = {};
  double friction = 0.0;    // rate at which its neighbors would stop it (1/time)

  // mean share of the neighbors that is under pressure
  double pressed_share() const { return fluid > 0.0 ? pressed / fluid : 1.0; }
  // square of the largest frequency over s_k^2, with the factor of the lattice
  double largest(double mass, double factor, double share = 1.0) const
  {
    double squares = 0.0;
    for (const double g : gradient) squares += g * g;
    const double alone = squares / mass, single = fluid + alone;
    const double others = (factor - 1.0) * fluid;
    const double of_roots = (factor - 1.0) * alone <= fluid
        ? factor * single
        : others + alone + 2.0 * std::sqrt(others * alone);
    const double of_waves = factor * fluid + alone + 1.5 * std::sqrt(fluid * alone);
    const double together = single + std::sqrt(share) * (std::min(of_roots, of_waves) - single);
    const double springs = std::max({spring[0], spring[1], spring[2]});
    const double half = 0.5 * (together - springs);
    return 0.5 * (together + springs) +
        std::sqrt(half * half + springs * std::min(2.0 * single, together));
  }
};

// sums of products of two components of unit vectors

struct DirectionSums {
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0;

  void add(double times, double x, double y, double z)
  {
    xx += times * x * x;
    yy += times * y * y;
    zz += times * z * z;
    xy += times * x * y;
    xz += times * x * z;
    yz += times * y * z;
  }
  double trace() const { return xx + yy + zz; }
  double along(double x, double y, double z) const
  {
    return x * (xx * x + 2.0 * (xy * y + xz * z)) + y * (yy * y + 2.0 * yz * z) + zz * z * z;
  }
};

// Of a fluid particle: sums of |g_kj| e_kj e_kj^T and, away from the vertices, of |g_kj| e_kj

struct VertexGradients : public DirectionSums {
  double away[3] = {};

  void add(double times, double x, double y, double z)
  {
    DirectionSums::add(times, x, y, z);
    away[0] += times * x;
    away[1] += times * y;
    away[2] += times * z;
  }
};

// Of a vertex: the sum over fluid, T_j once it has V_j^2/m_j; and the rate at which fluid would
// stop it.

struct VertexStiffness : public DirectionSums {
  double friction = 0.0;
};

// of the vertices around a fluid particle: sum over j of |g_kj|/V_j sqrt(tr T . e^T T e), and the
// largest friction

struct VertexRow {
  double sum = 0.0, friction = 0.0;
};

}    // namespace sphcloth

#endif
