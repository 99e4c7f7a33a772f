// SPDX-License-Identifier: GPL-2.0-or-later
// Artificial viscosity that switches itself off where a flow shears or turns: of a pair the mean of
// the shares of both partners,
//   floor + (1 - floor) D/(D + C + NOISE c0/h_s),
//   D = |sum_j m_j v_ij . grad W_ij|/rho_i,  C = |sum_j m_j v_ij x grad W_ij|/rho_i
// Balsara, J. Comput. Phys. 121 (1995) 357.

#ifndef SPHCLOTH_CORE_SPH_VISCOSITY_LOOPS_H
#define SPHCLOTH_CORE_SPH_VISCOSITY_LOOPS_H

#include "core/sph/fluid_loops.h"

namespace sphcloth {

template <class K, class P> struct FluidLoops<K, P>::VelocitySums {
  LaneSum<LANES> divergence, x, y, z;

  template <bool FROM_BOUNDARY>
  SPHCLOTH_INLINE void add(const Records &records, const Neighborhood &of, Columns &c)
  {
    const Terms &t = of.terms;
    const typename Records::Motion motion = records.motions[of.i];
    const double *mass = nullptr;
    records.for_neighbors(
        of, c,
        [&](int from) SPHCLOTH_LAMBDA {
          records.load(c, of.near.of + from);
          if (!FROM_BOUNDARY) mass = of.masses.group(from);
        },
        [&](int k, Separation r) SPHCLOTH_LAMBDA {
          const Real du = motion.u - c.u[k], dv = motion.v - c.v[k], dw = motion.w - c.w[k];
          const Real slope = t.f * K::slope_over_q(std::sqrt(r.sq()) * t.inv_support);
          const double mass_or_volume = FROM_BOUNDARY ? static_cast<double>(c.density_or_volume[k])
                                                      : mass[k];
          const double weight = mass_or_volume * (slope * (FROM_BOUNDARY ? t.rho0 : t.rho0_ratio));
          divergence.of[k] += weight * (du * r.x + dv * r.y + dw * r.z);
          x.of[k] += weight * (dv * r.z - dw * r.y);
          y.of[k] += weight * (dw * r.x - du * r.z);
          z.of[k] += weight * (du * r.y - dv * r.x);
        });
  }
};

template <class K, class P>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_viscosity_shares(const Particles &p, double *share)
{
  Columns c;
  for (int t = 1; t <= model.n_types; t++) {
    if (!is_fluid(t)) continue;
    const ViscositySwitch &its = model.viscosity_switch[t];
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      share[i] = 1.0;
      if (its.floor == 1.0) continue;
      VelocitySums sums;
      for (const int other : lists.present_types()) {
        const NeighborSpan near = lists(slot, other);
        if (near.n == 0) continue;
        if (is_fluid(other))
          sums.template add<false>(records, {i, near, pair(t, other), masses(p, near, other)}, c);
        else
          sums.template add<true>(records, {i, near, pair(t, other), {}}, c);
      }
      const double x = sums.x.total(), y = sums.y.total(), z = sums.z.total();
      const double unit = f_unit / p.rho[i];
      const double divergence = unit * std::fabs(sums.divergence.total());
      const double curl = unit * std::sqrt(x * x + y * y + z * z);
      share[i] = its.share(divergence, curl);
    }
  }
}

}    // namespace sphcloth

#endif
