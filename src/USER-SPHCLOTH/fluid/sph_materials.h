// What the user said of the types of pair_style sph/tait, and what follows from it for a pair.

#ifndef SPHCLOTH_FLUID_SPH_MATERIALS_H
#define SPHCLOTH_FLUID_SPH_MATERIALS_H

#include "pointers.h"

#include "core/sph/fluid.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;

class SPHMaterials : protected Pointers {
 public:
  SPHMaterials(class LAMMPS *lmp_) : Pointers(lmp_) {}

  // of a boundary: none of its own; as much as each fluid particle; the mean of the fluid around it
  enum class Pressure : int { OWN, MIRROR, EXTRAPOLATE };

  struct TypeData {
    sphcloth::Role role = sphcloth::Role::NONE;
    sphcloth::Tait eos;
    double nu = 0.0, alpha = 0.0;
    double volume = 0.0;    // of a boundary particle; 0: from the particles around it
    Pressure pressure = Pressure::EXTRAPOLATE;
    double spacing = 0.0;         // of the lattice whose mass a fluid has; 0: 'mass' says it
    double lattice_mass = 0.0;    // and that mass, once it is set
  };

  // forgets everything
  void allocate();

  // pair_coeff I I fluid|boundary|none ... or pair_coeff I J ...; marks what is set
  void read(int narg, char **arg, int **setflag);

  const TypeData &type(int i) const { return types[i]; }
  bool is_fluid(int i) const { return types[i].role == sphcloth::Role::FLUID; }
  bool is_boundary(int i) const { return types[i].role == sphcloth::Role::BOUNDARY; }
  bool extrapolates(int i) const
  {
    return is_boundary(i) && types[i].pressure == Pressure::EXTRAPOLATE;
  }
  double support(int i, int j) const
  {
    return supports.empty() ? find_support(i, j) : supports[i * types.size() + j];
  }
  // laminar and artificial together
  double viscosity(int i) const { return viscosities.empty() ? find_viscosity(i) : viscosities[i]; }
  // keeps both at hand, until something is said anew
  void settle();
  void unsettle();
  // number density of a square or cubic lattice by summation (1)
  double lattice_sum(int i, double spacing, sphcloth::KernelName) const;
  // gives the types with a spacing the mass with which such a lattice has the rest density
  void set_lattice_masses(sphcloth::KernelName);
  double nu(int i, int j) const;
  double alpha(int i, int j) const;
  // one pair, with the kernel's scale
  sphcloth::PairTerms mix(int i, int j, sphcloth::KernelName) const;
  // up to where i lists j, without the skin; 0: never
  double reach(int i, int j) const;

  void write_restart(FILE *) const;
  void read_restart(FILE *);
  // the words of pair_coeff I I, or of I J with what follows from mixing
  std::string words(int i, int j) const;

  double default_support = 0.0;

 private:
  struct PairData {    // < 0: not said
    double support = -1.0, nu = -1.0, alpha = -1.0, stiffness = -1.0;
  };

  std::vector<TypeData> types;
  std::vector<PairData> pairs;    // (ntypes+1)^2, I <= J

  std::vector<double> supports, viscosities;    // empty unless settled

  double find_support(int i, int j) const;
  double find_viscosity(int i) const;
  const PairData &said(int i, int j) const;
  // the fluid of a pair: its own, or the partner's of a boundary
  const TypeData &fluid_of(int i, int j) const { return types[is_fluid(i) ? i : j]; }
  TypeData read_fluid(ArgReader &, PairData &) const;
  TypeData read_boundary(ArgReader &) const;
  PairData read_pair(ArgReader &) const;
  double read_stiffness(ArgReader &, const std::string &) const;
};

}    // namespace LAMMPS_NS

#endif
