// SPDX-License-Identifier: GPL-2.0-or-later
// Velocities that the user gives to pinned vertices: numbers, or equal- or atom-style variables.

#ifndef SPHCLOTH_CLOTH_PIN_MOTION_H
#define SPHCLOTH_CLOTH_PIN_MOTION_H

#include "lammps_util/number_or_variable.h"
#include "pointers.h"

#include <array>
#include <string>

namespace LAMMPS_NS {

class PinMotion : protected Pointers {
 public:
  PinMotion(LAMMPS *lmp_, std::string owner_) : Pointers(lmp_), owner(std::move(owner_)) {}

  void read(ArgReader &args)
  {
    for (NumberOrVariable &along : axes) {
      along.read(args, "velocity");
      along.check(lmp, owner);
    }
    moves = true;
  }

  explicit operator bool() const { return moves; }

  // collective, once a step
  void evaluate(int igroup)
  {
    NumberOrVariable::evaluate(lmp, owner, igroup, {&axes[0], &axes[1], &axes[2]});
  }
  double velocity(int atom_index, int d) const { return axes[d].of(atom_index); }

 private:
  static constexpr auto STYLES = NumberOrVariable::Styles::EQUAL_OR_ATOM;
  std::string owner;
  std::array<NumberOrVariable, 3> axes{NumberOrVariable(STYLES), NumberOrVariable(STYLES),
                                       NumberOrVariable(STYLES)};
  bool moves = false;
};

}    // namespace LAMMPS_NS

#endif
