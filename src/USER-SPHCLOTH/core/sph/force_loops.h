// SPDX-License-Identifier: GPL-2.0-or-later
// Momentum (2): forces, impulses and virials.

#ifndef SPHCLOTH_CORE_SPH_FORCE_LOOPS_H
#define SPHCLOTH_CORE_SPH_FORCE_LOOPS_H

#include "core/sph/fluid_loops.h"

namespace sphcloth {

// What the neighbors of one particle add up to, lane by lane; what it gives to those of the last
// group, and of all to itself

template <class K, class P>
template <Outputs OUTPUTS, bool VIRIAL, bool SOURCE>
struct FluidLoops<K, P>::Sums {
  LaneSum<LANES> x, y, z, drho, virial[VIRIAL ? 6 : 0];
  LaneSum<LANES> to_self[SOURCE ? 3 : 0];
  alignas(64) Real approach_sq[LANES] = {};
  alignas(64) double to[SOURCE ? 3 : 0][LANES];

  // One pair, in lane m: its force and rate per mass or volume of the neighbor
  SPHCLOTH_INLINE void add(int m, double mass_or_volume, const std::array<Real, 3> &f, Real rate,
                           const Separation &r)
  {
    const double fx = mass_or_volume * f[0], fy = mass_or_volume * f[1], fz = mass_or_volume * f[2];
    x.of[m] += fx;
    y.of[m] += fy;
    z.of[m] += fz;
    if (OUTPUTS != Outputs::NOTHING) drho.of[m] += mass_or_volume * rate;
    if (VIRIAL) {
      virial[0].of[m] += r.x * fx;
      virial[1].of[m] += r.y * fy;
      virial[2].of[m] += r.z * fz;
      virial[3].of[m] += r.x * fy;
      virial[4].of[m] += r.x * fz;
      virial[5].of[m] += r.y * fz;
    }
  }

  // Of one pair, in lane m, the part that the particle gives; a sleeping neighbor gets nothing
  SPHCLOTH_INLINE void give(int m, double mass_or_volume, double awake,
                            const std::array<Real, 3> &f)
  {
    for (int d = 0; d < 3; d++) {
      const double part = mass_or_volume * f[d];
      to_self[d].of[m] += part;
      to[d][m] = awake * part;
    }
  }

  // to the neighbors of a group, which are different particles; what fills one up gets 0
  SPHCLOTH_INLINE void hand_over(const int *near, const Gift &gift) const
  {
    if (!SOURCE) return;
    constexpr int N_ROWS = 4;
    for (int m = 0; m < LANES; m += N_ROWS) {
      Row rows[N_ROWS];
      to_rows(to[0] + m, to[1] + m, to[2] + m, rows);
      for (int k = 0; k < N_ROWS; k++)
        *reinterpret_cast<Row *>(gift.to(near[m + k])) -= gift.scale * rows[k];
    }
  }

  // The square of the maximum approach speed of a neighbor inside the support
  SPHCLOTH_INLINE void add_approach(int m, Real v_dot_r, Real r_sq, Real support_sq)
  {
    if (OUTPUTS != Outputs::RATE_AND_APPROACH) return;
    const Real closing = std::min(v_dot_r, Real(0));
    const Real speed_sq = closing * closing / std::max(r_sq, std::numeric_limits<Real>::min());
    approach_sq[m] = std::max(approach_sq[m], r_sq < support_sq ? speed_sq : Real(0));
  }

  Acceleration total(double f_unit, double unit) const
  {
    Acceleration a{f_unit * x.total(), f_unit * y.total(), f_unit * z.total(),
                   f_unit * drho.total(), 0.0, {}};
    if (OUTPUTS == Outputs::RATE_AND_APPROACH)
      a.approach = std::sqrt(*std::max_element(approach_sq, approach_sq + LANES));
    if (VIRIAL)
      for (int m = 0; m < 6; m++) a.virial[m] = 0.5 * f_unit * unit * virial[m].total();
    return a;
  }
};

// Laminar viscosity: Morris, Fox & Zhu, J. Comput. Phys. 136 (1997) 214.
// Artificial viscosity: Monaghan, Annu. Rev. Astron. Astrophys. 30 (1992) 543; it adds to the
// pressure terms, p_i/rho_i^2 + p_j/rho_j^2, along the line of the particles.
//
// SOURCE: of these terms the particle gives the one of its own pressure, and half of the friction,
// each times the time for which it acts.  Where artificial viscosity is switched, that half has the
// particle's own share, so that both together have the mean of the two.

template <class K, class P>
template <Friction F, Outputs OUTPUTS, bool VIRIAL, bool SOURCE, bool SLEEPING>
SPHCLOTH_INLINE void FluidLoops<K, P>::fluid_on_fluid(const Neighborhood &of, Columns &c,
                                                      Sums<OUTPUTS, VIRIAL, SOURCE> &sums,
                                                      const Gift &gift) const
{
  const Terms &t = of.terms;
  const Real rho_i = records.sites[of.i].density_or_volume;
  const typename Records::Motion motion = records.motions[of.i];
  const Real share = F == Friction::SWITCHED ? records.shares[of.i] : Real(1);
  const Real half_span = Real(0.5) * gift.span, pressure = t.stiffness * gift.pressure;
  const double *mass = nullptr;
  records.for_neighbors(
      of, c,
      [&](int from) SPHCLOTH_LAMBDA {
        records.load(c, of.near.of + from);
        mass = of.masses.group(from);
        if (SLEEPING) records.load_sleeping(c, gift.sleeping, of.near.of + from);
        if (F == Friction::SWITCHED && !SOURCE) records.load_shares(c, of.near.of + from);
      },
      [&](int k, Separation r) SPHCLOTH_LAMBDA {
        const Real du = motion.u - c.u[k], dv = motion.v - c.v[k], dw = motion.w - c.w[k];
        const Real r_sq = r.sq();
        const Real slope = t.f * K::slope_over_q(std::sqrt(r_sq) * t.inv_support);
        const Real v_dot_r = du * r.x + dv * r.y + dw * r.z;
        const Real rho_j = c.density_or_volume[k];

        Real along = t.stiffness * (motion.p_over_rho2 + c.p_over_rho2[k]), damping = 0;
        if (F != Friction::NONE) {
          const Real both = rho_i + rho_j;
          damping = t.monaghan * Real(2) * std::min(v_dot_r, Real(0)) / ((r_sq + t.soft) * both);
          if (F == Friction::SWITCHED)
            damping *= SOURCE ? share : Real(0.5) * (share + c.share[k]);
          along -= damping;
        }
        const Real push = -slope * along;
        const Real friction =
            F >= Friction::ANY ? slope * t.nu * (rho_i + rho_j) / (rho_i * rho_j) : Real(0);
        sums.add_approach(k, v_dot_r, r_sq, t.support_sq);
        sums.add(k, mass[k], along_and_drag<F>(push, r, friction, {du, dv, dw}),
                 t.rho0_ratio * slope * v_dot_r, r);
        if (SOURCE) {
          const Real asleep = SLEEPING ? c.asleep[k] : Real(0);
          const Real span = SLEEPING ? half_span + asleep * half_span : half_span;
          const Real of_sleeper =
              SLEEPING ? asleep * t.stiffness * gift.span * c.p_over_rho2[k] : Real(0);
          sums.give(k, mass[k], 1.0 - asleep,
                    along_and_drag<F>(-slope * (pressure + of_sleeper - span * damping), r,
                                  span * friction, {du, dv, dw}));
        }
      },
      [&](int from) SPHCLOTH_LAMBDA { sums.hand_over(of.near.of + from, gift); });
}

// One fluid particle f and one boundary particle b: the force between them over m_f V_b.
// The pressure of the boundary particle is 0 unless it was given one.  Without it the term is the
// gradient of the fluid's energy with the density sum that the boundary takes part in.
// ON_BOUNDARY = false: i is fluid, the result is an acceleration, and i gives all of it.
// ON_BOUNDARY = true: i is boundary, its neighbors are fluid, the result is a force per volume.

template <class K, class P>
template <Friction F, Outputs OUTPUTS, bool VIRIAL, bool SOURCE, bool ON_BOUNDARY>
SPHCLOTH_INLINE void FluidLoops<K, P>::across_boundary(const Neighborhood &of, Columns &c,
                                                       Sums<OUTPUTS, VIRIAL, SOURCE> &sums,
                                                       const Gift &gift) const
{
  const Terms &t = of.terms;
  const Real rho_i = records.sites[of.i].density_or_volume;
  const typename Records::Motion motion = records.motions[of.i];
  const Real share = F == Friction::SWITCHED && !ON_BOUNDARY ? records.shares[of.i] : Real(1);
  const double *mass = nullptr;
  records.for_neighbors(
      of, c,
      [&](int from) SPHCLOTH_LAMBDA {
        records.load(c, of.near.of + from);
        if (ON_BOUNDARY) mass = of.masses.group(from);
        if (F == Friction::SWITCHED && ON_BOUNDARY) records.load_shares(c, of.near.of + from);
      },
      [&](int k, Separation r) SPHCLOTH_LAMBDA {
        const Real du = motion.u - c.u[k], dv = motion.v - c.v[k], dw = motion.w - c.w[k];
        const Real r_sq = r.sq();
        const Real slope = t.rho0 * t.f * K::slope_over_q(std::sqrt(r_sq) * t.inv_support);
        const Real v_dot_r = du * r.x + dv * r.y + dw * r.z;
        const Real rho = ON_BOUNDARY ? c.density_or_volume[k] : rho_i;

        Real along = t.stiffness * (motion.p_over_rho2 + c.p_over_rho2[k]), damping = 0;
        if (F != Friction::NONE) {
          damping = t.monaghan * std::min(v_dot_r, Real(0)) / ((r_sq + t.soft) * rho);
          if (F == Friction::SWITCHED) damping *= ON_BOUNDARY ? c.share[k] : share;
          along -= damping;
        }
        const Real push = -slope * along;
        const Real friction = F >= Friction::ANY ? slope * t.nu * Real(2) / rho : Real(0);
        if (!ON_BOUNDARY) sums.add_approach(k, v_dot_r, r_sq, t.support_sq);
        const double mass_or_volume = ON_BOUNDARY ? mass[k]
                                                  : static_cast<double>(c.density_or_volume[k]);
        sums.add(k, mass_or_volume, along_and_drag<F>(push, r, friction, {du, dv, dw}),
                 slope * v_dot_r, r);
        if (SOURCE) {
          const Real pressure = t.stiffness * (gift.pressure + gift.span * c.p_over_rho2[k]);
          sums.give(k, mass_or_volume, 1.0,
                    along_and_drag<F>(-slope * (pressure - gift.span * damping), r,
                                  gift.span * friction, {du, dv, dw}));
        }
      },
      [&](int from) SPHCLOTH_LAMBDA { sums.hand_over(of.near.of + from, gift); });
}

// all forces on one particle

template <class K, class P>
template <Friction F, Outputs OUTPUTS, bool VIRIAL, bool SOURCE>
SPHCLOTH_INLINE Acceleration FluidLoops<K, P>::forces_on(const Particles &p, int slot, int t,
                                                         const Gift &gift)
{
  Columns c;
  const int i = lists.at(slot);
  const bool fluid = is_fluid(t);
  if (!VIRIAL) lists.refresh(slot);
  Sums<OUTPUTS, VIRIAL, SOURCE> sums;
  for (const int other : lists.present_types()) {
    const NeighborSpan found =
        VIRIAL ? lists.without_pruning(slot, other) : lists(slot, other);
    if (found.n == 0 || !(fluid || is_fluid(other))) continue;
    const Terms &terms_of_pair = pair(t, other);
    if (SOURCE && gift.sleeping && is_fluid(other))
      fluid_on_fluid<F, OUTPUTS, VIRIAL, SOURCE, SOURCE>(
          {i, found, terms_of_pair, masses(p, found, other)}, c, sums, gift);
    else if (fluid && is_fluid(other))
      fluid_on_fluid<F, OUTPUTS, VIRIAL, SOURCE, false>(
          {i, found, terms_of_pair, masses(p, found, other)}, c, sums, gift);
    else if (fluid)
      across_boundary<F, OUTPUTS, VIRIAL, SOURCE, false>({i, found, terms_of_pair, {}}, c, sums,
                                                         gift);
    else if (!SOURCE)
      across_boundary<F, OUTPUTS, VIRIAL, SOURCE, true>(
          {i, found, terms_of_pair, masses(p, found, other)}, c, sums, gift);
  }
  if (SOURCE)
    for (int d = 0; d < 3; d++) gift.to(i)[d] += gift.scale * sums.to_self[d].total();
  return sums.total(f_unit, records.unit);
}

template <class K, class P>
template <Friction F, Outputs OUTPUTS, bool VIRIAL>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_forces(const Particles &p, Target target,
                                                        Listener listener)
{
  for (int t = 1; t <= model.n_types; t++) {
    const bool fluid = is_fluid(t);
    if (target == (fluid ? Target::BOUNDARIES : Target::FLUID)) continue;
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      const Acceleration a = forces_on<F, OUTPUTS, VIRIAL, false>(p, slot, t, {});
      if (VIRIAL)
        listener.receive(listener.context, i, a);
      else
        apply(p, i, fluid, a);
      if (OUTPUTS == Outputs::RATE_AND_APPROACH && fluid) p.approach[i] = a.approach;
    }
  }
}

template <class K, class P>
template <Friction F, Outputs OUTPUTS>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_impulses(const Particles &p,
                                                          const Impulses &impulses)
{
  for (const int i : *impulses.of) {
    const int t = p.type[i];
    const Acceleration a =
        forces_on<F, OUTPUTS, false, true>(p, lists.slot(i), t, gift_of(p, i, t, impulses));
    if (!impulses.with_forces) continue;
    apply(p, i, true, a);
    if (OUTPUTS == Outputs::RATE_AND_APPROACH) p.approach[i] = a.approach;
  }
}

template <class K, class P>
void FluidLoops<K, P>::impulses(const Particles &p, const Impulses &of)
{
  if (model.outputs == Outputs::RATE_AND_APPROACH)
    impulses_and<Outputs::RATE_AND_APPROACH>(p, of);
  else
    impulses_and<Outputs::RATE>(p, of);
}

template <class K, class P>
template <Outputs OUTPUTS>
void FluidLoops<K, P>::impulses_and(const Particles &p, const Impulses &of)
{
  switch (model.friction) {
    case Friction::NONE: return all_impulses<Friction::NONE, OUTPUTS>(p, of);
    case Friction::ARTIFICIAL: return all_impulses<Friction::ARTIFICIAL, OUTPUTS>(p, of);
    case Friction::ANY: return all_impulses<Friction::ANY, OUTPUTS>(p, of);
    case Friction::SWITCHED: return all_impulses<Friction::SWITCHED, OUTPUTS>(p, of);
  }
}

template <class K, class P>
SPHCLOTH_INLINE void FluidLoops<K, P>::apply(const Particles &p, int i, bool fluid,
                                             const Acceleration &a) const
{
  // the volume that the fluid has seen, to the last bit
  const double mass_or_volume = fluid ? p.mass_or_volume[i]
                                      : static_cast<double>(records.sites[i].density_or_volume);
  const double scale = mass_or_volume * p.force_unit;
  p.f[3 * i] += scale * a.x;
  p.f[3 * i + 1] += scale * a.y;
  p.f[3 * i + 2] += scale * a.z;
  if (fluid) p.drho[i] += a.drho;
}

template <class K, class P> void FluidLoops<K, P>::forces(const Particles &p, Target target)
{
  switch (model.outputs) {
    case Outputs::NOTHING: return forces_and<Outputs::NOTHING>(p, target);
    case Outputs::RATE: return forces_and<Outputs::RATE>(p, target);
    case Outputs::RATE_AND_APPROACH: return forces_and<Outputs::RATE_AND_APPROACH>(p, target);
  }
}

template <class K, class P>
template <Outputs OUTPUTS>
void FluidLoops<K, P>::forces_and(const Particles &p, Target target)
{
  switch (model.friction) {
    case Friction::NONE: return all_forces<Friction::NONE, OUTPUTS, false>(p, target, {});
    case Friction::ARTIFICIAL:
      return all_forces<Friction::ARTIFICIAL, OUTPUTS, false>(p, target, {});
    case Friction::ANY: return all_forces<Friction::ANY, OUTPUTS, false>(p, target, {});
    case Friction::SWITCHED:
      return all_forces<Friction::SWITCHED, OUTPUTS, false>(p, target, {});
  }
}

// Beside the forces and only when asked: what is printed must not change, not even in the last
// bit, what is computed.

template <class K, class P>
void FluidLoops<K, P>::virials(const Particles &p, Receiver receive, void *context)
{
  const Listener listener{receive, context};
  if (model.friction == Friction::SWITCHED)
    all_forces<Friction::SWITCHED, Outputs::NOTHING, true>(p, Target::ALL, listener);
  else
    all_forces<Friction::ANY, Outputs::NOTHING, true>(p, Target::ALL, listener);
}

}    // namespace sphcloth

#endif
