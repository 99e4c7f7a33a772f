// SPDX-License-Identifier: GPL-2.0-or-later
// What the arguments of fix cloth/pores say.

#ifndef SPHCLOTH_PORES_PORE_OPTIONS_H
#define SPHCLOTH_PORES_PORE_OPTIONS_H

#include "pointers.h"
#include "pores/pore_fluid.h"

#include <string>

namespace LAMMPS_NS {

class ArgReader;

class PoreOptions : protected Pointers {
 public:
  PoreOptions(LAMMPS *lmp_, const std::string &owner_) : Pointers(lmp_), owner(owner_) {}
  void read(ArgReader &);

  // laws are in units of mass, velocity and length
  PoreFluid of(const FluidState *, int groupbit) const;
  std::string types() const;    // of porous triangles, as they may be given

 private:
  const std::string owner;
  int first_type = 0, last_type = 0;
  double darcy = 0.0, forchheimer = 0.0;
  double permeability = 0.0, thickness = 0.0, inertia = 0.0;    // of a medium, 0: none
  double solidity = 0.0, twine = 0.0;    // of a screen, 0: none
};

}    // namespace LAMMPS_NS

#endif
