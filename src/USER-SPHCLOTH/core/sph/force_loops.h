// SPDX-License-Identifier: GPL-2.0-or-later
// Momentum (2): forces, impulses and virials.

#ifndef SPHCLOTH_CORE_SPH_FORCE_LOOPS_H
#define SPHCLOTH_CORE_SPH_FORCE_LOOPS_H

#include "core/sph/fluid_loops.h"

namespace sphcloth {

// what the neighbors of one particle add up to, lane by lane

template <class K, class P> template <Outputs OUTPUTS, bool VIRIAL> struct FluidLoops<K, P>::Sums {
  LaneSum<LANES> x, y, z, drho, virial[VIRIAL ? 6 : 0];
  alignas(64) Real approach_sq[LANES] = {};

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

template <class K, class P>
template <Friction F, Outputs OUTPUTS, bool VIRIAL, bool IMPULSE>
SPHCLOTH_INLINE void FluidLoops<K, P>::fluid_on_fluid(const Neighborhood &of, Columns &c,
                                                      Sums<OUTPUTS, VIRIAL> &sums) const
{
  const Terms &t = of.terms;
  const Real rho_i = records.sites[of.i].density_or_volume;
  const typename Records::Motion motion = records.motions[of.i];
  const Real span_i = IMPULSE ? records.spans[of.i] : Real(1);
  const double *mass = nullptr;
  records.for_neighbors(
      of, c,
      [&](int from) SPHCLOTH_LAMBDA {
        records.load(c, of.near.of + from);
        mass = of.masses.group(from);
        if (IMPULSE) records.load_spans(c, of.near.of + from);
      },
      [&](int k, Separation r) SPHCLOTH_LAMBDA {
        const Real du = motion.u - c.u[k], dv = motion.v - c.v[k], dw = motion.w - c.w[k];
        const Real r_sq = r.sq();
        const Real slope = t.f * K::slope_over_q(std::sqrt(r_sq) * t.inv_support);
        const Real v_dot_r = du * r.x + dv * r.y + dw * r.z;
        const Real rho_j = c.density_or_volume[k];

        const bool asleep = IMPULSE && c.span[k] < Real(0);
        const Real mean = IMPULSE ? (asleep ? span_i : Real(0.5) * (span_i + c.span[k])) : Real(1);
        Real along =
            t.stiffness * (motion.p_over_rho2 + (asleep ? span_i : Real(1)) * c.p_over_rho2[k]);
        if (F != Friction::NONE) {
          const Real both = rho_i + rho_j;
          along -=
              mean * Real(2) * t.monaghan * std::min(v_dot_r, Real(0)) / ((r_sq + t.soft) * both);
        }
        const Real push = -slope * along;
        Real fx = push * r.x, fy = push * r.y, fz = push * r.z;
        if (F == Friction::ANY) {
          const Real friction = mean * slope * t.nu * (rho_i + rho_j) / (rho_i * rho_j);
          fx += friction * du;
          fy += friction * dv;
          fz += friction * dw;
        }
        sums.add_approach(k, v_dot_r, r_sq, t.support_sq);
        sums.add(k, mass[k], {fx, fy, fz}, t.rho0_ratio * slope * v_dot_r, r);
      });
}

// One fluid particle f and one boundary particle b: the force between them over m_f V_b.
// The pressure of the boundary particle is 0 unless it was given one.  Without it the term is the
// gradient of the fluid's energy with the density sum that the boundary takes part in.
// ON_BOUNDARY = false: i is fluid, the result is an acceleration.  ON_BOUNDARY = true: i is
// boundary, its neighbors are fluid, the result is a force per volume.

template <class K, class P>
template <Friction F, Outputs OUTPUTS, bool VIRIAL, bool IMPULSE, bool ON_BOUNDARY>
SPHCLOTH_INLINE void FluidLoops<K, P>::across_boundary(const Neighborhood &of, Columns &c,
                                                       Sums<OUTPUTS, VIRIAL> &sums) const
{
  const Terms &t = of.terms;
  const Real rho_i = records.sites[of.i].density_or_volume;
  const typename Records::Motion motion = records.motions[of.i];
  const Real span_i = IMPULSE && !ON_BOUNDARY ? records.spans[of.i] : Real(1);
  const double *mass = nullptr;
  records.for_neighbors(
      of, c,
      [&](int from) SPHCLOTH_LAMBDA {
        records.load(c, of.near.of + from);
        if (ON_BOUNDARY) mass = of.masses.group(from);
        if (IMPULSE && ON_BOUNDARY) records.load_spans(c, of.near.of + from);
      },
      [&](int k, Separation r) SPHCLOTH_LAMBDA {
        const Real du = motion.u - c.u[k], dv = motion.v - c.v[k], dw = motion.w - c.w[k];
        const Real r_sq = r.sq();
        const Real slope = t.rho0 * t.f * K::slope_over_q(std::sqrt(r_sq) * t.inv_support);
        const Real v_dot_r = du * r.x + dv * r.y + dw * r.z;
        const Real rho = ON_BOUNDARY ? c.density_or_volume[k] : rho_i;

        // the time of the fluid, whose pressure comes with it; that of the boundary does not
        const Real span = !IMPULSE ? Real(1)
            : !ON_BOUNDARY         ? span_i
            : c.span[k] < Real(0)  ? Real(1)
                                   : c.span[k];
        Real along = t.stiffness *
            (ON_BOUNDARY ? span * motion.p_over_rho2 + c.p_over_rho2[k]
                         : motion.p_over_rho2 + span * c.p_over_rho2[k]);
        if (F != Friction::NONE)
          along -= span * t.monaghan * std::min(v_dot_r, Real(0)) / ((r_sq + t.soft) * rho);
        const Real push = -slope * along;
        Real fx = push * r.x, fy = push * r.y, fz = push * r.z;
        if (F == Friction::ANY) {
          const Real friction = span * slope * t.nu * Real(2) / rho;
          fx += friction * du;
          fy += friction * dv;
          fz += friction * dw;
        }
        if (!ON_BOUNDARY) sums.add_approach(k, v_dot_r, r_sq, t.support_sq);
        const double mass_or_volume = ON_BOUNDARY ? mass[k]
                                                  : static_cast<double>(c.density_or_volume[k]);
        sums.add(k, mass_or_volume, {fx, fy, fz}, slope * v_dot_r, r);
      });
}

// all forces on one particle

template <class K, class P>
template <Friction F, Outputs OUTPUTS, bool VIRIAL, bool IMPULSE>
SPHCLOTH_INLINE void FluidLoops<K, P>::forces_on(const Particles &p, int slot, int t,
                                                 Listener listener)
{
  Columns c;
  const int i = lists.at(slot);
  const bool fluid = is_fluid(t);
  // a particle without an impulse of its own gets those of others only
  const bool gives = !IMPULSE || (fluid && acts[i]);
  if (!VIRIAL) lists.refresh(slot);
  Sums<OUTPUTS, VIRIAL> sums;
  int n_found = 0;
  for (const int other : lists.present_types()) {
    const NeighborSpan found = VIRIAL ? lists.without_pruning(slot, other)
        : gives                       ? lists(slot, other)
                                      : lists.others(0, slot, other, acts.data());
    if (found.n == 0 || !(fluid || is_fluid(other))) continue;
    n_found += found.n;
    const Terms &terms_of_pair = pair(t, other);
    if (fluid && is_fluid(other))
      fluid_on_fluid<F, OUTPUTS, VIRIAL, IMPULSE>(
          {i, found, terms_of_pair, masses(p, found, other)}, c, sums);
    else if (fluid)
      across_boundary<F, OUTPUTS, VIRIAL, IMPULSE, false>({i, found, terms_of_pair, {}}, c, sums);
    else
      across_boundary<F, OUTPUTS, VIRIAL, IMPULSE, true>(
          {i, found, terms_of_pair, masses(p, found, other)}, c, sums);
  }
  const Acceleration a = sums.total(f_unit, records.unit);
  if (OUTPUTS == Outputs::RATE_AND_APPROACH && fluid) p.approach[i] = a.approach;
  if (!n_found) return;
  if (VIRIAL)
    listener.receive(listener.context, i, a);
  else
    apply(p, i, fluid, a);
}

template <class K, class P>
template <Friction F, Outputs OUTPUTS, bool VIRIAL>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_forces(const Particles &p, Target target,
                                                        Listener listener)
{
  for (int t = 1; t <= model.n_types; t++) {
    if (target == (is_fluid(t) ? Target::BOUNDARIES : Target::FLUID)) continue;
    for (const int slot : selection.of(t))
      forces_on<F, OUTPUTS, VIRIAL, false>(p, slot, t, listener);
  }
}

template <class K, class P>
template <Friction F>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_impulses(const Particles &p,
                                                          const std::vector<int> &slots)
{
  for (const int slot : slots)
    forces_on<F, Outputs::NOTHING, false, true>(p, slot, p.type[lists.at(slot)], {});
}

template <class K, class P>
void FluidLoops<K, P>::impulses(const Particles &p, const std::vector<int> &slots)
{
  switch (model.friction) {
    case Friction::NONE: return all_impulses<Friction::NONE>(p, slots);
    case Friction::ARTIFICIAL: return all_impulses<Friction::ARTIFICIAL>(p, slots);
    case Friction::ANY: return all_impulses<Friction::ANY>(p, slots);
  }
}

template <class K, class P>
void FluidLoops<K, P>::record_impulses(const Particles &p, const double *pressure_time,
                                       const double *span)
{
  records.spans.resize(p.n_all);
  acts.resize(p.n_all);
  for (int i = 0; i < p.n_all; i++) {
    records.motions[i].p_over_rho2 =
        static_cast<Real>(model.pressure_scale[p.type[i]] * pressure_time[i]);
    records.spans[i] = static_cast<Real>(span[i]);
    acts[i] = span[i] != 0.0 || pressure_time[i] != 0.0;
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
  }
}

// Beside the forces and only when asked: what is printed must not change, not even in the last
// bit, what is computed.

template <class K, class P>
void FluidLoops<K, P>::virials(const Particles &p, Receiver receive, void *context)
{
  all_forces<Friction::ANY, Outputs::NOTHING, true>(p, Target::ALL, {receive, context});
}

}    // namespace sphcloth

#endif
