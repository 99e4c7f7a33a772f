// SPDX-License-Identifier: GPL-2.0-or-later
// The loops over neighbors, for one kernel and one precision.
//
// Every loop writes one accumulator per particle and evaluates terms that are antisymmetric in the
// two partners to the last bit, so the two halves of a pair cancel without a half list or a reverse
// communication, in single precision too.  Columns of neighbors and the one loop over them are in
// core/sph/pair_columns.h, the terms in density_loops.h, force_loops.h and rate_loops.h.

#ifndef SPHCLOTH_CORE_SPH_FLUID_LOOPS_H
#define SPHCLOTH_CORE_SPH_FLUID_LOOPS_H

#include "core/sph/fluid.h"
#include "core/sph/gradient.h"
#include "core/sph/pair_columns.h"

#include <array>
#include <utility>

namespace sphcloth {

template <class K, class P> class FluidLoops : public Fluid {
 public:
  using Real = typename P::Real;
  using Records = PairColumns<P>;
  using Columns = typename Records::Columns;
  using Neighborhood = typename Records::Neighborhood;
  using Separation = typename Records::Separation;
  using Terms = LoopTerms<P>;
  static constexpr int LANES = GROUP<Real>;

  void record_positions(const Particles &p, const Box &box) override
  {
    find_touched(p);
    double inv_support = 0.0;    // of the widest pair
    for (const PairTerms &t : model.terms)
      if (t.kernel.inv_support > 0.0 && !(inv_support > 0.0 && inv_support < t.kernel.inv_support))
        inv_support = t.kernel.inv_support;
    records.record_positions(p, box, inv_support > 0.0 ? 1.0 / inv_support : 1.0, touched());
    f_unit = std::pow(records.unit, -(model.dimension + 1));
  }
  void volumes(const Particles &, int type, double *volume) override { sum_volumes(type, volume); }
  void gather(const Particles &, bool sum) override;
  void density_gradients(const Particles &p, double *gradient) override
  {
    all_density_gradients(p, gradient);
  }
  void density_rates(const Particles &, const double *gradient, double back, double *rate) override;
  void diffuse(const Particles &p, const Diffusion &diffusion) override
  {
    records.record_gradients(diffusion.gradient, diffusion.since, 1.0, p.n_all, touched());
    diffuse_all(p, diffusion);
  }
  void smooth_densities(const Particles &, double *smooth) override;
  void boundary_pressures(const Particles &, int type, double *p_over_rho2) override;
  void record(const Particles &p) override
  {
    records.record(p, model.role.data(), model.pressure_scale.data(), touched());
  }
  void viscosity_shares(const Particles &p, double *share) override
  {
    all_viscosity_shares(p, share);
  }
  void record_viscosity_shares(const Particles &p, const double *share) override
  {
    records.record_shares(share, p.n_all, touched());
  }
  void sum_gradients(const Particles &p, double *gradient) override
  {
    SurfaceLoops{*this}.sum_gradients(p, gradient);
  }
  void record_turns(const Particles &p, const double *turn) override
  {
    const double scale = 1.0 / (records.unit * records.unit);
    records.record_gradients(turn, nullptr, scale, p.n_all, touched());
  }
  void turn_forces(const Particles &p) override { SurfaceLoops{*this}.forces(p); }
  void turn_virials(const Particles &p, Receiver receive, void *context) override
  {
    SurfaceLoops{*this}.virials(p, {receive, context});
  }
  void forces(const Particles &, Target) override;
  void impulses(const Particles &, const Impulses &) override;
  void virials(const Particles &, Receiver, void *context) override;
  void stiffness(const Particles &p, const Selection &of, const double *share,
                 Stiffness *found) override
  {
    share ? all_stiffness<true>(p, of, share, found) : all_stiffness<false>(p, of, share, found);
  }
  void vertex_stiffness(const Particles &, const int *is_vertex, const double *weight,
                        VertexStiffness *) override;
  void vertex_rows(const Particles &, const int *is_vertex, const VertexStiffness *, bool scaled,
                   VertexRow *) override;
  void vertex_gradients(const Particles &, const int *is_vertex, VertexGradients *) override;
  void vertex_pairs(const Particles &, const int *is_vertex, const double *strength,
                    const double *normals, VertexPairs &) override;
  double take_pair_evaluations() override { return std::exchange(records.n_evaluated, 0.0); }
  double bytes() const override
  {
    return lists.bytes() + records.bytes() +
        bytes_of(selection.slots, touched_particles, is_touched);
  }

 private:
  // of forces, force_loops.h
  template <Outputs OUTPUTS, bool VIRIAL, bool SOURCE> struct Sums;
  struct DifferenceSums;    // rate_loops.h
  struct VelocitySums;    // viscosity_loops.h
  struct SurfaceSums;    // surface_loops.h
  struct SurfaceLoops;
  struct Listener {    // what gets the virials
    Receiver receive = nullptr;
    void *context = nullptr;
  };
  struct Gift {    // of Impulses, what one particle gives
    Real pressure = 0, span = 0;
    double scale = 0.0;    // of a force, from the loops' acceleration
    const int *sleeping = nullptr;
    double *given = nullptr;
    double *to(int i) const { return given + Impulses::STRIDE * static_cast<std::size_t>(i); }
  };

  Records records;
  double f_unit = 1.0;    // of an acceleration or a rate: the loops' lengths are in records.unit
  std::vector<Terms> terms;    // as the model's, for this evaluation
  AlignedVector<double> equal_mass;    // [n_types + 1][LANES]
  AlignedVector<double> unequal_mass;    // of the neighbors of one particle

  bool is_fluid(int t) const { return model.role[t] == Role::FLUID; }
  Terms in_loops(const PairTerms &t) const { return {t, records.quantum[0], records.unit, f_unit}; }
  const Terms &pair(int t, int other) const { return terms[t * (model.n_types + 1) + other]; }

  // Once per evaluation: what the loops read of the model, in their precision
  void begin_evaluation()
  {
    terms.clear();
    for (const PairTerms &of_pair : model.terms) terms.push_back(in_loops(of_pair));
    equal_mass.resize(model.mass.size() * LANES);
    for (std::size_t t = 0; t < model.mass.size(); t++)
      std::fill_n(&equal_mass[t * LANES], LANES, model.mass[t]);
    unequal_mass.resize(whole_groups(lists.longest()));
  }

  SPHCLOTH_INLINE MassColumns masses(const Particles &p, const NeighborSpan &near, int type)
  {
    if (model.mass[type] > 0.0) return {&equal_mass[type * LANES], 0};
    for (int k = 0; k < near.n; k++) unequal_mass[k] = p.mass_or_volume[near.of[k]];
    return {unequal_mass.data(), 1};
  }

  // density_loops.h; virtual functions cannot be multiversioned, so others do their work
  template <bool WEIGHTED> double shape_sum(const Neighborhood &, Columns &) const;
  void sum_densities(const Particles &, bool sum);
  void sum_volumes(int type, double *volume);

  // force_loops.h
  void apply(const Particles &, int i, bool fluid, const Acceleration &) const;
  template <Friction F, Outputs OUTPUTS, bool VIRIAL>
  void all_forces(const Particles &, Target, Listener);
  template <Outputs OUTPUTS> void forces_and(const Particles &, Target);
  template <Outputs OUTPUTS> void impulses_and(const Particles &, const Impulses &);
  template <Friction F, Outputs OUTPUTS> void all_impulses(const Particles &, const Impulses &);
  SPHCLOTH_INLINE Gift gift_of(const Particles &p, int i, int t, const Impulses &of) const
  {
    return {static_cast<Real>(model.pressure_scale[t] * of.pressure_time[i]),
            static_cast<Real>(of.span[i]), p.mass_or_volume[i] * p.force_unit * f_unit, of.sleeping,
            of.given};
  }
  template <Friction F, Outputs OUTPUTS, bool VIRIAL, bool SOURCE>
  Acceleration forces_on(const Particles &, int slot, int t, const Gift &);
  template <Friction F, Outputs OUTPUTS, bool VIRIAL, bool SOURCE, bool SLEEPING>
  void fluid_on_fluid(const Neighborhood &, Columns &, Sums<OUTPUTS, VIRIAL, SOURCE> &,
                      const Gift &) const;
  template <Friction F, Outputs OUTPUTS, bool VIRIAL, bool SOURCE, bool ON_BOUNDARY>
  void across_boundary(const Neighborhood &, Columns &, Sums<OUTPUTS, VIRIAL, SOURCE> &,
                       const Gift &) const;
  // a push along the line of two particles, and friction along their velocity
  template <Friction F>
  static SPHCLOTH_INLINE std::array<Real, 3>
  along_and_drag(Real push, const Separation &r, Real friction, const std::array<Real, 3> &velocity)
  {
    std::array<Real, 3> f{push * r.x, push * r.y, push * r.z};
    if (F >= Friction::ANY)
      for (int d = 0; d < 3; d++) f[d] += friction * velocity[d];
    return f;
  }

  // viscosity_loops.h
  void all_viscosity_shares(const Particles &, double *share);

  // stiffness_loops.h
  template <bool SHARES>
  void all_stiffness(const Particles &, const Selection &, const double *share, Stiffness *);
  template <bool BOUNDARY, bool SHARES>
  void add_stiffness(const Neighborhood &, const PairTerms &, const double *share, Columns &,
                     Stiffness &) const;

  // rate_loops.h
  void all_density_gradients(const Particles &, double *gradient);
  template <bool DIFFUSION> void all_density_rates(const Particles &, double back, double *rate);
  Differences density_differences(const Neighborhood &, Columns &) const;
  template <bool FROM_BOUNDARY, bool DIFFUSION>
  double density_rate(const Neighborhood &, double back, Columns &) const;
  void diffuse_all(const Particles &, const Diffusion &);
};

template <class K> std::unique_ptr<Fluid> fluid_of_kernel(Precision precision)
{
  if (precision == Precision::MIXED) return std::make_unique<FluidLoops<K, MixedPrecision>>();
  return std::make_unique<FluidLoops<K, DoublePrecision>>();
}

}    // namespace sphcloth

#endif
