// SPDX-License-Identifier: GPL-2.0-or-later
// With semi-implicit Euler velocities are those of half a step before their positions: it is the
// leapfrog scheme, and of second order, if the first kick takes velocities there.  Those that are
// given, at the start or between two runs, are of the time of the positions: half a kick.  What
// comes in the middle of a run has whole ones, so that it gets what it gives to its neighbors.

#ifndef SPHCLOTH_STEPPING_FIRST_KICK_H
#define SPHCLOTH_STEPPING_FIRST_KICK_H

#include "atom.h"
#include "domain.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/lammps_version.h"
#include "lammps_util/particle_columns.h"

#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {

// Velocities of particles; or positions, also of boundary particles, vertices and obstacles

enum class Change { NOTHING, VELOCITIES, POSITIONS };

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
  void add_particle(int i, bool in_run) { columns[STATE][i] = in_run ? STAGGERED : GIVEN; }
  // What has something else done to atoms of this rank since the last run?
  Change begin_run(const Atom *atom, const Domain *domain)
  {
    Change change = Change::NOTHING;
    for (int i = 0; i < atom->nlocal; i++) {
      double &state = columns[STATE][i];
      const bool moves_by_itself = state == RECORDED;
      if (!moves_by_itself && state != PRESENT) continue;
      const bool same = columns[VELOCITY][i] == fingerprint_of(atom->v[i]);
      state = moves_by_itself && same ? STAGGERED : GIVEN;
      if (has_been_moved(i, atom->x[i], domain))
        change = Change::POSITIONS;
      else if (moves_by_itself && !same)
        change = std::max(change, Change::VELOCITIES);
    }
    return change;
  }
  void end_run(const Atom *atom)
  {
    for (int i = 0; i < atom->nlocal; i++) {
      double &state = columns[STATE][i];
      state = state == STAGGERED ? RECORDED : PRESENT;
      columns[VELOCITY][i] = fingerprint_of(atom->v[i]);
      for (int d = 0; d < 3; d++) columns[POSITION + d][i] = atom->x[i][d];
    }
  }

 private:
  enum Column { STATE, VELOCITY, POSITION, N_COLUMNS = POSITION + 3 };
  // at the end of a run: RECORDED, what it has moved, and PRESENT, all else
  static constexpr double GIVEN = 0.0, STAGGERED = 1.0, RECORDED = 2.0, PRESENT = 3.0;

  // by more than what comes from being moved by a period
  bool has_been_moved(int i, const double *x, const Domain *domain) const
  {
    constexpr double ROUNDING = 1e-12;
    double by[3], largest = 0.0, size = 0.0;
    for (int d = 0; d < 3; d++) by[d] = x[d] - columns[POSITION + d][i];
    release::minimum_image(domain, by);
    for (int d = 0; d < 3; d++) {
      largest = std::max(largest, std::fabs(by[d]));
      size = std::max({size, std::fabs(x[d]), domain->prd[d]});
    }
    return largest > ROUNDING * size;
  }
};

}    // namespace LAMMPS_NS

#endif
