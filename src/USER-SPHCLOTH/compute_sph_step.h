// SPDX-License-Identifier: GPL-2.0-or-later
// compute sph/step: what fix sph/integrate knows of the time step, by keyword.

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(sph/step,ComputeSPHStep);
// clang-format on
#else

#ifndef LMP_COMPUTE_SPH_STEP_H
#define LMP_COMPUTE_SPH_STEP_H

#include "lammps_util/named_values.h"

namespace LAMMPS_NS {

class ComputeSPHStep : public NamedValues {
 public:
  ComputeSPHStep(class LAMMPS *, int, char **);
};

}    // namespace LAMMPS_NS

#endif
#endif
