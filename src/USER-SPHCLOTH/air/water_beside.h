// SPDX-License-Identifier: GPL-2.0-or-later
// How much water is beside the vertices of a cloth, and on which side.

#ifndef SPHCLOTH_AIR_WATER_BESIDE_H
#define SPHCLOTH_AIR_WATER_BESIDE_H

#include "core/geometry/cell_grid.h"
#include "pointers.h"

#include <Eigen/Core>

#include <vector>

namespace LAMMPS_NS {

class AirMesh;
class FluidState;

class WaterBeside : protected Pointers {
 public:
  explicit WaterBeside(LAMMPS *lmp_) : Pointers(lmp_) {}

  // before each run
  void init();
  bool any() const { return fluid != nullptr; }
  // of owned vertices, where all atoms are now
  void find(AirMesh &);
  double bytes() const;

 private:
  const FluidState *fluid = nullptr;    // null: there is no fluid
  std::vector<double> support;    // of each type; 0: it is no fluid
  double largest = 0.0;    // support
  sphcloth::CellGrid grid;
  std::vector<int> first, vertices;    // of each cell

  void sort(const AirMesh &);
  void add(AirMesh &, int atom_index) const;
};

}    // namespace LAMMPS_NS

#endif
