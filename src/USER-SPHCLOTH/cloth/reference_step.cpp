// SPDX-License-Identifier: GPL-2.0-or-later
// The step for which k holds: the user's, or the first one where steps vary.

#include "cloth/reference_step.h"

#include "comm.h"
#include "error.h"
#include "update.h"

using namespace LAMMPS_NS;

void ReferenceStep::rescale(int usual_substeps, double substep_dt)
{
  if (given > 0.0) {
    constraints.rescale_stiffness(given / usual_substeps, substep_dt);
  } else if (steps_vary) {
    if (first == 0.0) take_first_step();
    constraints.rescale_stiffness(first / usual_substeps, substep_dt);
  } else
    constraints.rescale_stiffness(update->dt / usual_substeps, substep_dt);
}

void ReferenceStep::take_first_step()
{
  first = update->dt;
  if (comm->me || !constraints.any_soft_k()) return;
  error->warning(FLERR,
                 "{}: steps vary, and a k below 1 is no material: it is taken for the spring that "
                 "it is in the first step, {:.8g}; give 'reference', or a compliance instead of k",
                 owner, first);
}
