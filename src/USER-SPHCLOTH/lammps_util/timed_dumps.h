// SPDX-License-Identifier: GPL-2.0-or-later
// Computes for dumps at physical times.

#ifndef SPHCLOTH_LAMMPS_UTIL_TIMED_DUMPS_H
#define SPHCLOTH_LAMMPS_UTIL_TIMED_DUMPS_H

#include "lammps.h"
#include "modify.h"
#include "output.h"
#include "update.h"

namespace LAMMPS_NS {

// At the end of a step.  LAMMPS asks for computes anew before a dump that is written every few
// steps, but not before one of 'dump_modify every/time', which would get what they were at the last
// thermodynamic output.

inline void renew_computes_for_timed_dumps(LAMMPS *lmp)
{
  const Output *output = lmp->output;
  if (!output->any_time_dumps) return;
  for (int k = 0; k < output->ndump; k++)
    if (output->mode_dump[k] == 1 && output->next_dump[k] == lmp->update->ntimestep)
      return lmp->modify->clearstep_compute();
}

}    // namespace LAMMPS_NS

#endif
