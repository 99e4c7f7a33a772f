// SPDX-License-Identifier: GPL-2.0-or-later
// Finds the fixes that are boundaries to the fluid.

#include "fluid/fluid_boundary.h"

#include "fix.h"
#include "modify.h"

#include <algorithm>

using namespace LAMMPS_NS;

std::vector<FluidBoundary *> LAMMPS_NS::find_fluid_boundaries(Modify *modify)
{
  std::vector<FluidBoundary *> found;
  for (Fix *fix : modify->get_fix_list()) {
    int dim = 0;
    if (void *boundary = fix->extract(FluidBoundary::EXTRACT, dim))
      found.push_back(static_cast<FluidBoundary *>(boundary));
  }
  std::stable_partition(found.begin(), found.end(),
                        [](const FluidBoundary *b) { return !b->renormalizes(); });
  return found;
}
