// pair_style sph/tait: weakly compressible SPH, equations (1) to (3), with boundary particles.

#ifdef PAIR_CLASS
// clang-format off
PairStyle(sph/tait,PairSPHTait);
// clang-format on
#else

#ifndef LMP_PAIR_SPH_TAIT_H
#define LMP_PAIR_SPH_TAIT_H

#include "pair.h"

#include "core/sph_loops.h"
#include "core/tait.h"
#include "core/wall.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;
class FixWallSPH;

class PairSPHTait : public Pair {
 public:
  PairSPHTait(class LAMMPS *);
  ~PairSPHTait() override;

  void compute(int, int) override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_restart_settings(FILE *) override;
  void read_restart_settings(FILE *) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  double memory_usage() override;

  // what the stepping and the source need to know of a type

  bool is_fluid(int itype) const { return types[itype].role == Role::FLUID; }
  const sphcloth::Tait &equation_of_state(int itype) const { return types[itype].eos; }
  double support(int itype) const;
  double viscosity(int itype) const;    // laminar and artificial together
  double laminar_viscosity(int itype) const { return types[itype].nu; }

  // what a plane wall adds to the density, for the kernel in use
  sphcloth::WallTable wall_table() const;

  // number density of a square or cubic lattice of this type, by summation (1)
  double lattice_sum(int itype, double spacing) const;

  // A boundary particle that fluid touched in the last evaluation: the mass that fluid in its
  // volume would have, and the sound speed of that fluid.  Both 0 if it is dry.
  struct Wetting {
    double fluid_mass = 0.0, sound = 0.0;
  };
  Wetting wetting(int boundary_atom) const;

  // per-atom pressure over density squared, owned and ghost, of the last evaluation
  const double *pressure_term() const { return pressure.data(); }

  // Column of a per-atom array that is 0 for a particle whose density and forces need no update;
  // without an array all are active.
  void set_active(double **array, int column)
  {
    active = array;
    active_column = column;
  }

 private:
  enum class Role : int { NONE, FLUID, BOUNDARY };
  enum class Kernel : int { WENDLAND_C2, CUBIC };
  enum class Stage { AMOUNT, DENSITY };

  struct TypeData {
    Role role = Role::NONE;
    sphcloth::Tait eos;
    double nu = 0.0, alpha = 0.0;
    double volume = 0.0;    // of a boundary particle; 0: from the particles around it
  };
  struct PairData {    // what the user said of a pair of types; < 0: not said
    double support = -1.0, nu = -1.0, alpha = -1.0, stiffness = -1.0;
  };

  Kernel kernel;
  double support_global;
  int keep_tension;    // 1: negative pressure acts, 0: it counts as zero
  std::vector<TypeData> types;
  std::vector<PairData> pairs;                  // (ntypes+1)^2
  std::vector<sphcloth::PairTerms> terms;       // (ntypes+1)^2, of the run
  bool viscous, several_fluids, several_roles, measure_volume;
  std::vector<double> support_sq;    // (ntypes+1)^2
  std::vector<char> fluid_type;      // 1 for a type of fluid

  // scratch, kept from step to step
  FixWallSPH *walls;    // null without plane walls
  double **active;
  int active_column;
  int single_fluid;                        // the type of all fluid, unless several_fluids
  std::vector<int> fluid, boundary;    // owned particles by role, since the last list build
  sphcloth::AlignedVector<int> near;    // neighbours inside the support, stretch per particle
  std::vector<std::int64_t> near_start;    // by local index
  std::vector<int> near_fluid, near_boundary;
  std::vector<std::pair<int, double>> behind;    // boundary neighbours of one particle
  sphcloth::AlignedVector<double> near_rsq;    // of one particle
  sphcloth::AlignedVector<double> amount, pressure;    // per atom, owned and ghost
  Stage stage;

  using ComputeFn = void (PairSPHTait::*)();
  ComputeFn densities_fn, forces_fn, virial_fn, volumes_fn;

  void allocate();
  TypeData read_fluid(ArgReader &, PairData &) const;
  TypeData read_boundary(ArgReader &) const;
  PairData read_pair(ArgReader &) const;
  double read_stiffness(ArgReader &, const std::string &) const;
  void store_fluid_and_boundary(int, int, int, int, const TypeData &, const PairData &);
  void mix(int, int, sphcloth::PairTerms &) const;
  double pair_support(int, int) const;
  template <class K> void bind_kernel();
  template <class K> double kernel_lattice_sum(double, double) const;

  bool is_active(int i) const { return !active || active[i][active_column] != 0.0; }
  sphcloth::ParticleView view() const;
  sphcloth::Neighbourhood neighbourhood(int) const;
  const sphcloth::PairTerms *fluid_terms(const sphcloth::PairTerms *row) const
  {
    return several_fluids ? row : row + single_fluid;
  }

  void sort_by_role();
  void gather_near(int, bool, bool);
  template <class K> void volumes();
  template <class K> void densities();
  void add_wall_densities();
  void equation_of_state_all();
  template <class K> void forces();
  void add_wall_forces();
  template <class K> void tally_virial();
  template <class K, bool VISCOUS, bool VIRIAL> sphcloth::Acceleration on_fluid(int) const;
  template <class K, bool VISCOUS, bool VIRIAL> sphcloth::Acceleration on_boundary(int) const;
  void add_force(int, const sphcloth::Acceleration &);
  void add_virial(int, const sphcloth::Acceleration &);
  void tally_energy();
};

}    // namespace LAMMPS_NS

#endif
#endif
