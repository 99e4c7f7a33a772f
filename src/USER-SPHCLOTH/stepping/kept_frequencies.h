// SPDX-License-Identifier: GPL-2.0-or-later
// What bounds a particle's step by stability, found in every few updates of it: it changes slowly
// where there is pressure and no vertex is near.

#ifndef SPHCLOTH_STEPPING_KEPT_FREQUENCIES_H
#define SPHCLOTH_STEPPING_KEPT_FREQUENCIES_H

#include "pointers.h"

#include "stepping/block_state.h"

namespace LAMMPS_NS {

class KeptFrequencies : protected Pointers {
 public:
  KeptFrequencies(LAMMPS *lmp_, BlockState &state_) : Pointers(lmp_), state(state_) {}

  // of each particle the number of updates for which it goes on with what it has
  const double *waits() const { return state.columns[BlockColumns::WAIT]; }
  // Those that were due have been found; the others get theirs back.
  void note();
  // all are due
  void forget();

 private:
  BlockState &state;

  bool may_wait(int i) const;
};

}    // namespace LAMMPS_NS

#endif
