// SPDX-License-Identifier: GPL-2.0-or-later
// Stores where steps start, and bounds how far atoms come.

#include "contact/step_start.h"

#include "atom.h"
#include "core/geometry/displacements.h"
#include "domain.h"
#include "lammps_util/lammps_version.h"

using namespace LAMMPS_NS;
using namespace sphcloth;

Sweep StepStart::sweep_of(int i) const
{
  const double *x = atom->x[i];
  return {Vec3(positions[0][i], positions[1][i], positions[2][i]), Vec3(x[0], x[1], x[2])};
}

double StepStart::longest_sweep()
{
  const int n = atom->nlocal;
  if (!measured)
    sweep = n == 0 ? 0.0
                   : longest_displacement(n, atom->x[0], positions[0], positions[1], positions[2]);
  measured = true;
  return sweep;
}

void StepStart::note_origins(double dt)
{
  if (noted || !wants_origins) return;
  noted = true;
  origins.resize(atom->nlocal);
  for (int i = 0; i < atom->nlocal; i++) origins[i] = Vec3(atom->x[i]) - dt * Vec3(atom->v[i]);
}

void StepStart::take_positions()
{
  noted = false;
  path += longest_sweep();
  double *const x0 = positions[0], *const y0 = positions[1], *const z0 = positions[2];
  for (int i = 0; i < atom->nlocal; i++) {
    x0[i] = atom->x[i][0];
    y0[i] = atom->x[i][1];
    z0[i] = atom->x[i][2];
  }
  atoms_moved();
}

// LAMMPS has put atoms back into the box.  It may be another box by the end of the next step.

void StepStart::rebuild()
{
  for (int i = 0; i < atom->nlocal; i++) {
    double displacement[3];
    for (int d = 0; d < 3; d++) displacement[d] = atom->x[i][d] - positions[d][i];
    release::minimum_image(domain, displacement);
    for (int d = 0; d < 3; d++) positions[d][i] = atom->x[i][d] - displacement[d];
  }
  atoms_moved();
  path = longest_sweep();
}
