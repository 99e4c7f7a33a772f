// SPDX-License-Identifier: GPL-2.0-or-later
// Forces become impulses: what acts on each particle in the coming smallest step, with the time of
// either partner of a pair.
//
// Each active particle gives its own terms to itself and to its neighbors in the pass that finds
// its force.

#ifndef SPHCLOTH_STEPPING_BLOCK_IMPULSES_H
#define SPHCLOTH_STEPPING_BLOCK_IMPULSES_H

#include "pointers.h"

#include "core/neighbor/dual_lists.h"
#include "stepping/block_state.h"
#include "stepping/sleeping_water.h"

#include <vector>

namespace LAMMPS_NS {

class BlockImpulses : protected Pointers {
 public:
  BlockImpulses(LAMMPS *lmp_, BlockState &state_, SleepingWater &sleeping_,
                const ParticleLimits &limits_) :
      Pointers(lmp_), state(state_), sleeping(sleeping_), limits(limits_)
  {
  }

  // to be found with the forces; null where steps are equal or not known yet
  const sphcloth::Impulses *begin();
  // forces between particles alone, on the active ones at least
  void note_pair_forces();
  // impulses take the place of the forces
  void apply();
  void note_total();
  // what other styles have added since, and what the next steps follow from
  void note_external_forces();
  double bytes() const;

 private:
  BlockState &state;
  SleepingWater &sleeping;
  const ParticleLimits &limits;
  sphcloth::Impulses impulses{};
  bool found = false;    // with the forces
  // [n][3]: of other particles; of walls as well; what has taken their place
  std::vector<double> pair_forces, forces, total;
  std::vector<int> pushed;

  void copy_forces(std::vector<double> &to) const;
  void apply_uniform();
  void let_sleep();
  void tell_neighbors();
  void apply_by_bin();
  void find_spans();
  void push_walls(int i);
  void hand_out();
  void mark_beside(int i);
  void mark_slow(int i, int type, int finest_allowed);
  void wake_marked();
  void note_held();
  void note_rates();
  void wake_pushed();
};

}    // namespace LAMMPS_NS

#endif
