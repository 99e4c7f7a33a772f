// SPDX-License-Identifier: GPL-2.0-or-later
// Sleeping particles: water at rest keeps its place, density and pressure, and is a wall for its
// neighbors, until something disturbs it.

#ifndef SPHCLOTH_STEPPING_SLEEPING_WATER_H
#define SPHCLOTH_STEPPING_SLEEPING_WATER_H

#include "pointers.h"

#include "stepping/block_state.h"
#include "stepping/particle_limits.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

class SleepingWater : protected Pointers {
 public:
  SleepingWater(LAMMPS *lmp_, BlockState &state_, const ParticleLimits &limits_) :
      Pointers(lmp_), state(state_), limits(limits_)
  {
  }

  bool enabled() const { return state.options.sleep > 0.0; }
  bool is_slow(int i) const;
  // Stops active particles that have been slow for long, among others that are slow; true if there
  // are any on any rank
  bool stop_resting();
  void fall_asleep();    // those
  // wakes all where what may hold it is another than in the last run
  void begin_run();
  // Particles that other styles have given speed or a force; all, where other fixes have taken
  // atoms away
  void wake_disturbed();
  // wakes one that sleeps in the next step
  void disturb(int i);
  // the same of those within the support of these positions, from which atoms of all ranks have
  // been taken away
  void wake_beside(const std::vector<std::array<double, 3>> &);
  // marks sleeping particles beside moving boundaries
  void mark_beside_moving_boundaries();
  // beside active particles, and due to be asked again whether it rests
  bool has_slept_long(int i, double now) const;
  // takes part from the next smallest step on; for an inactive particle, its step ends
  void wake(int i);
  double bytes() const;

 private:
  BlockState &state;
  const ParticleLimits &limits;
  std::vector<int> resting;
  bigint n_atoms = 0;    // in the last step

  void find_resting();
  bool is_at_rest(int i);
  bool gains_speed(int i, double force_sq) const;
  bool all_neighbors_are_slow(int i) const;
  void wake_neighbors(int i);
};

}    // namespace LAMMPS_NS

#endif
