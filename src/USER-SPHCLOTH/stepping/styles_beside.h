// SPDX-License-Identifier: GPL-2.0-or-later
// Fixes and pair styles of LAMMPS that contradict the stepping scheme in force.

#ifndef SPHCLOTH_STEPPING_STYLES_BESIDE_H
#define SPHCLOTH_STEPPING_STYLES_BESIDE_H

#include "stepping/stepping_scheme.h"

#include <string>

namespace LAMMPS_NS {

class FluidState;

// Before a run; errors and warnings are in the name of the style of this label.
void check_styles_beside(class LAMMPS *, const std::string &label, SteppingScheme,
                         const FluidState &);

}    // namespace LAMMPS_NS

#endif
