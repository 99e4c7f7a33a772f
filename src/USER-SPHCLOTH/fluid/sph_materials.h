// SPDX-License-Identifier: GPL-2.0-or-later
// Options of pair_style sph/tait and coefficients of its types, and what follows from them for a
// pair.

#ifndef SPHCLOTH_FLUID_SPH_MATERIALS_H
#define SPHCLOTH_FLUID_SPH_MATERIALS_H

#include "pointers.h"

#include "core/sph/fluid.h"
#include "core/sph/plane_wall.h"
#include "core/sph/sound_target.h"
#include "core/sph/wall_impact.h"
#include "core/timestep/free_flight.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;

class SPHMaterials : protected Pointers {
 public:
  SPHMaterials(class LAMMPS *lmp_) : Pointers(lmp_) {}

  // by summation, from its rate, or by a summation that is right for a lattice
  enum class Density : int { SUMMATION, CONTINUITY, CALIBRATED };

  struct Options {    // of pair_style, plain for the restart file
    sphcloth::KernelName kernel = sphcloth::KernelName::WENDLAND_C2;
    sphcloth::Precision precision = sphcloth::Precision::DOUBLE;
    double support = 0.0;
    int tension = 0;    // 1: negative pressure acts, 0: it counts as zero
    Density density = Density::SUMMATION;
    double delta = 0.1;    // diffusion of the density in its rate
    int reinit = 0;    // steps between re-initializations of that density, 0: never
    int surface = 0;    // 1: the sum is completed at free surfaces
  } options;
  void read_options(int narg, char **arg);
  bool integrates_density() const { return options.density == Density::CONTINUITY; }
  bool diffuses() const { return integrates_density() && options.delta > 0.0; }
  bool completes_surfaces() const { return options.surface; }
  bool calibrates() const { return options.density == Density::CALIBRATED; }

  // of a boundary: none of its own; as much as each fluid particle; the mean of the fluid around it
  enum class Pressure : int { OWN, MIRROR, EXTRAPOLATE };

  struct TypeData {
    sphcloth::Role role = sphcloth::Role::NONE;
    sphcloth::Tait eos;    // as it is now
    sphcloth::SoundBounds sound;    // within which eos.k follows the flow
    double sound_unchanged_for = 0.0;    // a time
    double nu = 0.0, alpha = 0.0;
    double floor = 1.0;    // share of alpha that is left where the flow shears; 1: all
    double volume = 0.0;    // of a boundary particle; 0: from the particles around it
    Pressure pressure = Pressure::EXTRAPOLATE;
    double spacing = 0.0;    // of the lattice whose mass a fluid has; 0: 'mass' says it
    double lattice_mass = 0.0;    // and that mass, once it is set
  };

  // no type has a role
  void allocate();

  // pair_coeff I I fluid|boundary|none ... or pair_coeff I J ...; marks what is set
  void read(int narg, char **arg, int **setflag);

  const TypeData &type(int i) const { return types[i]; }
  bool is_fluid(int i) const { return types[i].role == sphcloth::Role::FLUID; }
  bool is_boundary(int i) const { return types[i].role == sphcloth::Role::BOUNDARY; }
  // in messages
  const char *kind(int i) const
  {
    return is_fluid(i)   ? "a fluid type"
        : is_boundary(i) ? "a boundary type"
                         : "a type of the role none";
  }
  const sphcloth::Tait &equation_of_state(int i) const { return types[i].eos; }
  bool sound_follows() const;    // that of any fluid
  bool switches_viscosity() const    // that of any fluid
  {
    return std::any_of(types.begin(), types.end(), [](const TypeData &t) { return t.floor < 1.0; });
  }
  // is the volume of its particles that which they share among themselves?
  bool is_measured(int i) const { return is_boundary(i) && !(types[i].volume > 0.0); }
  bool extrapolates(int i) const
  {
    return is_boundary(i) && types[i].pressure == Pressure::EXTRAPOLATE;
  }
  double support(int i) const { return support(i, i); }
  double support(int i, int j) const
  {
    return supports.empty() ? find_support(i, j) : supports[i * types.size() + j];
  }
  // kinematic viscosity, laminar and artificial together: of a pair; and of a fluid, the largest of
  // its own and of those given for its pairs
  double viscosity(int i, int j) const;
  double viscosity(int i) const { return viscosities.empty() ? find_viscosity(i) : viscosities[i]; }
  // the pressure of a fluid on a boundary over its own, if the pair has a stiffness; and the
  // largest of a fluid, at least 1
  double pressure_factor(int fluid, int boundary) const;
  double largest_pressure_factor(int fluid) const;
  // both until the next read()
  void cache_pair_values();
  void forget_pair_values();
  // noise follows the speed of sound
  sphcloth::ViscositySwitch viscosity_switch(int i) const
  {
    const TypeData &its = types[i];
    const double smoothing = 0.5 * support(i);
    return {its.floor, sphcloth::ViscositySwitch::NOISE * its.eos.sound_speed() / smoothing};
  }
  // By how much the density of a fluid may be above that at rest though nothing compresses it: a
  // sum of rounded terms, in another order on another rank, with a margin of 10 or more
  double density_rounding(int i) const
  {
    return (options.precision == sphcloth::Precision::DOUBLE ? 1e-9 : 1e-6) * types[i].eos.rho0;
  }
  // up to which it is in free flight, but for rounding: none where there may be tension
  double flight_density(int i) const
  {
    return options.tension ? -std::numeric_limits<double>::infinity() : types[i].eos.rho0;
  }
  // Of a fluid of this density, 0 where it is under pressure or may be under tension: how much
  // denser it becomes in free flight before it is.
  double gap_to_pressure(int i, double rho) const
  {
    const double rest = flight_density(i), rounding = density_rounding(i);
    const bool free = sphcloth::flies(rho, rest, rounding);
    return free ? sphcloth::gap_to_pressure(rho, rest, rounding) : 0.0;
  }
  void set_lattice_mass(int i, double mass) { types[i].lattice_mass = mass; }
  void set_stiffness(int i, double k, double unchanged_for)
  {
    types[i].eos.k = k;
    types[i].sound_unchanged_for = unchanged_for;
  }
  // what acts and what is stored, per mass, at a density: nothing below rest without tension
  double acting_pressure(const sphcloth::Tait &, double rho) const;
  double stored_energy(const sphcloth::Tait &, double rho) const;
  // what a plane wall adds to the density
  sphcloth::WallTable wall_table() const;
  // how artificial viscosity slows what approaches it
  sphcloth::WallImpact wall_impact() const;
  double nu(int i, int j) const;
  double alpha(int i, int j) const;
  // the terms of a pair of types, with the kernel's scale
  sphcloth::PairTerms mix(int i, int j) const;
  // up to where i lists j, without the skin; 0: never
  double reach(int i, int j) const;

  void write_options(FILE *) const;
  void read_options(FILE *);
  void write_restart(FILE *) const;
  void read_restart(FILE *);
  // the words of pair_coeff I I, or of I J with what follows from mixing; without what the flow
  // changes, or with it
  std::string words(int i, int j, bool state = false) const;

 private:
  struct PairData {    // < 0: not given
    double support = -1.0, nu = -1.0, alpha = -1.0, stiffness = -1.0;
  };

  std::vector<TypeData> types;
  std::vector<PairData> pairs;    // (ntypes+1)^2, I <= J

  std::vector<double> supports, viscosities;    // empty unless cached

  double find_support(int i, int j) const;
  double find_viscosity(int i) const;
  double sound(int i, int j) const;    // mean of two fluids, or that of the only one
  const PairData &given(int i, int j) const;
  // the fluid of a pair: its own, or the partner's of a boundary
  const TypeData &fluid_of(int i, int j) const { return types[is_fluid(i) ? i : j]; }
  TypeData read_fluid(ArgReader &, PairData &) const;
  TypeData read_boundary(ArgReader &) const;
  PairData read_pair(ArgReader &) const;
  double read_stiffness(ArgReader &, const std::string &) const;
};

}    // namespace LAMMPS_NS

#endif
