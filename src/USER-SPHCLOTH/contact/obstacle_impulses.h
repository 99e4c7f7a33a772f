// SPDX-License-Identifier: GPL-2.0-or-later
// Impulses of contact on the vertices of obstacles, which LAMMPS moves: it gets them as forces.
//
// Velocity Verlet lets a force act for half of its own step and half of the next.  What an impulse
// J of a step dt lacks by that, or has too much, is J (1 - dt_next/dt)/2: it comes with those of
// the next step, so that an obstacle gets all that particles and cloth have given.

#ifndef SPHCLOTH_CONTACT_OBSTACLE_IMPULSES_H
#define SPHCLOTH_CONTACT_OBSTACLE_IMPULSES_H

#include "lammps_util/particle_columns.h"

#include <Eigen/Core>

namespace LAMMPS_NS {

// x, y, z of owned atoms, mass times velocity, and the step in which they act

class ObstacleImpulses : public ParticleColumns {
 public:
  void create(int particles) { ParticleColumns::create(4, particles); }

  void begin_step(int n_owned, double dt)
  {
    if (empty()) return;
    for (int i = 0; i < n_owned; i++) {
      double &step = (*this)[STEP][i];
      const double left = step > 0.0 ? 0.5 * (1.0 - dt / step) : 0.0;
      for (int d = 0; d < 3; d++) (*this)[d][i] *= left;
      step = dt;
    }
  }
  void add(int i, const Eigen::Vector3d &impulse)
  {
    for (int d = 0; d < 3; d++) (*this)[d][i] += impulse[d];
  }
  // Over the step in which they act: where a run begins that is the last one, whatever is next.
  double force(int d, int i, double ftm2v) const
  {
    const double step = (*this)[STEP][i];
    return step > 0.0 ? (*this)[d][i] / (step * ftm2v) : 0.0;
  }

 private:
  static constexpr int STEP = 3;
};

}    // namespace LAMMPS_NS

#endif
