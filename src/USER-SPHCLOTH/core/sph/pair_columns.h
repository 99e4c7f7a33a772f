// SPDX-License-Identifier: GPL-2.0-or-later
// Particles as records of four numbers, position with density and velocity with pressure, and the
// loop over the neighbors of one particle, for one precision.
//
// Records of neighbors become columns, a group at a time; the terms of a pair are then plain SIMD
// loops over a group.

#ifndef SPHCLOTH_CORE_SPH_PAIR_COLUMNS_H
#define SPHCLOTH_CORE_SPH_PAIR_COLUMNS_H

#include "core/sph/fluid.h"

#include <array>

namespace sphcloth {

struct DoublePrecision {
  using Real = double;
  using Coordinate = double;
  static constexpr bool COUNTED = false;
  static Coordinate coordinate(double x) { return x; }
  static Coordinate sum(Coordinate a, Coordinate b) { return a + b; }
  static Real difference(Coordinate a, Coordinate b, Real) { return a - b; }
};

// Coordinates are counted in a quantum, modulo 2^32: differences of neighbors are exact however far
// they are from the origin, and however long the box is.  Lengths are in a unit near the support:
// 1/H^5 is beyond single precision in some units.

struct MixedPrecision {
  using Real = float;
  using Coordinate = std::int32_t;
  static constexpr bool COUNTED = true;
  static Coordinate coordinate(double x)
  {
    return static_cast<Coordinate>(static_cast<std::int64_t>(x));
  }
  static Coordinate sum(Coordinate a, Coordinate b)
  {
    return static_cast<Coordinate>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
  }
  static Real difference(Coordinate a, Coordinate b, Real quantum)
  {
    const auto apart =
        static_cast<Coordinate>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
    return quantum * static_cast<Real>(apart);
  }
};

// PairTerms in the precision of the loops, with lengths in `unit`, a power of 2; masses, speeds and
// densities keep their units

template <class P> struct LoopTerms {
  using Real = typename P::Real;
  using Coordinate = typename P::Coordinate;

  Real inv_support, support_sq, f, nu, monaghan, soft, rho0, rho0_ratio, stiffness, diffusion;
  Coordinate outside;    // a distance along x outside the support

  // f_unit: of a force, 1/unit^(d+1)
  LoopTerms(const PairTerms &t, Real quantum, double unit, double f_unit) :
      inv_support(Real(t.kernel.inv_support * unit)),
      support_sq(Real(t.kernel.support_sq / (unit * unit))), f(Real(t.kernel.f * unit / f_unit)),
      nu(Real(t.nu / unit)), monaghan(Real(t.monaghan / unit)), soft(Real(t.soft / (unit * unit))),
      rho0(Real(t.rho0)), rho0_ratio(Real(t.rho0_ratio)), stiffness(Real(t.stiffness)),
      diffusion(Real(t.diffusion / unit)),
      outside(inv_support > 0 ? static_cast<Coordinate>(Real(2) / (inv_support * quantum)) : 0)
  {
  }
};

// masses of all neighbors of one particle: one column for all groups, step 0, if they are equal

struct MassColumns {
  const double *of;
  int step;
  const double *group(int from) const { return of + from * step; }
};

template <class P> class PairColumns {
 public:
  using Real = typename P::Real;
  using Coordinate = typename P::Coordinate;
  static constexpr int LANES = GROUP<Real>;

  struct Site {
    Coordinate x, y, z;
    Real density_or_volume;    // of fluid; of a boundary: four numbers are one gather per pair
  };
  struct Motion {
    Real u, v, w, p_over_rho2;
  };
  struct Gradient {
    Real x, y, z;
    Real since;    // of Diffusion, or 0
  };
  // one group of neighbors
  struct Columns {
    alignas(64) Coordinate x[LANES], y[LANES], z[LANES];
    alignas(64) Real density_or_volume[LANES], u[LANES], v[LANES], w[LANES], p_over_rho2[LANES];
    // where they are asked for: 1 or 0; of the artificial viscosity
    alignas(64) Real asleep[LANES], share[LANES];
  };
  // x_i - x_j
  struct Separation {
    Real x, y, z;
    Real sq() const { return x * x + y * y + z * z; }
  };
  // one particle and its neighbors of one type
  struct Neighborhood {
    int i;
    NeighborSpan near;
    const LoopTerms<P> &terms;
    MassColumns masses;
  };

  std::array<Real, 3> quantum{1, 1, 1};
  double unit = 1.0;    // of lengths
  AlignedVector<Site> sites;
  AlignedVector<Motion> motions;
  // of the density, empty unless it diffuses; or T of core/sph/surface_loops.h
  AlignedVector<Gradient> gradients;
  AlignedVector<Real> shares;    // of the artificial viscosity, empty unless it is switched
  mutable double n_evaluated = 0.0;    // pairs, by the loop over neighbors

  // Of some particles, null: of all
  void record_positions(const Particles &p, const Fluid::Box &box, double support,
                        const std::vector<int> *some)
  {
    unit = P::COUNTED ? std::exp2(std::floor(std::log2(support))) : 1.0;
    sites.resize(p.n_all + LANES);
    motions.resize(p.n_all + LANES);
    std::array<double, 3> origin{0.0, 0.0, 0.0}, per_quantum{1.0, 1.0, 1.0};
    if (P::COUNTED) {
      // In a long box a quantum is 2^-24 of the reach, which is what single precision resolves, and
      // neighbors are apart by little more than 2^24: far from 2^31, where their order is lost.
      constexpr double LONG = 64.0;
      const double margin = box.reach + box.tilt;
      double counted = *std::max_element(box.length, box.length + 3) + 2.0 * margin;
      if (box.reach > 0.0) counted = std::min(counted, LONG * box.reach);
      for (int d = 0; d < 3; d++) {
        origin[d] = box.lo[d] - margin;
        per_quantum[d] = std::ceil(box.length[d] / counted * 0x1p30) / box.length[d];
        quantum[d] = static_cast<Real>(1.0 / per_quantum[d] / unit);
      }
    }
    record_positions(p, origin, per_quantum, some);
  }

  SPHCLOTH_MULTIVERSION void record(const Particles &p, const Role *role, const double *scale,
                                    const std::vector<int> *some)
  {
    if (some)
      for (const int i : *some) record_one(p, role, scale, i);
    else
      for (int i = 0; i < p.n_all; i++) record_one(p, role, scale, i);
  }

  // Times scale in these units, since may be null.  Of some particles, null: of all n
  void record_gradients(const double *gradient, const double *since, double scale, int n,
                        const std::vector<int> *some)
  {
    gradients.resize(n + LANES);
    const double by = scale * unit;
    const auto record_one = [&](int i) {
      const double *of = gradient + 3 * i;
      gradients[i] = {static_cast<Real>(of[0] * by), static_cast<Real>(of[1] * by),
                      static_cast<Real>(of[2] * by),
                      since ? static_cast<Real>(since[i]) : Real(0)};
    };
    if (some)
      for (const int i : *some) record_one(i);
    else
      for (int i = 0; i < n; i++) record_one(i);
  }

  // Of some particles, null: of all n
  void record_shares(const double *share, int n, const std::vector<int> *some)
  {
    shares.resize(n + LANES);
    if (some)
      for (const int i : *some) shares[i] = static_cast<Real>(share[i]);
    else
      for (int i = 0; i < n; i++) shares[i] = static_cast<Real>(share[i]);
  }

  // The one loop over the neighbors of a particle: for each group load(first neighbor), which fills
  // columns with their positions, then term(lane, separation) in every lane, then done(first
  // neighbor).
  template <class Load, class Term>
  SPHCLOTH_INLINE void for_neighbors(const Neighborhood &of, Columns &c, Load load, Term term) const
  {
    for_neighbors(of, c, load, term, [](int) SPHCLOTH_LAMBDA {});
  }
  template <class Load, class Term, class Done>
  SPHCLOTH_INLINE void for_neighbors(const Neighborhood &of, Columns &c, Load load, Term term,
                                     Done done) const
  {
    n_evaluated += of.near.n;
    const Site site = sites[of.i];
    const Coordinate outside = P::sum(site.x, of.terms.outside);
    const Real qx = quantum[0], qy = quantum[1], qz = quantum[2];
    for (int from = 0; from < of.near.n; from += LANES) {
      load(from);
      fill_up(c, of.near.n - from, outside);
#pragma omp simd
      for (int k = 0; k < LANES; k++) {
        const Real dx = P::difference(site.x, c.x[k], qx), dy = P::difference(site.y, c.y[k], qy),
                   dz = P::difference(site.z, c.z[k], qz);
        term(k, Separation{dx, dy, dz});
      }
      done(from);
    }
  }

  // positions; with them densities or volumes; with these velocities and pressures

  SPHCLOTH_INLINE void load_positions(Columns &c, const int *near) const
  {
    columns(&sites[0].x, near, c.x, c.y, c.z, static_cast<Real *>(nullptr));
  }
  SPHCLOTH_INLINE void load_sites(Columns &c, const int *near) const
  {
    columns(&sites[0].x, near, c.x, c.y, c.z, c.density_or_volume);
  }
  SPHCLOTH_INLINE void load(Columns &c, const int *near) const
  {
    columns(&motions[0].u, near, c.u, c.v, c.w, c.p_over_rho2);
    load_sites(c, near);
  }

  static SPHCLOTH_INLINE void load_sleeping(Columns &c, const int *sleeping, const int *near)
  {
    for (int m = 0; m < LANES; m++) c.asleep[m] = static_cast<Real>(sleeping[near[m]]);
  }

  SPHCLOTH_INLINE void load_shares(Columns &c, const int *near) const
  {
    for (int m = 0; m < LANES; m++) c.share[m] = shares[near[m]];
  }

  double bytes() const { return bytes_of(sites, motions, gradients, shares); }

 private:
  SPHCLOTH_MULTIVERSION void record_positions(const Particles &p,
                                              const std::array<double, 3> &origin,
                                              const std::array<double, 3> &per_quantum,
                                              const std::vector<int> *some)
  {
    const double ox = origin[0], oy = origin[1], oz = origin[2];
    const double qx = per_quantum[0], qy = per_quantum[1], qz = per_quantum[2];
    const auto record_one = [&](int i) SPHCLOTH_LAMBDA {
      sites[i].x = P::coordinate((p.x[3 * i] - ox) * qx);
      sites[i].y = P::coordinate((p.x[3 * i + 1] - oy) * qy);
      sites[i].z = P::coordinate((p.x[3 * i + 2] - oz) * qz);
    };
    if (some)
      for (const int i : *some) record_one(i);
    else
      for (int i = 0; i < p.n_all; i++) record_one(i);
  }

  SPHCLOTH_INLINE void record_one(const Particles &p, const Role *role, const double *scale, int i)
  {
    const bool fluid = role[p.type[i]] == Role::FLUID;
    sites[i].density_or_volume = static_cast<Real>(fluid ? p.rho[i] : p.mass_or_volume[i]);
    motions[i] = {static_cast<Real>(p.v[3 * i]), static_cast<Real>(p.v[3 * i + 1]),
                  static_cast<Real>(p.v[3 * i + 2]),
                  static_cast<Real>(scale[p.type[i]] * p.p_over_rho2[i])};
  }

  // What fills up the last group, of n, lies outside the support.
  static SPHCLOTH_INLINE void fill_up(Columns &c, int n, Coordinate outside)
  {
    if (P::COUNTED) {    // a blend is the faster way with integers, a branch with doubles
#pragma omp simd
      for (int m = 0; m < LANES; m++) c.x[m] = m < n ? c.x[m] : outside;
    } else if (n < LANES) {
#pragma GCC unroll 1
      for (int m = LANES - 1; m >= n; m--) c.x[m] = outside;
    }
  }
};

}    // namespace sphcloth

#endif
