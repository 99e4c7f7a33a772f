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

template <class K, class P>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_sum_gradients(const Particles &p, double *gradient)
{
  Columns c;
  for (int t = 1; t <= model.n_types; t++) {
    if (!is_fluid(t)) continue;
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      SurfaceSums sums;
      for (const int other : lists.present_types()) {
        const NeighborSpan near = lists(slot, other);
        if (near.n == 0) continue;
        const PairTerms &whole = model.pair(t, other);
        const double each = is_fluid(other) ? whole.rho0_ratio : whole.rho0;
        sums.add_gradient(records, {i, near, pair(t, other), masses(p, near, other)}, each, c);
      }
      gradient[3 * i] = f_unit * sums.x.total();
      gradient[3 * i + 1] = f_unit * sums.y.total();
      gradient[3 * i + 2] = f_unit * sums.z.total();
    }
  }
}

template <class K, class P>
template <bool VIRIAL>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_turns(const Particles &p, Listener listener)
{
  Columns c;
  for (int t = 1; t <= model.n_types; t++) {
    const bool fluid = is_fluid(t);
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      SurfaceSums sums;
      for (const int other : lists.present_types()) {
        const NeighborSpan near =
            VIRIAL ? lists.without_pruning(slot, other) : lists(slot, other);
        if (near.n == 0 || !(fluid || is_fluid(other))) continue;
        if (fluid && is_fluid(other))
          sums.template add_turns<false, false, VIRIAL>(
              records, {i, near, pair(t, other), masses(p, near, other)}, c);
        else if (fluid)
          sums.template add_turns<true, true, VIRIAL>(records, {i, near, pair(t, other), {}}, c);
        else
          sums.template add_turns<true, false, VIRIAL>(
              records, {i, near, pair(t, other), masses(p, near, other)}, c);
      }
      const Acceleration a = sums.total(f_unit, records.unit, VIRIAL);
      if (VIRIAL)
        listener.receive(listener.context, i, a);
      else
        apply(p, i, fluid, a);
    }
  }
}

template <class K, class P>
void FluidLoops<K, P>::record_turns(const Particles &p, const double *turn)
{
  records.record_gradients(turn, nullptr, 1.0 / (records.unit * records.unit), p.n_all, touched());
}

template <class K, class P> void FluidLoops<K, P>::turn_forces(const Particles &p)
{
  all_turns<false>(p, {});
}

template <class K, class P>
void FluidLoops<K, P>::turn_virials(const Particles &p, Receiver receive, void *context)
{
  all_turns<true>(p, {receive, context});
}

}    // namespace sphcloth

#endif
