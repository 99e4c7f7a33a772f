// SPDX-License-Identifier: GPL-2.0-or-later
// Velocities that the user gives to pinned vertices: numbers, or equal- or atom-style variables.

#ifndef SPHCLOTH_CLOTH_PIN_MOTION_H
#define SPHCLOTH_CLOTH_PIN_MOTION_H

#include "atom.h"
#include "input.h"
#include "lammps_util/arg_reader.h"
#include "variable.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class PinMotion : protected Pointers {
 public:
  PinMotion(LAMMPS *lmp_, std::string owner_) : Pointers(lmp_), owner(std::move(owner_)) {}

  void read(ArgReader &args)
  {
    for (Axis &axis : axes) {
      if (args.more() && utils::strmatch(args.peek(), "^v_")) {
        axis.text = args.word("velocity").substr(2);
        find(axis);
      } else
        axis.value = args.number("velocity of the pins");
    }
    moves = true;
  }

  explicit operator bool() const { return moves; }

  // collective, once a step
  void evaluate(int igroup)
  {
    for (Axis &axis : axes) {
      if (axis.text.empty()) continue;
      find(axis);
      Variable *variables = input->variable;
      if (variables->equalstyle(axis.index)) {
        axis.value = variables->compute_equal(axis.index);
        continue;
      }
      axis.by_atom.resize(atom->nmax);
      variables->compute_atom(axis.index, igroup, axis.by_atom.data(), 1, 0);
    }
  }
  double velocity(int atom_index, int d) const
  {
    return axes[d].by_atom.empty() ? axes[d].value : axes[d].by_atom[atom_index];
  }

 private:
  std::string owner;
  struct Axis {
    std::string text;    // name of the variable, or empty
    int index = -1;
    double value = 0.0;
    std::vector<double> by_atom;
  };
  std::array<Axis, 3> axes;
  bool moves = false;

  void find(Axis &axis)
  {
    axis.index = input->variable->find(axis.text.c_str());
    if (axis.index < 0)
      error->all(FLERR, "{}: velocity is 'v_{}': define that variable before", owner, axis.text);
    if (!input->variable->equalstyle(axis.index) && !input->variable->atomstyle(axis.index))
      error->all(FLERR, "{}: velocity is 'v_{}': make it an equal- or atom-style variable", owner,
                 axis.text);
  }
};

}    // namespace LAMMPS_NS

#endif
