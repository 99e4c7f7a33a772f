// SPDX-License-Identifier: GPL-2.0-or-later
// Substeps spread the forces of the start of a step evenly over it, so that what hangs at rest
// hangs exactly, but they come half a step, less half a substep, late.  That much is given ahead at
// the start of each step, and what the last one gave ahead is taken back: that makes the step
// velocity Verlet, which feeds no motion.

#ifndef SPHCLOTH_CLOTH_HALF_KICK_CORRECTION_H
#define SPHCLOTH_CLOTH_HALF_KICK_CORRECTION_H

#include "atom.h"
#include "cloth/cloth_vertices.h"
#include "lammps_util/particle_columns.h"

#include <cmath>
#include <limits>

namespace LAMMPS_NS {

class HalfKickCorrection {
 public:
  ParticleColumns impulse;    // that forces gave ahead of time, per atom; empty: none

  bool on() const { return !impulse.empty(); }
  void turn_on(int particles)
  {
    impulse.create(3, particles);
    for (int i = 0; i < particles; i++) forget(i);
  }
  // of a vertex before its first step
  void forget(int i)
  {
    for (int d = 0; d < 3; d++) impulse[d][i] = std::numeric_limits<double>::quiet_NaN();
  }

  // ftm2v: unit of force over that of mass times acceleration
  void apply(ClothVertices &vertices, int substeps, double dt, double ftm2v, const Atom *atom)
  {
    const double part = 0.5 * (1.0 - 1.0 / substeps), dtf = part * dt * ftm2v;
    for (int s = 0; s < vertices.halo.n_owned(); s++) {
      const int i = vertices.halo.atom_of(s);
      const bool first = std::isnan(impulse[0][i]);
      for (int d = 0; d < 3; d++) {
        const double ahead = dtf * atom->f[i][d];
        if (!first) atom->v[i][d] += vertices.inverse_mass[s] * (ahead - impulse[d][i]);
        impulse[d][i] = ahead;
      }
    }
  }

  // momentum along d that is ahead, of this rank's vertices
  double sum(const ClothVertices &vertices, int d) const
  {
    double sum = 0.0;
    for (int s = 0; on() && s < vertices.halo.n_owned(); s++) {
      const int i = vertices.halo.atom_of(s);
      if (vertices.inverse_mass[s] > 0.0 && !std::isnan(impulse[d][i])) sum += impulse[d][i];
    }
    return sum;
  }
};

}    // namespace LAMMPS_NS

#endif
