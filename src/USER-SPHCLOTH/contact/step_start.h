// SPDX-License-Identifier: GPL-2.0-or-later
// Where owned atoms were at the end of the last step, from which their sweeps start, and how far
// they may have come since the last list build.

#ifndef SPHCLOTH_CONTACT_STEP_START_H
#define SPHCLOTH_CONTACT_STEP_START_H

#include "core/contact/point_triangle.h"
#include "lammps_util/particle_columns.h"
#include "pointers.h"

#include <Eigen/Core>

#include <vector>

namespace LAMMPS_NS {

class StepStart : protected Pointers {
 public:
  using Pointers::Pointers;
  using Vec3 = Eigen::Vector3d;

  bool wants_origins = false;
  ParticleColumns positions;    // x, y, z, which follow the atoms

  // from where the last step has left it to where it is
  sphcloth::Sweep sweep_of(int i) const;
  // of any owned atom, in this step so far; measured once until atoms have moved
  double longest_sweep();
  void atoms_moved() { measured = false; }
  // No owned atom has come farther in the steps since the last list build.
  double longest_path() const { return path; }

  // Where their velocities say that atoms were, once they have moved in a step and before contact
  // moves them; not again until the next step.
  void note_origins(double dt);
  Vec3 origin_of(int i) const { return origins[i]; }
  // owned particles that contact or pores moved in this step, some repeated
  std::vector<int> moved;

  void take_positions();    // the next step starts where atoms are
  void rebuild();    // after each list build

  double bytes() const { return sphcloth::bytes_of(origins, moved); }    // beside the columns

 private:
  std::vector<Vec3> origins;
  double path = 0.0, sweep = 0.0;
  bool measured = false, noted = false;
};

}    // namespace LAMMPS_NS

#endif
