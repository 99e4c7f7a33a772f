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
  return found;
}

std::vector<FluidBoundary *>
LAMMPS_NS::put_renormalizing_last(std::vector<FluidBoundary *> &boundaries)
{
  const auto first =
      std::stable_partition(boundaries.begin(), boundaries.end(),
                            [](const FluidBoundary *b) { return !b->renormalizes(); });
  return {first, boundaries.end()};
}

bool LAMMPS_NS::have_vertices(const std::vector<FluidBoundary *> &boundaries)
{
  return std::any_of(boundaries.begin(), boundaries.end(),
                     [](const FluidBoundary *boundary) { return boundary->has_vertices(); });
}

bool LAMMPS_NS::have_vertices_beside(const std::vector<FluidBoundary *> &boundaries, int i)
{
  return std::any_of(boundaries.begin(), boundaries.end(),
                     [i](FluidBoundary *boundary) { return boundary->has_vertices_beside(i); });
}
