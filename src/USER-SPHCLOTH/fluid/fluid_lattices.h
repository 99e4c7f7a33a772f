// SPDX-License-Identifier: GPL-2.0-or-later
// Lattices of the fluids: the mass of a particle, what calibrates the density, and what walls add.
// Where the speed of sound has changed, the density of a particle is not that of its position.

#ifndef SPHCLOTH_FLUID_FLUID_LATTICES_H
#define SPHCLOTH_FLUID_FLUID_LATTICES_H

#include "pointers.h"

#include "core/sph/calibration.h"
#include "core/sph/wall_profile.h"

#include <vector>

namespace LAMMPS_NS {

class ParticleColumns;
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
  // By how much owned particles are denser than their positions say, as a share of that, in the
  // first column; null: not at all
  void set_expansion(const ParticleColumns *of) { expansion = of; }
  // does the density differ from the sum?
  bool adapts_density() const;
  // from the density sum of an owned particle to its density, and the derivative of that
  double density(int i, int type, double summed) const;
  double slope(int i, int type, double rho) const;
  // of its position, without what the speed of sound has changed
  double density_of_position(int i, double rho) const { return rho / expanded(i); }
  // of a type, where the speed of sound has not changed
  double slope_of(int type, double rho) const { return calibrations[type].slope(rho); }
  double slope_at_rest() const;    // of the first fluid
  // what a wall adds to the density of each type, with `reflection` times its pressure
  std::vector<sphcloth::WallProfile> wall_profiles(const sphcloth::WallTable &,
                                                   double reflection) const;

 private:
  SPHMaterials &materials;
  std::vector<sphcloth::Calibration> calibrations;
  const ParticleColumns *expansion = nullptr;

  double expanded(int i) const;

  sphcloth::LatticeSums sums(int type, double spacing) const;
  void check(int type, double spacing) const;
  double spacing(int type) const;    // of the lattice for which it is calibrated
};

}    // namespace LAMMPS_NS

#endif
