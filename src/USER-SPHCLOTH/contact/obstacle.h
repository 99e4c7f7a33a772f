// SPDX-License-Identifier: GPL-2.0-or-later
// A mesh of atoms that no cloth solver moves: they are fixed, or another fix moves them, which
// finds the forces of contact in f.

#ifndef SPHCLOTH_CONTACT_OBSTACLE_H
#define SPHCLOTH_CONTACT_OBSTACLE_H

#include "atom.h"
#include "contact/contact_mesh.h"
#include "contact/obstacle_impulses.h"

#include <string>

namespace LAMMPS_NS {

class Obstacle : public ContactMesh, protected Pointers {
 public:
  Obstacle(LAMMPS *lmp_, const std::string &owner, int groupbit_, ObstacleImpulses &impulses_) :
      Pointers(lmp_), groupbit(groupbit_), mesh(lmp, owner), impulses(impulses_)
  {
  }
  void gather() { mesh.gather(groupbit); }
  void measure() { mesh.measure(); }

  const ClothTopology &topology() const override { return mesh; }
  bool has_vertex(int i) const override { return atom->mask[i] & groupbit; }
  double inverse_mass(int) const override { return 0.0; }
  double inverse_mass_in_solver(int) const override { return 0.0; }
  void push_held(int i, const Eigen::Vector3d &impulse) override { impulses.add(i, impulse); }

  const int groupbit;

 private:
  ClothTopology mesh;
  ObstacleImpulses &impulses;
};

}    // namespace LAMMPS_NS

#endif
