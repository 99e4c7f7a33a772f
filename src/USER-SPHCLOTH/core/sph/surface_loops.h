// SPDX-License-Identifier: GPL-2.0-or-later
// A density that is completed at free surfaces (core/sph/surface.h): the gradient of the sum (1),
// and the force that its change gives beside the pressure along the line of two particles,
//   a_i = -sum_j m_j (grad grad W_ij) (T_i - T_j),    T = p/rho^2 h' H n.

#ifndef SPHCLOTH_CORE_SPH_SURFACE_LOOPS_H
#define SPHCLOTH_CORE_SPH_SURFACE_LOOPS_H

#include "core/sph/fluid_loops.h"

namespace sphcloth {

template <class K, class P> struct FluidLoops<K, P>::SurfaceSums {
  LaneSum<LANES> x, y, z, virial[6];

  // masses, or volumes of a boundary, each times `each`
  SPHCLOTH_INLINE void add_gradient(const Records &records, const Neighborhood &of, double each,
                                    Columns &c)
  {
    const Terms &t = of.terms;
    const double *mass = nullptr;
    records.for_neighbors(
        of, c,
        [&](int from) SPHCLOTH_LAMBDA {
          records.load_positions(c, of.near.of + from);
          mass = of.masses.group(from);
        },
        [&](int k, Separation r) SPHCLOTH_LAMBDA {
          const Real slope = t.f * K::slope_over_q(std::sqrt(r.sq()) * t.inv_support);
          const double weight = mass[k] * (each * slope);
          x.of[k] += weight * r.x;
          y.of[k] += weight * r.y;
          z.of[k] += weight * r.z;
        });
  }

  // A boundary has no T.  WALL: one of the two is a boundary, and `rho0` makes its volume a mass.
  template <bool WALL, bool FROM_BOUNDARY, bool VIRIAL>
  SPHCLOTH_INLINE void add_turns(const Records &records, const Neighborhood &of, Columns &c)
  {
    const Terms &t = of.terms;
    const typename Records::Gradient turn = records.gradients[of.i];
    const Real scale = t.stiffness * (WALL ? t.rho0 : Real(1));
    const Real bend = t.f * t.inv_support * t.inv_support;
    alignas(64) Real tx[LANES], ty[LANES], tz[LANES];
    const double *mass = nullptr;
    records.for_neighbors(
        of, c,
        [&](int from) SPHCLOTH_LAMBDA {
          const int *near = of.near.of + from;
          records.load_sites(c, near);
          columns(&records.gradients[0].x, near, tx, ty, tz, static_cast<Real *>(nullptr));
          if (!FROM_BOUNDARY) mass = of.masses.group(from);
        },
        [&](int k, Separation r) SPHCLOTH_LAMBDA {
          const Real q = std::sqrt(r.sq()) * t.inv_support;
          const Real dx = turn.x - tx[k], dy = turn.y - ty[k], dz = turn.z - tz[k];
          const Real slope = t.f * K::slope_over_q(q);
          const Real along = bend * K::bend_over_q(q) * (dx * r.x + dy * r.y + dz * r.z);
          const double weight =
              -scale * (FROM_BOUNDARY ? static_cast<double>(c.density_or_volume[k]) : mass[k]);
          const double fx = weight * (slope * dx + along * r.x),
                       fy = weight * (slope * dy + along * r.y),
                       fz = weight * (slope * dz + along * r.z);
          x.of[k] += fx;
          y.of[k] += fy;
          z.of[k] += fz;
          if (!VIRIAL) return;
          virial[0].of[k] += r.x * fx;
          virial[1].of[k] += r.y * fy;
          virial[2].of[k] += r.z * fz;
          virial[3].of[k] += 0.5 * (r.x * fy + r.y * fx);
          virial[4].of[k] += 0.5 * (r.x * fz + r.z * fx);
          virial[5].of[k] += 0.5 * (r.y * fz + r.z * fy);
        });
  }

  Acceleration total(double f_unit, double unit, bool with_virial) const
  {
    Acceleration a{f_unit * x.total(), f_unit * y.total(), f_unit * z.total(), 0.0, 0.0, {}};
    if (with_virial)
      for (int m = 0; m < 6; m++) a.virial[m] = 0.5 * f_unit * unit * virial[m].total();
    return a;
  }
};

// virtual functions cannot be multiversioned, so these do their work

template <class K, class P> struct FluidLoops<K, P>::SurfaceLoops {
  FluidLoops &fluid;

  SPHCLOTH_MULTIVERSION void sum_gradients(const Particles &p, double *gradient) const
  {
    Columns c;
    for (int t = 1; t <= fluid.model.n_types; t++) {
      if (!fluid.is_fluid(t)) continue;
      for (const int slot : fluid.selection.of(t)) {
        const int i = fluid.lists.at(slot);
        SurfaceSums sums;
        for (const int other : fluid.lists.present_types()) {
          const NeighborSpan near = fluid.lists(slot, other);
          if (near.n == 0) continue;
          const PairTerms &whole = fluid.model.pair(t, other);
          const double each = fluid.is_fluid(other) ? whole.rho0_ratio : whole.rho0;
          sums.add_gradient(fluid.records,
                            {i, near, fluid.pair(t, other), fluid.masses(p, near, other)}, each, c);
        }
        gradient[3 * i] = fluid.f_unit * sums.x.total();
        gradient[3 * i + 1] = fluid.f_unit * sums.y.total();
        gradient[3 * i + 2] = fluid.f_unit * sums.z.total();
      }
    }
  }

  SPHCLOTH_MULTIVERSION void forces(const Particles &p) const { add_turns<false>(p, {}); }
  SPHCLOTH_MULTIVERSION void virials(const Particles &p, const Listener &listener) const
  {
    add_turns<true>(p, listener);
  }

 private:
  template <bool VIRIAL>
  SPHCLOTH_INLINE void add_turns(const Particles &p, const Listener &listener) const
  {
    Columns c;
    for (int t = 1; t <= fluid.model.n_types; t++)
      for (const int slot : fluid.selection.of(t)) {
        const int i = fluid.lists.at(slot);
        const Acceleration a = turns_on<VIRIAL>(p, slot, t, c);
        if (VIRIAL)
          listener.receive(listener.context, i, a);
        else
          fluid.apply(p, i, fluid.is_fluid(t), a);
      }
  }

  template <bool VIRIAL>
  SPHCLOTH_INLINE Acceleration turns_on(const Particles &p, int slot, int t, Columns &c) const
  {
    SurfaceSums sums;
    const int i = fluid.lists.at(slot);
    const bool is_fluid = fluid.is_fluid(t);
    for (const int other : fluid.lists.present_types()) {
      const NeighborSpan near =
          VIRIAL ? fluid.lists.without_pruning(slot, other) : fluid.lists(slot, other);
      const bool of_fluid = fluid.is_fluid(other);
      if (near.n == 0 || !(is_fluid || of_fluid)) continue;
      const Terms &terms = fluid.pair(t, other);
      const Records &records = fluid.records;
      if (!of_fluid)
        sums.template add_turns<true, true, VIRIAL>(records, {i, near, terms, {}}, c);
      else if (is_fluid)
        sums.template add_turns<false, false, VIRIAL>(
            records, {i, near, terms, fluid.masses(p, near, other)}, c);
      else
        sums.template add_turns<true, false, VIRIAL>(
            records, {i, near, terms, fluid.masses(p, near, other)}, c);
    }
    return sums.total(fluid.f_unit, fluid.records.unit, VIRIAL);
  }
};

}    // namespace sphcloth

#endif
