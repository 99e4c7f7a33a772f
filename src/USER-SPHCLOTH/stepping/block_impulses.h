// SPDX-License-Identifier: GPL-2.0-or-later
// Forces become impulses: what acts on each particle in the coming smallest step, with the time of
// either partner of a pair.

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
  BlockImpulses(LAMMPS *lmp_, BlockState &state_, SleepingWater &sleeping_) :
      Pointers(lmp_), state(state_), sleeping(sleeping_)
  {
  }

  // forces between particles alone, on the active ones at least
  void note_pair_forces();
  // impulses take the place of the forces
  void apply();
  void note_total();
  // what other styles have added since
  void note_external_forces();
  double bytes() const;

 private:
  BlockState &state;
  SleepingWater &sleeping;
  std::vector<double> pair_forces, total;    // [n][3]
  std::vector<int> slots;    // of particles whose impulses are summed pair by pair

  void copy_forces(std::vector<double> &to) const;
  void apply_uniform();
  void apply_by_bin();
  void find_spans();
  void add_pair_force(int i, double times);
  bool neighbors_share_step(int i);
  bool examine(int i, int type, const sphcloth::NeighborSpan &others);
  void disturb_sleeping(int i, int j);
  void wake_marked();
};

}    // namespace LAMMPS_NS

#endif
