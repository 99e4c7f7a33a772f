// SPDX-License-Identifier: GPL-2.0-or-later
// What motion tells of many fluid particles at once: speed, acceleration, rate of the density, and
// the time that free flight lasts.

#ifndef SPHCLOTH_CORE_TIMESTEP_MOTION_STATES_H
#define SPHCLOTH_CORE_TIMESTEP_MOTION_STATES_H

#include "core/timestep/free_flight.h"
#include "core/timestep/step_limits.h"

namespace sphcloth {

struct MotionColumns {
  // of particles; v and f [n, 3]
  const int *type;
  const double *v, *f, *rho, *drho;
  const double *mass;
  bool mass_of_types;    // mass by type, not by particle
  // by type; a rest density of minus infinity: never in free flight
  const double *support, *rest, *rounding;
  double to_accel;    // acceleration times mass over force
  double tolerated;    // largest relative change of density in one step
  bool eases;    // is what free flight changes without effect left out of the rate?
};

SPHCLOTH_MULTIVERSION inline void motion_states(const MotionColumns &of, const int *particles,
                                                int n, StepStates &states)
{
#pragma omp simd
  for (int k = 0; k < n; k++) {
    const int i = particles[k], t = of.type[i];
    const double *v = of.v + 3 * static_cast<std::size_t>(i);
    const double *f = of.f + 3 * static_cast<std::size_t>(i);
    const double per_mass = of.to_accel / of.mass[of.mass_of_types ? t : i];
    const double rho = of.rho[i], rate = of.drho[i];
    const double gap = gap_to_pressure(rho, of.rest[t], of.rounding[t]);
    states.support[k] = of.support[t];
    states.speed_sq[k] = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    states.accel_sq[k] = per_mass * per_mass * (f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    states.rho[k] = rho;
    states.drho[k] = of.eases && gap > 0.0 ? rate_beyond(gap, rate, of.tolerated * rho) : rate;
    states.until_pressed[k] = gap > 0.0 ? time_to_cross(gap, rate) : 0.0;
  }
}

}    // namespace sphcloth

#endif
