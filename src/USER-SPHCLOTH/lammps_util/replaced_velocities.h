// SPDX-License-Identifier: GPL-2.0-or-later
// Atoms whose velocity a command has replaced between two runs, or behind a restart file: they
// start from it, and what a fix knows of their last step is void.

#ifndef SPHCLOTH_LAMMPS_UTIL_REPLACED_VELOCITIES_H
#define SPHCLOTH_LAMMPS_UTIL_REPLACED_VELOCITIES_H

#include "atom.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/particle_columns.h"

#include <cmath>
#include <limits>

namespace LAMMPS_NS {

class ReplacedVelocities {
 public:
  // what tells the velocity at the end of a run from others; not a number before the first step
  ParticleColumns fingerprints;

  void create(int particles)
  {
    fingerprints.create(1, particles);
    for (int i = 0; i < particles; i++) forget(i);
  }
  void forget(int i) { fingerprints[0][i] = std::numeric_limits<double>::quiet_NaN(); }
  bool has_taken_steps(int i) const { return !std::isnan(fingerprints[0][i]); }
  void note_step(int i)
  {
    if (!has_taken_steps(i)) fingerprints[0][i] = 0.0;
  }

  // replaced(i): of this rank's atoms that have another velocity than when they were recorded
  template <class Do> void begin_run(const Atom *atom, Do replaced)
  {
    takes_steps = false;
    for (int i = 0; i < atom->nlocal; i++) {
      if (fingerprints[0][i] == fingerprint_of(atom->v[i])) continue;
      forget(i);
      replaced(i);
    }
  }
  void begin_step() { takes_steps = true; }    // minimize and rerun take none
  void end_run(const Atom *atom)
  {
    if (!takes_steps) return;
    takes_steps = false;
    for (int i = 0; i < atom->nlocal; i++) fingerprints[0][i] = fingerprint_of(atom->v[i]);
  }

  // also in the middle of a run
  double *pack_restart(const Atom *atom, int i, double *buf) const
  {
    *buf = takes_steps ? fingerprint_of(atom->v[i]) : fingerprints[0][i];
    return buf + 1;
  }

 private:
  bool takes_steps = false;
};

}    // namespace LAMMPS_NS

#endif
