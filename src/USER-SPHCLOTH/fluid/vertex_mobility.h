// SPDX-License-Identifier: GPL-2.0-or-later
// How easily fluid moves the vertices of cloths: what the limit of stability asks of them.

#ifndef SPHCLOTH_FLUID_VERTEX_MOBILITY_H
#define SPHCLOTH_FLUID_VERTEX_MOBILITY_H

namespace LAMMPS_NS {

class VertexMobility {
 public:
  // 0: the owned atom is no vertex, or does not move
  virtual double inverse_mass_of(int owned_atom) const = 0;

 protected:
  ~VertexMobility() = default;
};

}    // namespace LAMMPS_NS

#endif
