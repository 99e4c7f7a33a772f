// SPDX-License-Identifier: GPL-2.0-or-later
// What the arguments of fix cloth/air say.

#ifndef SPHCLOTH_AIR_AIR_OPTIONS_H
#define SPHCLOTH_AIR_AIR_OPTIONS_H

#include "air/wind.h"
#include "core/air/air_loads.h"
#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

class AirOptions : protected Pointers {
 public:
  sphcloth::AirDrag drag;
  Wind wind;
  bool shaded = false;    // cloth keeps the wind off cloth in its lee
  double added_thickness = 0.0;    // of air that moves along with the cloth

  AirOptions(LAMMPS *lmp_, const std::string &owner_) :
      Pointers(lmp_), wind(lmp_, owner_), owner(owner_)
  {
  }
  void read(ArgReader &);

 private:
  const std::string owner;

  void read_table(const std::string &file);
};

}    // namespace LAMMPS_NS

#endif
