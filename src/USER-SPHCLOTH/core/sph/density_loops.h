// SPDX-License-Identifier: GPL-2.0-or-later
// Density (1), and what else is summed with the kernel itself: volumes of boundary particles,
// smoothed densities, pressures of boundary particles.

#ifndef SPHCLOTH_CORE_SPH_DENSITY_LOOPS_H
#define SPHCLOTH_CORE_SPH_DENSITY_LOOPS_H

#include "core/sph/fluid_loops.h"

namespace sphcloth {

// sum of the kernel's shape over neighbors, of their masses times it if WEIGHTED

template <class K, class P>
template <bool WEIGHTED>
SPHCLOTH_INLINE double FluidLoops<K, P>::shape_sum(const Neighborhood &of, Columns &c) const
{
  const Terms &t = of.terms;
  const double *mass = nullptr;
  LaneSum<LANES> sum;
  records.for_neighbors(
      of, c,
      [&](int from) SPHCLOTH_LAMBDA {
        records.load_positions(c, of.near.of + from);
        if (WEIGHTED) mass = of.masses.group(from);
      },
      [&](int k, Separation r) SPHCLOTH_LAMBDA {
        const Real w = K::shape(std::sqrt(r.sq()) * t.inv_support);
        sum.of[k] += WEIGHTED ? mass[k] * w : w;
      });
  return sum.total();
}

// Not a template of the caller's question but one function: `sum` is tested once per particle.

template <class K, class P>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::sum_densities(const Particles &p, bool sum)
{
  Columns c;
  for (int t = 1; t <= model.n_types; t++) {
    const bool fluid = is_fluid(t);
    const double at_self = model.pair(t, t).kernel.w * K::shape(0.0);
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      lists.refresh(slot);
      if (!sum || !fluid) continue;
      double rho = p.mass_or_volume[i] * at_self;
      for (const int other : lists.present_types()) {
        const NeighborSpan near = lists(slot, other);
        if (near.n == 0) continue;
        const PairTerms &whole = model.pair(t, other);
        const double equal = model.mass[other];
        const double each = is_fluid(other) ? whole.rho0_ratio : whole.rho0;
        const Neighborhood of{i, near, pair(t, other), masses(p, near, other)};
        rho += whole.kernel.w * each *
            (equal > 0.0 ? equal * shape_sum<false>(of, c) : shape_sum<true>(of, c));
      }
      p.rho[i] = rho;
    }
  }
}

template <class K, class P> void FluidLoops<K, P>::gather(const Particles &p, bool sum)
{
  begin_evaluation();
  sum_densities(p, sum);
}

// The share of space of a particle of a wall or a sheet

template <class K, class P>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::sum_volumes(int type, double *volume)
{
  const PairTerms &whole = model.pair(type, type);
  const Terms among_each_other = in_loops(whole);
  Columns c;
  for (int slot = lists.begin(type); slot < lists.begin(type + 1); slot++) {
    const int i = lists.at(slot);
    lists.refresh(slot);
    const double sum = shape_sum<false>({i, lists(slot, type), among_each_other, {}}, c);
    volume[i] = 1.0 / (whole.kernel.w * (K::shape(0.0) + sum));
  }
}

// Shepard interpolation: constant densities stay, also at a free surface.  Boundary particles take
// part with the rest density.

template <class K, class P>
void FluidLoops<K, P>::smooth_densities(const Particles &p, double *smooth)
{
  for (int t = 1; t <= model.n_types; t++) {
    if (!is_fluid(t)) continue;
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      const double at_self = model.pair(t, t).kernel.w * K::shape(0.0);
      double mass = p.mass_or_volume[i] * at_self, volume = mass / p.rho[i];
      for (const int other : lists.present_types()) {
        const NeighborSpan found = lists(slot, other);
        const PairTerms &of_pair = model.pair(t, other);
        for (int k = 0; k < found.n; k++) {
          const int j = found.of[k];
          const double w = p.mass_or_volume[j] * weight<K>(p, i, j, of_pair.kernel);
          mass += (is_fluid(other) ? of_pair.rho0_ratio : of_pair.rho0) * w;
          volume += is_fluid(other) ? w / p.rho[j] : w;
        }
      }
      smooth[i] = mass / volume;
    }
  }
}

// Adami, Hu & Adams, J. Comput. Phys. 231 (2012) 7057, without the weight of the fluid between.

template <class K, class P>
void FluidLoops<K, P>::boundary_pressures(const Particles &p, int type, double *p_over_rho2)
{
  for (int slot = lists.begin(type); slot < lists.begin(type + 1); slot++) {
    const int i = lists.at(slot);
    double sum = 0.0, weights = 0.0;
    for (const int other : lists.present_types()) {
      if (!is_fluid(other)) continue;
      const NeighborSpan found = lists(slot, other);
      for (int k = 0; k < found.n; k++) {
        const double w = weight<K>(p, i, found.of[k], model.pair(type, other).kernel);
        sum += w * model.pressure_scale[other] * p.p_over_rho2[found.of[k]];
        weights += w;
      }
    }
    p_over_rho2[i] = weights > 0.0 ? sum / weights : 0.0;
  }
}

}    // namespace sphcloth

#endif
