// SPDX-License-Identifier: GPL-2.0-or-later
// Lines 30 to 33 of Algorithm 1, semi-implicit Euler: velocity first, then position with the new
// velocity.

#ifndef SPHCLOTH_STEPPING_KICK_DRIFT_H
#define SPHCLOTH_STEPPING_KICK_DRIFT_H

#include "atom.h"
#include "force.h"
#include "lammps_util/atom_tools.h"
#include "update.h"

namespace LAMMPS_NS {

struct Moved {
  int moved = 0, at_rest = 0;    // numbers of particles
};

// All of a group but those that rest; share(i) of the step is the time of the kick

template <class Rests, class Share>
Moved kick_and_drift(Atom *atom, const Update *update, const Force *force, int groupbit,
                     Rests rests, Share share)
{
  Moved n;
  const double dt = update->dt, dtf = dt * force->ftm2v;
  double **x = atom->x, **v = atom->v, **f = atom->f;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    if (rests(i)) {
      n.at_rest++;
      continue;
    }
    const double kick = share(i) * dtf / atom_mass(atom, i);
    for (int d = 0; d < 3; d++) {
      v[i][d] += kick * f[i][d];
      x[i][d] += dt * v[i][d];
    }
    n.moved++;
  }
  return n;
}

}    // namespace LAMMPS_NS

#endif
