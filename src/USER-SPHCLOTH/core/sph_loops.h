// Pair loops of the fluid: density (1), momentum (2), boundary particles.
//
// A fluid particle sums over fluid neighbours (its mass m_j) and over boundary neighbours, walls
// and cloth, which count with the mass rho0_i V_b that water in their volume V_b would have.
// Akinci et al., ACM Trans. Graph. 31 (2012) 62.
//
// Every loop writes one accumulator per particle and evaluates terms that are symmetric in the
// two partners, so the two halves of a pair cancel without a half list or a reverse communication.

#ifndef SPHCLOTH_CORE_SPH_LOOPS_H
#define SPHCLOTH_CORE_SPH_LOOPS_H

#include <algorithm>
#include <cmath>

#include "kernel.h"
#include "simd.h"

namespace sphcloth {

// per-particle data, owned and ghost; x and v are [n][3]

struct ParticleView {
  const double *x, *v;
  const double *amount;      // fluid: mass m; boundary: volume V_b
  const double *rho;         // density of fluid
  const double *pressure;    // p/rho^2 of fluid
  const int *type;
};

// one pair of types, as the loops need it

struct PairTerms {
  KernelScale kernel;
  double nu = 0.0;             // kinematic viscosity, mean of the two types
  double monaghan = 0.0;       // alpha c0 h_s of the artificial viscosity
  double soft = 0.0;           // 0.01 h_s^2, keeps its mu finite
  double rho0 = 0.0;           // rest density of the fluid partner of a boundary
  double stiffness = 1.0;      // pressure on this boundary over the fluid's own pressure
};

// the neighbours of one particle that are inside the support: fluid from the front of its
// stretch of the list, boundary from the back

struct Neighbourhood {
  const int *fluid, *boundary;
  int n_fluid, n_boundary;
};

struct Acceleration {
  double x = 0.0, y = 0.0, z = 0.0;
  double drho = 0.0;                // d rho / dt
  double virial[6] = {};            // half of sum r_ij f_ij per amount: xx, yy, zz, xy, xz, yz
};

// (1), without the particle itself

template <class Kernel, bool MULTI>
SPHCLOTH_MULTIVERSION double kernel_sum(const ParticleView &p, const PairTerms *terms,
                                        const double *rsq, const int *near, int n)
{
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (int k = 0; k < n; k++) {
    const int j = near[k];
    const KernelScale &s = terms[MULTI ? p.type[j] : 0].kernel;
    sum += p.amount[j] * s.w * Kernel::shape(std::sqrt(rsq[k]) * s.inv_support);
  }
  return sum;
}

// What the viscosity adds to the pressure terms, (p_i/rho_i^2 + p_j/rho_j^2), along the line of
// the particles.  Monaghan, Annu. Rev. Astron. Astrophys. 30 (1992) 543.

inline double artificial_viscosity(const PairTerms &t, double v_dot_r, double r_sq,
                                   double inv_mean_rho)
{
  return -t.monaghan * std::min(v_dot_r, 0.0) / (r_sq + t.soft) * inv_mean_rho;
}

// (2) for a fluid particle i from its fluid neighbours; terms is indexed by the neighbour's type
// if MULTI, otherwise terms[0] serves all.
// Laminar viscosity: Morris, Fox & Zhu, J. Comput. Phys. 136 (1997) 214.

template <class Kernel, bool VISCOUS, bool MULTI, bool VIRIAL>
SPHCLOTH_MULTIVERSION void fluid_on_fluid(const ParticleView &p, const PairTerms *terms, int i,
                                          const int *near, int n, Acceleration &a)
{
  const double xi = p.x[3 * i], yi = p.x[3 * i + 1], zi = p.x[3 * i + 2];
  const double ui = p.v[3 * i], vi = p.v[3 * i + 1], wi = p.v[3 * i + 2];
  const double rho_i = p.rho[i], p_i = p.pressure[i];
  double ax = 0.0, ay = 0.0, az = 0.0, drho = 0.0;
  double v0 = 0.0, v1 = 0.0, v2 = 0.0, v3 = 0.0, v4 = 0.0, v5 = 0.0;

#pragma omp simd reduction(+ : ax, ay, az, drho, v0, v1, v2, v3, v4, v5)
  for (int k = 0; k < n; k++) {
    const int j = near[k];
    const PairTerms &t = terms[MULTI ? p.type[j] : 0];
    const double dx = xi - p.x[3 * j], dy = yi - p.x[3 * j + 1], dz = zi - p.x[3 * j + 2];
    const double du = ui - p.v[3 * j], dv = vi - p.v[3 * j + 1], dw = wi - p.v[3 * j + 2];
    const double r_sq = dx * dx + dy * dy + dz * dz;
    const double slope = t.kernel.f * Kernel::slope_over_q(std::sqrt(r_sq) * t.kernel.inv_support);
    const double v_dot_r = du * dx + dv * dy + dw * dz;
    const double weight = p.amount[j] * slope;

    double along = p_i + p.pressure[j];
    double friction = 0.0;
    if (VISCOUS) {
      const double rho_j = p.rho[j];
      const double sum = rho_i + rho_j;
      along += artificial_viscosity(t, v_dot_r, r_sq, 2.0 / sum);
      friction = weight * t.nu * sum / (rho_i * rho_j);
    }
    const double push = -weight * along;
    const double fx = push * dx + friction * du;
    const double fy = push * dy + friction * dv;
    const double fz = push * dz + friction * dw;
    ax += fx;
    ay += fy;
    az += fz;
    drho += weight * v_dot_r;
    if (VIRIAL) {
      v0 += dx * fx;
      v1 += dy * fy;
      v2 += dz * fz;
      v3 += dx * fy;
      v4 += dx * fz;
      v5 += dy * fz;
    }
  }

  a.x += ax;
  a.y += ay;
  a.z += az;
  a.drho += drho;
  if (VIRIAL) {
    const double v[6] = {v0, v1, v2, v3, v4, v5};
    for (int m = 0; m < 6; m++) a.virial[m] += 0.5 * v[m];
  }
}

// One fluid particle f and one boundary particle b: the force between them over m_f V_b.
// The pressure term is the gradient of the fluid's energy with the density sum that the boundary
// takes part in.  A boundary that mirrors the fluid's pressure, twice this term, holds the first
// layer further off, but is not a gradient and heats resting water.
// Which of the two is asked does not matter but for the sign of r and v.

template <class Kernel, bool VISCOUS>
inline void boundary_terms(const PairTerms &t, double rho_f, double pressure_f, double r_sq,
                           double v_dot_r, double &push, double &friction, double &weight)
{
  weight = t.rho0 * t.kernel.f * Kernel::slope_over_q(std::sqrt(r_sq) * t.kernel.inv_support);
  double along = t.stiffness * pressure_f;
  friction = 0.0;
  if (VISCOUS) {
    along += artificial_viscosity(t, v_dot_r, r_sq, 1.0 / rho_f);
    friction = weight * t.nu * 2.0 / rho_f;
  }
  push = -weight * along;
}

// Force per "own amount" on particle i.  ON_BOUNDARY = false: i is fluid, the neighbours are
// boundary, result is an acceleration.  ON_BOUNDARY = true: i is boundary, the neighbours are
// fluid, the result is a force per volume V_i.

template <class Kernel, bool VISCOUS, bool ON_BOUNDARY, bool VIRIAL>
SPHCLOTH_MULTIVERSION void across_boundary(const ParticleView &p, const PairTerms *terms, int i,
                                           const int *near, int n, Acceleration &a)
{
  const double xi = p.x[3 * i], yi = p.x[3 * i + 1], zi = p.x[3 * i + 2];
  const double ui = p.v[3 * i], vi = p.v[3 * i + 1], wi = p.v[3 * i + 2];
  double ax = 0.0, ay = 0.0, az = 0.0, drho = 0.0;
  double v0 = 0.0, v1 = 0.0, v2 = 0.0, v3 = 0.0, v4 = 0.0, v5 = 0.0;

#pragma omp simd reduction(+ : ax, ay, az, drho, v0, v1, v2, v3, v4, v5)
  for (int k = 0; k < n; k++) {
    const int j = near[k];
    const int f = ON_BOUNDARY ? j : i;
    const PairTerms &t = terms[p.type[j]];
    const double dx = xi - p.x[3 * j], dy = yi - p.x[3 * j + 1], dz = zi - p.x[3 * j + 2];
    const double du = ui - p.v[3 * j], dv = vi - p.v[3 * j + 1], dw = wi - p.v[3 * j + 2];
    const double r_sq = dx * dx + dy * dy + dz * dz;
    const double v_dot_r = du * dx + dv * dy + dw * dz;
    double push, friction, weight;
    boundary_terms<Kernel, VISCOUS>(t, p.rho[f], p.pressure[f], r_sq, v_dot_r, push, friction,
                                    weight);
    const double amount = p.amount[j];
    const double fx = amount * (push * dx + friction * du);
    const double fy = amount * (push * dy + friction * dv);
    const double fz = amount * (push * dz + friction * dw);
    ax += fx;
    ay += fy;
    az += fz;
    drho += amount * weight * v_dot_r;
    if (VIRIAL) {
      v0 += dx * fx;
      v1 += dy * fy;
      v2 += dz * fz;
      v3 += dx * fy;
      v4 += dx * fz;
      v5 += dy * fz;
    }
  }

  a.x += ax;
  a.y += ay;
  a.z += az;
  if (!ON_BOUNDARY) a.drho += drho;
  if (VIRIAL) {
    const double v[6] = {v0, v1, v2, v3, v4, v5};
    for (int m = 0; m < 6; m++) a.virial[m] += 0.5 * v[m];
  }
}

}    // namespace sphcloth

#endif
