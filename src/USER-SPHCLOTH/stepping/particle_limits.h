// SPDX-License-Identifier: GPL-2.0-or-later
// The longest time step that each fluid particle and each vertex of a cloth allows: gathers from
// atoms and styles what the formulas of core/timestep/step_limits.h need.

#ifndef SPHCLOTH_STEPPING_PARTICLE_LIMITS_H
#define SPHCLOTH_STEPPING_PARTICLE_LIMITS_H

#include "atom.h"
#include "fix.h"
#include "pointers.h"

#include "core/sph/tait.h"
#include "core/timestep/step_limits.h"
#include "fluid/vertex_mobility.h"
#include "stepping/limited_vertices.h"
#include "stepping/step_options.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace LAMMPS_NS {

class FluidState;

class ParticleLimits : protected Pointers, public VertexMobility {
 public:
  ParticleLimits(LAMMPS *lmp_, const StepOptions &options_) :
      Pointers(lmp_), options(options_), fluid(nullptr)
  {
  }

  void init(FluidState *, SteppingScheme);
  // what limits follow from, also when a speed of sound has changed
  void take_materials();

  // Fluid particles without pressure are in free flight, which ends where neighbors under pressure
  // press on them.  Where a step is no longer than that of these neighbors they need not be asked.
  void ask_neighbors(bool whether) { asks_neighbors = whether; }

  // What limits follow from: forces beside atom->f, three columns or null, and atom->drho; or,
  // where forces are not known, acceleration, squared, and rate of the density of another update.
  struct Rates {
    const double *const *external = nullptr;
    const double *accel_sq = nullptr, *density = nullptr;
  };
  // of fluid particles: take(i, limit)
  template <class Take>
  void for_particles(const std::vector<int> &particles, const Rates &rates, Take take) const
  {
    sphcloth::StepLimits limits;
    const int n = static_cast<int>(particles.size());
    for (int from = 0; from < n; from += sphcloth::StepStates::MAX) {
      const int *some = particles.data() + from;
      const int m = std::min(n - from, sphcloth::StepStates::MAX);
      find(some, m, rates, limits);
      for (int k = 0; k < m; k++) take(some[k], limits[k]);
    }
  }

  // of vertices that move: take(i, limit)
  template <class Take> void for_vertices(Take take) const
  {
    for_moving_vertices(
        [&](int i, const LimitedVertices &vertices) { take(i, of_vertex(i, vertices)); });
  }
  // act(i, the vertices it is one of)
  template <class Act> void for_moving_vertices(Act act) const
  {
    for (const Cloth &cloth : cloths)
      for (int i = 0; i < atom->nlocal; i++)
        if (atom->mask[i] & cloth.fix->groupbit && cloth.vertices->inverse_mass(i) > 0.0)
          act(i, *cloth.vertices);
  }

  double inverse_mass_of(int owned_atom) const override;

  // What stability allows a fluid particle, for the next steps of all, from its frequencies.
  // for_particles() knows it itself where particles take steps of their own.
  sphcloth::StepLimit stable_limit(int i) const;

  // a number that changes with what stability follows from, but for positions; collective
  std::uint64_t settings() const;

  // The same of the fixes that may hold water or move it, defined in any order: by style and group,
  // or by their IDs as well, which change with arguments more often.
  std::uint64_t fixes_that_hold(bool told_by_id) const;

  // smoothing length over speed of sound, the least of all fluids
  double shortest_sound_time() const;
  // in which sound crosses the support
  double sound_time(int i) const;
  double acceleration(int i, double by_force) const;

 private:
  struct FluidType {
    double viscosity = 0.0, sound = 0.0;
    double at_boundary = 1.0;    // sound there over sound elsewhere
    sphcloth::Tait eos;
  };
  struct Cloth {
    const Fix *fix;
    const LimitedVertices *vertices;
  };

  const StepOptions &options;
  FluidState *fluid;
  std::vector<FluidType> types;
  struct {
    std::vector<double> support, rest, rounding;    // of MotionColumns; the first of all types
  } motion;
  std::vector<Cloth> cloths;
  bool asks_neighbors = true;
  bool interpolates_density = false;
  sphcloth::StepCoefficients lambda;    // of for_particles() and of vertices

  void find(const int *particles, int n, const Rates &, sphcloth::StepLimits &) const;
  sphcloth::StepLimit of_vertex(int i, const LimitedVertices &) const;
  void find_motions(const int *particles, int n, const Rates &, sphcloth::StepStates &) const;
  void add_pressure(int i, int k, const Rates &, sphcloth::StepStates &) const;
  double acceleration_sq(int i, const double *force) const;
  sphcloth::StepState vertex_state(int i) const;
  double scaled_acceleration(int i, double unscaled) const;
  void set_frequencies(int i, sphcloth::StepState &) const;
  double until_pressed(int i, double density_rate, const sphcloth::StepState &) const;
};

}    // namespace LAMMPS_NS

#endif
