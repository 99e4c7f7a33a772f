// SPDX-License-Identifier: GPL-2.0-or-later
// What stepping schemes have in common.

#include "stepping/stepper.h"

#include "atom.h"
#include "fluid/fluid_state.h"

using namespace LAMMPS_NS;

void Stepper::init(FluidState *style, Change)
{
  fluid = style;
  tell_active(false);
}

void Stepper::grow(int nmax)
{
  columns().grow(nmax);
  if (fluid) tell_active(false);
}

void Stepper::shift_times(double by)
{
  for (int i = 0; i < atom->nlocal; i++) parts.rows[i][UpdateRows::LAST_UPDATE] += by;
}

void Stepper::tell_active(bool all)
{
  fluid->set_active(all ? nullptr : parts.rows.row, UpdateRows::ACTIVE, interpolates_density());
}
