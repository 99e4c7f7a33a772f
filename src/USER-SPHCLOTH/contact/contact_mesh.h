// SPDX-License-Identifier: GPL-2.0-or-later
// Whose triangles fix cloth/contact guards: a cloth's, or an obstacle's.

#ifndef SPHCLOTH_CONTACT_CONTACT_MESH_H
#define SPHCLOTH_CONTACT_CONTACT_MESH_H

#include "cloth/cloth_topology.h"

#include <Eigen/Core>

namespace LAMMPS_NS {

class ContactMesh {
 public:
  virtual const ClothTopology &topology() const = 0;
  virtual bool has_vertex(int atom) const = 0;

  // of an owned vertex; 0 if something else moves it.  In the solver attached vertices take part.
  virtual double inverse_mass(int owned_atom) const = 0;
  virtual double inverse_mass_in_solver(int owned_atom) const = 0;

  // what a vertex that something else moves gets behind the solver, mass times velocity
  virtual void push_held(int owned_atom, const Eigen::Vector3d &impulse) = 0;

 protected:
  ~ContactMesh() noexcept(false) = default;
};

}    // namespace LAMMPS_NS

#endif
