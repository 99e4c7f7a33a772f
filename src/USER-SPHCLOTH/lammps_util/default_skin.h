// SPDX-License-Identifier: GPL-2.0-or-later
// The skin of neighbor lists in a script without the command neighbor.

#ifndef SPHCLOTH_LAMMPS_UTIL_DEFAULT_SKIN_H
#define SPHCLOTH_LAMMPS_UTIL_DEFAULT_SKIN_H

#include <string_view>

namespace LAMMPS_NS {

// That of Update::set_units().  Whether a command gave the same number cannot be told.

inline double default_skin(std::string_view units)
{
  if (units == "lj") return 0.3;
  if (units == "si") return 0.001;
  if (units == "cgs" || units == "micro" || units == "nano") return 0.1;
  return 2.0;    // real, metal, electron
}

}    // namespace LAMMPS_NS

#endif
