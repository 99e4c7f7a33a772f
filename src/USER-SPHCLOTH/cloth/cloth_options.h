// SPDX-License-Identifier: GPL-2.0-or-later
// What the arguments of fix pbd/cloth say.

#ifndef SPHCLOTH_CLOTH_CLOTH_OPTIONS_H
#define SPHCLOTH_CLOTH_CLOTH_OPTIONS_H

#include "cloth/pin_motion.h"
#include "cloth/substepping.h"
#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

class ClothOptions : protected Pointers {
 public:
  Substepping::Options solving;
  double reference = 0.0;    // step for which k holds, 0: not given
  int pin_group = 0, pinbit = 0;    // bit 0: nothing is pinned
  // vertices that another fix integrates, with the pull of the cloth on them
  int attach_group = 0, attachbit = 0;
  PinMotion pin_motion;
  std::string rest_property;    // with the rest positions; empty: they are where vertices are now

  ClothOptions(LAMMPS *lmp_, const std::string &owner_, int igroup_) :
      Pointers(lmp_), pin_motion(lmp_, owner_), owner(owner_), igroup(igroup_)
  {
  }
  void read(ArgReader &);
  void check_groups() const;    // before each run, as a group may have become dynamic
  int heldbits() const { return pinbit | attachbit; }

 private:
  const std::string owner;
  const int igroup;
  bool solver_given = false, iterations_given = false, strain_given = false;

  void read_held(ArgReader &, const std::string &keyword, int &held, int &bit);
  void check(ArgReader &);
};

}    // namespace LAMMPS_NS

#endif
