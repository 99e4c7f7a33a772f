// SPDX-License-Identifier: GPL-2.0-or-later
// Half-kick correction: with block steps a velocity is that of the middle of a particle's last
// step, with a uniform step that of half a step ago.  Where output is due all are brought to the
// latter.  Vertices get the impulse that belongs to it in the coming step, deferred: the velocity
// of a light vertex would only be known with the constraints that hold it.

#ifndef SPHCLOTH_STEPPING_HALF_KICK_H
#define SPHCLOTH_STEPPING_HALF_KICK_H

#include "pointers.h"

#include "stepping/block_state.h"
#include "stepping/particle_limits.h"

#include <vector>

namespace LAMMPS_NS {

class HalfKick : protected Pointers {
 public:
  HalfKick(LAMMPS *lmp_, BlockState &state_, const ParticleLimits &limits_) :
      Pointers(lmp_), state(state_), limits(limits_)
  {
  }

  // true if any velocity has changed
  bool correct_velocities();
  void apply_deferred_impulses();
  double bytes() const;

 private:
  BlockState &state;
  const ParticleLimits &limits;
  std::vector<double> forces;    // [n][3]
  std::vector<int> late;    // owned, whose impulses end before those of others

  void find_spans();
  void give_impulses();
  void kick();
};

}    // namespace LAMMPS_NS

#endif
