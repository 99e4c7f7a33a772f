// SPDX-License-Identifier: GPL-2.0-or-later
// Which stepping scheme a name stands for.

#ifndef SPHCLOTH_STEPPING_MAKE_STEPPER_H
#define SPHCLOTH_STEPPING_MAKE_STEPPER_H

#include "stepping/block_state.h"
#include "stepping/stepper.h"
#include "stepping/stepping_scheme.h"

#include <memory>

namespace LAMMPS_NS {

// clock: where block steps begin or go on
std::unique_ptr<Stepper> make_stepper(LAMMPS *, SteppingScheme, const SteppingParts &,
                                      const BlockClock &clock);

}    // namespace LAMMPS_NS

#endif
