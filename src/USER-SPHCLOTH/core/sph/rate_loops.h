// SPDX-License-Identifier: GPL-2.0-or-later
// Density by continuity: d rho_i/dt = sum_j m_j v_ij . grad W_ij and, between fluid particles of
// one type, diffusion, with <grad rho> of core/sph/gradient.h and r_ji = x_j - x_i,
//   2 delta c0 h_s sum_j m_j/rho_j psi_ij r_ji . grad W_ij / r^2
//   psi_ij = rho_j - rho_i - (<grad rho>_i + <grad rho>_j) . r_ji / 2
// Antuono, Colagrossi, Marrone & Molteni, Comput. Phys. Commun. 181 (2010) 532.

#ifndef SPHCLOTH_CORE_SPH_RATE_LOOPS_H
#define SPHCLOTH_CORE_SPH_RATE_LOOPS_H

#include "core/sph/fluid_loops.h"

namespace sphcloth {

template <class K, class P> struct FluidLoops<K, P>::DifferenceSums {
  LaneSum<LANES> xx, yy, zz, xy, xz, yz, x, y, z;
  Differences total() const
  {
    return {xx.total(), yy.total(), zz.total(), xy.total(), xz.total(),
            yz.total(), x.total(),  y.total(),  z.total()};
  }
};

// Only fluid of its own type takes part: a boundary has no density, and the gradient is exact for
// a linear field on one side, too.

template <class K, class P>
SPHCLOTH_INLINE Differences FluidLoops<K, P>::density_differences(const Neighborhood &of,
                                                                  Columns &c) const
{
  const Terms &t = of.terms;
  const Real rho_i = records.sites[of.i].density_or_volume;
  const double *mass = nullptr;
  DifferenceSums sums;
  records.for_neighbors(
      of, c,
      [&](int from) SPHCLOTH_LAMBDA {
        records.load_sites(c, of.near.of + from);
        mass = of.masses.group(from);
      },
      [&](int k, Separation r) SPHCLOTH_LAMBDA {
        const Real rho_j = c.density_or_volume[k];
        const double weight =
            mass[k] * (t.f * K::slope_over_q(std::sqrt(r.sq()) * t.inv_support) / rho_j);
        const double wx = weight * r.x, wy = weight * r.y, wz = weight * r.z;
        sums.xx.of[k] -= wx * r.x;
        sums.yy.of[k] -= wy * r.y;
        sums.zz.of[k] -= wz * r.z;
        sums.xy.of[k] -= wx * r.y;
        sums.xz.of[k] -= wx * r.z;
        sums.yz.of[k] -= wy * r.z;
        const Real more = rho_j - rho_i;
        sums.x.of[k] += wx * more;
        sums.y.of[k] += wy * more;
        sums.z.of[k] += wz * more;
      });
  return sums.total();
}

template <class K, class P>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_density_gradients(const Particles &p,
                                                                   double *gradient)
{
  Columns c;
  for (int t = 1; t <= model.n_types; t++) {
    if (!is_fluid(t)) continue;
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      const NeighborSpan found = lists(slot, t);
      const std::array<double, 3> of_i =
          density_differences({i, found, pair(t, t), masses(p, found, t)}, c)
              .gradient(model.dimension);
      for (int d = 0; d < 3; d++) gradient[3 * i + d] = of_i[d] / records.unit;
    }
  }
}

template <class K, class P>
template <bool FROM_BOUNDARY, bool DIFFUSION>
SPHCLOTH_INLINE double FluidLoops<K, P>::density_rate(const Neighborhood &of, double back,
                                                      Columns &c) const
{
  const Terms &t = of.terms;
  const Real rho_i = records.sites[of.i].density_or_volume;
  const typename Records::Motion motion = records.motions[of.i];
  const Real ago = static_cast<Real>(back / records.unit);
  using Gradient = typename Records::Gradient;
  const Gradient gradient = DIFFUSION ? records.gradients[of.i] : Gradient();
  alignas(64) Real gx[LANES], gy[LANES], gz[LANES];
  const double *mass = nullptr;
  LaneSum<LANES> rate;
  records.for_neighbors(
      of, c,
      [&](int from) SPHCLOTH_LAMBDA {
        const int *near = of.near.of + from;
        records.load(c, near);
        if (DIFFUSION)
          columns(&records.gradients[0].x, near, gx, gy, gz, static_cast<Real *>(nullptr));
        if (!FROM_BOUNDARY) mass = of.masses.group(from);
      },
      [&](int k, Separation r) SPHCLOTH_LAMBDA {
        const Real du = motion.u - c.u[k], dv = motion.v - c.v[k], dw = motion.w - c.w[k];
        const Real ax = r.x - ago * du, ay = r.y - ago * dv, az = r.z - ago * dw;
        const Real density_or_volume = c.density_or_volume[k];
        // those outside the support now take no part: some of them are listed, others are not
        const Real q_now_sq = r.sq() * t.inv_support * t.inv_support;
        const Real q = std::sqrt(ax * ax + ay * ay + az * az) * t.inv_support;
        const Real slope = t.f * K::slope_over_q(q_now_sq < Real(1) ? q : Real(1));
        const Real v_dot_r = du * ax + dv * ay + dw * az;
        const double mass_or_volume = FROM_BOUNDARY ? static_cast<double>(density_or_volume)
                                                    : mass[k];
        Real flow = (FROM_BOUNDARY ? t.rho0 : t.rho0_ratio) * v_dot_r;
        if (DIFFUSION) {
          const Real linear =
              (gradient.x + gx[k]) * r.x + (gradient.y + gy[k]) * r.y + (gradient.z + gz[k]) * r.z;
          flow +=
              t.diffusion * (rho_i - density_or_volume - Real(0.5) * linear) / density_or_volume;
        }
        rate.of[k] += mass_or_volume * (slope * flow);
      });
  return f_unit * rate.total();
}

template <class K, class P>
void FluidLoops<K, P>::density_rates(const Particles &p, const double *gradient, double back,
                                     double *rate)
{
  if (!gradient) return all_density_rates<false>(p, back, rate);
  records.record_gradients(gradient, nullptr, 1.0, p.n_all, touched());
  all_density_rates<true>(p, back, rate);
}

template <class K, class P>
template <bool DIFFUSION>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_density_rates(const Particles &p, double back,
                                                               double *rate)
{
  Columns c;
  for (int t = 1; t <= model.n_types; t++) {
    if (!is_fluid(t)) continue;
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      double sum = 0.0;
      for (const int other : lists.present_types()) {
        const NeighborSpan found = lists(slot, other);
        if (found.n == 0) continue;
        const Terms &of_pair = pair(t, other);
        if (!is_fluid(other)) {
          sum += density_rate<true, false>({i, found, of_pair, {}}, back, c);
          continue;
        }
        const Neighborhood of{i, found, of_pair, masses(p, found, other)};
        sum += DIFFUSION && other == t ? density_rate<false, true>(of, back, c)
                                       : density_rate<false, false>(of, back, c);
      }
      rate[i] = sum;
    }
  }
}

// Each pair exchanges, in double precision, one volume.  It does so once: where both partners are
// active each takes its own part.

template <class K, class P>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::diffuse_all(const Particles &p,
                                                         const Diffusion &diffusion)
{
  Columns c;
  alignas(64) Real gx[LANES], gy[LANES], gz[LANES], since[LANES];
  alignas(64) double to[LANES];
  for (int t = 1; t <= model.n_types; t++) {
    if (!is_fluid(t)) continue;
    const Terms &terms_of_pair = pair(t, t);
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      const NeighborSpan near = lists(slot, t);
      const Neighborhood of{i, near, terms_of_pair, masses(p, near, t)};
      const Real rho_i = records.sites[i].density_or_volume;
      const typename Records::Gradient gradient = records.gradients[i];
      const double *mass = nullptr;
      LaneSum<LANES> change;
      records.for_neighbors(
          of, c,
          [&](int from) SPHCLOTH_LAMBDA {
            records.load_sites(c, near.of + from);
            columns(&records.gradients[0].x, near.of + from, gx, gy, gz, since);
            mass = of.masses.group(from);
          },
          [&](int k, Separation r) SPHCLOTH_LAMBDA {
            const Real elapsed = std::min(gradient.since, std::fabs(since[k]));
            const Real rho_j = c.density_or_volume[k];
            const Real slope = elapsed * terms_of_pair.f *
                K::slope_over_q(std::sqrt(r.sq()) * terms_of_pair.inv_support);
            const Real linear = (gradient.x + gx[k]) * r.x + (gradient.y + gy[k]) * r.y +
                (gradient.z + gz[k]) * r.z;
            const Real less =
                terms_of_pair.diffusion * slope * (rho_i - rho_j - Real(0.5) * linear);
            change.of[k] += mass[k] * (less / rho_j);
            to[k] = since[k] < Real(0) ? less / rho_i : Real(0);
          },
          [&](int from) SPHCLOTH_LAMBDA {
            const double scale = f_unit * p.mass_or_volume[i];
            for (int m = 0; m < LANES; m++) diffusion.change[near.of[from + m]] -= scale * to[m];
          });
      diffusion.change[i] += f_unit * change.total();
    }
  }
}

}    // namespace sphcloth

#endif
