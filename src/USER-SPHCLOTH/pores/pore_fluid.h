// SPDX-License-Identifier: GPL-2.0-or-later
// What fix cloth/pores says of triangles and of the fluid that goes through them.

#ifndef SPHCLOTH_PORES_PORE_FLUID_H
#define SPHCLOTH_PORES_PORE_FLUID_H

#include "core/pores/pore_law.h"
#include "fluid/fluid_state.h"

#include <vector>

namespace LAMMPS_NS {

struct PoreFluid {
  const FluidState *state = nullptr;
  std::vector<sphcloth::PoreLaw> laws;    // by atom type
  int groupbit = 0;    // of what goes through
  int first_type = 0, last_type = 0;    // of porous triangles

  bool is_porous(int angle_type) const
  {
    return angle_type >= first_type && angle_type <= last_type;
  }
  double width(int type) const { return state->support(type); }    // of the layer
  double density(int type) const { return state->equation_of_state(type).rho0; }    // at rest
};

}    // namespace LAMMPS_NS

#endif
