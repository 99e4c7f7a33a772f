// SPDX-License-Identifier: GPL-2.0-or-later
// What fix pbd/cloth takes from atoms and other styles: vertices, rest positions, stiffness.

#ifndef SPHCLOTH_CLOTH_CLOTH_INPUT_H
#define SPHCLOTH_CLOTH_CLOTH_INPUT_H

#include "fix.h"
#include "lammps_util/particle_columns.h"

#include <string>

namespace LAMMPS_NS {

class ClothInput : protected Pointers {
 public:
  ClothInput(LAMMPS *lmp_, const Fix *fix_, const std::string &label_) :
      Pointers(lmp_), fix(fix_), label(label_)
  {
  }

  // into x, y and z, from a per-atom property; an error if it does not exist or is 0 everywhere
  void read_rest_positions(const std::string &property, ParticleColumns &rest_x) const;
  // Vertices belong to no other cloth, no other fix changes their bonds, and all have a mass.  Only
  // per-atom masses may be missing.
  void check_vertices() const;
  void check_styles() const;

 private:
  const Fix *const fix;
  const std::string label;
};

}    // namespace LAMMPS_NS

#endif
