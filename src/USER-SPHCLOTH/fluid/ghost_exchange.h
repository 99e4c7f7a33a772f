// SPDX-License-Identifier: GPL-2.0-or-later
// What the pair style sends between the owners of particles and their ghosts.

#ifndef SPHCLOTH_FLUID_GHOST_EXCHANGE_H
#define SPHCLOTH_FLUID_GHOST_EXCHANGE_H

namespace LAMMPS_NS {

// One number, density and pressure; for a density that is integrated three, one and one; what a
// vertex has; a share for the limit of stability; a share of viscosity; four of a density that
// is completed at free surfaces; for mass scaling one, four and three

enum class GhostData {
  MASS_OR_VOLUME,
  DENSITY,
  GRADIENT,
  SINCE,
  CHANGE,
  STIFFNESS,
  SHARE,
  VISCOSITY,
  TURN,
  STRENGTH,
  KICK,
  IMPULSE
};

class GhostExchange {
 public:
  virtual void send_to_ghosts(GhostData) = 0;
  virtual void add_from_ghosts(GhostData) = 0;

 protected:
  ~GhostExchange() = default;
};

}    // namespace LAMMPS_NS

#endif
