// SPDX-License-Identifier: GPL-2.0-or-later
// What motion tells of many fluid particles at once: speed, acceleration, rate of the density, and
// the time that free flight lasts.

#ifndef SPHCLOTH_CORE_TIMESTEP_MOTION_STATES_H
#define SPHCLOTH_CORE_TIMESTEP_MOTION_STATES_H

#include "core/timestep/free_flight.h"
#include "core/timestep/step_limits.h"

#include <cstddef>

namespace sphcloth {

struct MotionColumns {
  // of particles; v and f [n, 3]
  const int *type;
  const double *v, *f, *rho, *drho;
  const double *const *external;    // three columns of forces beside f; null: none
  const double *mass;
  bool mass_of_types;    // mass by type, not by particle
  // by type; a rest density of minus infinity: never in free flight
  const double *support, *rest, *rounding;
  double to_accel;    // acceleration times mass over force
  double tolerated;    // largest relative change of density in one step
  bool eases;    // is what free flight changes without effect left out of the rate?
};

SPHCLOTH_MULTIVERSION inline void
find_motion_states(const MotionColumns &columns, const int *particles, int n, StepStates &states)
{
  const MotionColumns of = columns;    // known not to change
  const bool eases = of.eases;
  const double *const *external = of.external;
  for (int k = 0; k < n; k++) {
    const int i = particles[k];
    const double per_mass = of.to_accel / of.mass[of.mass_of_types ? of.type[i] : i];
    const double *v = of.v + 3 * static_cast<std::size_t>(i);
    const double *f = of.f + 3 * static_cast<std::size_t>(i);
    double a[3] = {f[0], f[1], f[2]};
    if (external)
      for (int d = 0; d < 3; d++) a[d] += external[d][i];
    states.speed_sq[k] = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    states.accel_sq[k] = per_mass * per_mass * (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  }
#pragma omp simd
  for (int k = 0; k < n; k++) {
    const int i = particles[k], t = of.type[i];
    const double rho = of.rho[i], rate = of.drho[i];
    const double rest = of.rest[t], rounding = of.rounding[t];
    const bool free = flies(rho, rest, rounding);
    const double gap = gap_to_pressure(rho, rest, rounding);
    states.support[k] = of.support[t];
    states.rho[k] = rho;
    const double beyond = rate_beyond(gap, rate, of.tolerated * rho);
    const double until = time_at_rate(gap, rate);
    states.drho[k] = free && eases ? beyond : rate;
    states.until_pressed[k] = free ? until : 0.0;
  }
}

}    // namespace sphcloth

#endif
