// SPDX-License-Identifier: GPL-2.0-or-later
// Lattices of the fluids: the mass of a particle, what calibrates the density, and what walls add.

#ifndef SPHCLOTH_FLUID_FLUID_LATTICES_H
#define SPHCLOTH_FLUID_FLUID_LATTICES_H

#include "pointers.h"

#include "core/sph/calibration.h"
#include "core/sph/wall_profile.h"

#include <vector>

namespace LAMMPS_NS {

class SPHMaterials;

class FluidLattices : protected Pointers {
 public:
  FluidLattices(class LAMMPS *lmp_, SPHMaterials &materials_) :
      Pointers(lmp_), materials(materials_)
  {
  }

  // of a particle of a square or cubic lattice whose density is the rest density
  double mass(int type, double spacing) const;
  // gives it to the types with a spacing
  void set_masses();

  // of all types, from their spacings or masses
  void calibrate();
  // from the density sum to the density, and the derivative of that
  double density(int type, double summed) const { return calibrations[type].density(summed); }
  double slope(int type, double rho) const { return calibrations[type].slope(rho); }
  double slope_at_rest() const;    // of the first fluid
  // what a wall adds to the density of each type, with `reflection` times its pressure
  std::vector<sphcloth::WallProfile> wall_profiles(const sphcloth::WallTable &,
                                                   double reflection) const;

 private:
  SPHMaterials &materials;
  std::vector<sphcloth::Calibration> calibrations;

  sphcloth::LatticeSums sums(int type, double spacing) const;
  void check(int type, double spacing) const;
  double spacing(int type) const;    // of the lattice for which it is calibrated
};

}    // namespace LAMMPS_NS

#endif
