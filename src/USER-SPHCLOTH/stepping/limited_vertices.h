// SPDX-License-Identifier: GPL-2.0-or-later
// What the limits of the time step ask of a fix that moves the vertices of a cloth.

#ifndef SPHCLOTH_STEPPING_LIMITED_VERTICES_H
#define SPHCLOTH_STEPPING_LIMITED_VERTICES_H

namespace LAMMPS_NS {

class LimitedVertices {
 public:
  // 0: the vertex does not move and limits no step
  virtual double inverse_mass(int owned_atom) const = 0;
  // rest length of the shortest edge at an owned vertex, infinite without any
  virtual double shortest_edge(int owned_atom) const = 0;

 protected:
  ~LimitedVertices() = default;
};

}    // namespace LAMMPS_NS

#endif
