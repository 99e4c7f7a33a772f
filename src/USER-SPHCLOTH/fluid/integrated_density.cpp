// SPDX-License-Identifier: GPL-2.0-or-later
// Density by continuity.

#include "fluid/integrated_density.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "fluid/sph_materials.h"
#include "lammps_util/rank_error.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

// Inactive particles keep their gradient.

void IntegratedDensity::begin_lists(StepHooks *hooks)
{
  if (!materials.diffuses()) return;
  gradient.assign(3 * static_cast<std::size_t>(atom->nmax), 0.0);
  if (!hooks) return;
  kept = hooks->kept_density();
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) gradient[3 * i + d] = kept.gradient[d][i];
}

void IntegratedDensity::integrate(Fluid &core, const Particles &p,
                                  const std::vector<FluidBoundary *> &boundaries, StepHooks *hooks,
                                  bool new_lists)
{
  check(p);
  core.record(p);
  rate.resize(atom->nmax);
  if (hooks)
    follow_sums(core, p, boundaries, *hooks, new_lists);
  else
    follow_rates(core, p, boundaries);
  const int every = materials.options.reinit;
  if (elapsed > 0.0 && every && update->ntimestep % every == 0) {
    ghosts.send_to_ghosts(GhostData::DENSITY);
    core.smooth_densities(p, rate.data());
    core.for_active_fluid([&](int i, int) { p.rho[i] = rate[i]; });
  }
  elapsed = 0.0;
}

// The velocities are those with which the particles came here, so the rate is that at the middle of
// the displacement.  At its end it would be wrong by the divergence that the forces have made
// since, which is a diffusion of -dt c0^2 / 2.

void IntegratedDensity::follow_rates(Fluid &core, const Particles &p,
                                     const std::vector<FluidBoundary *> &boundaries)
{
  core.gather(p, false);
  if (!(elapsed > 0.0)) return;
  const double dt = elapsed, back = 0.5 * dt;
  const bool diffuses = materials.diffuses();
  if (diffuses) find_gradients(core, p);
  core.density_rates(p, diffuses ? gradient.data() : nullptr, back, rate.data());
  for (FluidBoundary *boundary : boundaries)
    core.for_active_fluid([&](int i, int) { rate[i] = boundary->density_rate(i, rate[i], back); });
  core.for_active_fluid([&](int i, int) { p.rho[i] += dt * rate[i]; });
}

// Within a step of its own a particle, and each of its neighbors, has many velocities.  The rate is
// the derivative of the sum (1), so the change of that sum is its exact integral.

void IntegratedDensity::follow_sums(Fluid &core, const Particles &p,
                                    const std::vector<FluidBoundary *> &boundaries,
                                    StepHooks &hooks, bool new_lists)
{
  kept = hooks.kept_density();
  find_sums(core, p, boundaries);
  std::fill(kept.change + p.n_owned, kept.change + p.n_all, 0.0);
  if (new_lists) leave_out_entered(core, p);
  const bool diffuses = materials.diffuses() && elapsed > 0.0;
  if (diffuses) diffuse(core, p, hooks);
  if (diffuses || new_lists) ghosts.add_from_ghosts(GhostData::CHANGE);
  core.for_active_fluid([&](int i, int) {
    if (kept.sum[i] > 0.0 && elapsed > 0.0) p.rho[i] += sum[i] - kept.sum[i] + kept.change[i];
    kept.sum[i] = sum[i];
    kept.change[i] = 0.0;
  });
}

void IntegratedDensity::find_sums(Fluid &core, Particles p,
                                  const std::vector<FluidBoundary *> &boundaries)
{
  sum.resize(atom->nmax);
  p.rho = sum.data();
  core.gather(p, true);
  for (FluidBoundary *boundary : boundaries)
    core.for_active_fluid([&](int i, int) { sum[i] = boundary->density(i, sum[i]); });
}

// What a new particle adds to the sums of its neighbors is no motion.

void IntegratedDensity::leave_out_entered(Fluid &core, const Particles &p)
{
  with_kernel(materials.options.kernel, [&](auto kernel) {
    core.for_active_fluid([&](int i, int type_i) {
      if (kept.sum[i] != KeptDensity::NONE) return;
      for (const int t : core.order().present_types()) {
        if (!materials.is_fluid(t)) continue;
        const NeighborSpan near = core.neighbors(i, t);
        const PairTerms &terms = core.model.pair(t, type_i);
        const double each = terms.rho0_ratio * p.mass_or_volume[i];
        for (int k = 0; k < near.n; k++)
          kept.change[near.of[k]] -=
              each * weight<decltype(kernel)>(p, i, near.of[k], terms.kernel);
      }
    });
  });
}

void IntegratedDensity::diffuse(Fluid &core, const Particles &p, const StepHooks &hooks)
{
  since.resize(atom->nmax);
  hooks.find_times_since_update(since.data());
  ghosts.send_to_ghosts(GhostData::SINCE);
  find_gradients(core, p);
  core.for_active_fluid([&](int i, int) {
    for (int d = 0; d < 3; d++) kept.gradient[d][i] = gradient[3 * i + d];
  });
  core.diffuse(p, {gradient.data(), since.data(), kept.change});
}

void IntegratedDensity::find_gradients(Fluid &core, const Particles &p)
{
  core.density_gradients(p, gradient.data());
  ghosts.send_to_ghosts(GhostData::GRADIENT);
}

void IntegratedDensity::check(const Particles &p) const
{
  for (int i = 0; i < p.n_owned; i++)
    if (materials.is_fluid(p.type[i]) && !(p.rho[i] > 0.0))
      rank_error(lmp, FLERR,
                 "{}: particle {} has density {}: give every fluid particle one, 'set group all "
                 "sph/rho RHO0', or use 'density summation'",
                 "pair_style sph/tait", atom->tag[i], p.rho[i]);
}

/* ----------------------------------------------------------------------
   ghosts
------------------------------------------------------------------------- */

double *IntegratedDensity::pack(GhostData what, int i, double *buf) const
{
  if (what == GhostData::GRADIENT) return std::copy_n(&gradient[3 * i], 3, buf);
  *buf = what == GhostData::SINCE ? since[i] : kept.change[i];
  return buf + 1;
}

const double *IntegratedDensity::unpack(GhostData what, int i, const double *buf)
{
  if (what == GhostData::SINCE) {
    since[i] = *buf;
    return buf + 1;
  }
  std::copy_n(buf, 3, &gradient[3 * i]);
  return buf + 3;
}

double IntegratedDensity::bytes() const { return bytes_of(rate, gradient, sum, since); }
