// SPDX-License-Identifier: GPL-2.0-or-later
// With semi-implicit Euler velocities are those of half a step before their positions: it is the
// leapfrog scheme, and of second order, if the first kick takes velocities there.  Those that are
// given, at the start or between two runs, are of the time of the positions: half a kick.  What
// comes in the middle of a run has whole ones, so that it gets what it gives to its neighbors.

#ifndef SPHCLOTH_STEPPING_FIRST_KICK_H
#define SPHCLOTH_STEPPING_FIRST_KICK_H

#include "atom.h"
#include "lammps_util/particle_columns.h"

namespace LAMMPS_NS {

class FirstKick {
 public:
  // per atom, for exchange and restart
  ParticleColumns columns;

  FirstKick() { columns.create(N_COLUMNS, 0); }

  // of a particle, for its next step, which follows
  double share(int i)
  {
    double &state = columns[STATE][i];
    if (state == STAGGERED) return 1.0;
    const double share = state == RECORDED ? 1.0 : 0.5;
    state = STAGGERED;
    return share;
  }
  // has its velocity been given between two runs?
  bool is_changed(int i) const { return columns[STATE][i] == CHANGED; }

  void add_particle(int i, bool in_run) { columns[STATE][i] = in_run ? STAGGERED : GIVEN; }
  // has something else changed velocities since the last run?
  void begin_run(const Atom *atom)
  {
    for (int i = 0; i < atom->nlocal; i++)
      if (columns[STATE][i] == RECORDED)
        columns[STATE][i] = columns[VELOCITY][i] == fingerprint(atom->v[i]) ? STAGGERED : CHANGED;
  }
  void end_run(const Atom *atom)
  {
    for (int i = 0; i < atom->nlocal; i++)
      if (columns[STATE][i] == STAGGERED) {
        columns[STATE][i] = RECORDED;
        columns[VELOCITY][i] = fingerprint(atom->v[i]);
      }
  }

 private:
  enum Column { STATE, VELOCITY, N_COLUMNS };
  static constexpr double GIVEN = 0.0, STAGGERED = 1.0, RECORDED = 2.0, CHANGED = 3.0;

  // other velocities have another one, but by chance
  static double fingerprint(const double *v)
  {
    return v[0] + 1.6180339887 * v[1] + 2.7182818 * v[2];
  }
};

}    // namespace LAMMPS_NS

#endif
