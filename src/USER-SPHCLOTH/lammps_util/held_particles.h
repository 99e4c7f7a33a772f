// SPDX-License-Identifier: GPL-2.0-or-later
// Fixes that replace forces hold particles: what moves particles beside forces must let them be.

#ifndef SPHCLOTH_LAMMPS_UTIL_HELD_PARTICLES_H
#define SPHCLOTH_LAMMPS_UTIL_HELD_PARTICLES_H

#include "fix.h"
#include "modify.h"
#include "utils.h"

#include <algorithm>

namespace LAMMPS_NS {

class HeldParticles {
 public:
  void begin_run(Modify *modify)
  {
    const auto &fixes = modify->get_fix_list();
    there_may_be = std::any_of(fixes.begin(), fixes.end(), [](const Fix *fix) {
      return utils::strmatch(fix->style, "^setforce") || utils::strmatch(fix->style, "^freeze");
    });
  }
  bool any() const { return there_may_be; }
  // along one axis, by all forces of the last step: nothing else is 0 to the last bit
  bool is_held(double force) const { return there_may_be && force == 0.0; }

 private:
  bool there_may_be = false;
};

}    // namespace LAMMPS_NS

#endif
