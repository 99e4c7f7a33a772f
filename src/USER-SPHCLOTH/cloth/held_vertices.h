// SPDX-License-Identifier: GPL-2.0-or-later
// Vertices of a cloth that do not move freely: pins, whose motion is given, and vertices attached
// to bodies that another fix integrates.

#ifndef SPHCLOTH_CLOTH_HELD_VERTICES_H
#define SPHCLOTH_CLOTH_HELD_VERTICES_H

#include "atom.h"
#include "cloth/cloth_options.h"
#include "fix.h"
#include "lammps_util/atom_tools.h"

namespace LAMMPS_NS {

class VertexHalo;

class HeldVertices : protected Pointers {
 public:
  HeldVertices(LAMMPS *lmp_, const Fix *cloth_, ClothOptions &options_) :
      Pointers(lmp_), cloth(cloth_), options(options_)
  {
  }

  bool is_vertex(int i) const { return atom->mask[i] & cloth->groupbit; }
  bool is_pinned(int i) const { return atom->mask[i] & options.pinbit; }
  bool is_attached(int i) const { return atom->mask[i] & options.attachbit; }
  bool is_held(int i) const { return atom->mask[i] & options.heldbits(); }

  // 0 of what the cloth does not move, and of what its solver does not
  double inverse_mass(int i) const { return is_held(i) ? 0.0 : 1.0 / atom_mass(atom, i); }
  double inverse_mass_in_solver(int i) const
  {
    return is_pinned(i) ? 0.0 : 1.0 / atom_mass(atom, i);
  }

  // Before a run: a pin rests, also one that was free before, unless the user gives pins a velocity
  // or another fix moves it.
  void stop_pins();
  // once a step, with the velocity that the user gives them; collective
  void move_pins(const VertexHalo &);

 private:
  const Fix *cloth;
  ClothOptions &options;
};

}    // namespace LAMMPS_NS

#endif
