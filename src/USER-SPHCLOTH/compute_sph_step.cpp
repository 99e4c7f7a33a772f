// SPDX-License-Identifier: GPL-2.0-or-later
// Values of fix sph/integrate under the names that the user gives.

#include "compute_sph_step.h"

#include "core/timestep/step_limits.h"

using namespace LAMMPS_NS;
using namespace sphcloth;

// the vector of fix sph/integrate

static std::vector<NamedValue> values_of_step()
{
  constexpr auto INTENSIVE = NamedValue::INTENSIVE, EXTENSIVE = NamedValue::EXTENSIVE;
  constexpr int STEPS = 5, PARTICLES = STEPS + N_LIMITS - 1, TIMES = PARTICLES + N_OF_PARTICLES;
  std::vector<NamedValue> values = {
      {"dt", 0, INTENSIVE},
      {"limit", 1, INTENSIVE},
      {"active", 2, INTENSIVE},
      {"updates", 3, EXTENSIVE},
      {"compression", 4, INTENSIVE},
      {"clamped", 5, INTENSIVE},
      {"output", TIMES + 1, INTENSIVE},
      {"next/output", TIMES + 2, INTENSIVE},
      {"sleeping", TIMES + 3, EXTENSIVE},
      {"updates/ideal", TIMES + 4, EXTENSIVE},
      {"wait/max", TIMES + 5, INTENSIVE},
      {"wait/mean", TIMES + 6, INTENSIVE},
      {"sound", TIMES + 7, INTENSIVE},
      {"sound/work", TIMES + 8, EXTENSIVE},
      {"pairs", TIMES + 9, EXTENSIVE},
  };
  for (int k = 1; k < N_LIMITS; k++)
    values.push_back({fmt::format("steps/{}", limit_name(Limit(k))), STEPS + k, INTENSIVE});
  for (int k = 1; k <= N_OF_PARTICLES; k++)
    values.push_back({fmt::format("particles/{}", limit_name(Limit(k))), PARTICLES + k, EXTENSIVE});
  return values;
}

/* ----------------------------------------------------------------------
   compute ID group sph/step keyword ...
------------------------------------------------------------------------- */

ComputeSPHStep::ComputeSPHStep(LAMMPS *lmp_, int narg, char **arg) :
    NamedValues(lmp_, narg, arg, "sph/integrate", values_of_step())
{
}
