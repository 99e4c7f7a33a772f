// pair_style sph/tait: weakly compressible SPH, equations (1) to (3), with boundary particles.

#ifdef PAIR_CLASS
// clang-format off
PairStyle(sph/tait,PairSPHTait);
// clang-format on
#else

#ifndef LMP_PAIR_SPH_TAIT_H
#define LMP_PAIR_SPH_TAIT_H

#include "atom.h"
#include "pair.h"

#include "core/sph/plane_wall.h"
#include "fluid/fluid_boundary.h"
#include "fluid/sph_materials.h"

#include <Eigen/Core>

#include <algorithm>
#include <memory>
#include <vector>

namespace LAMMPS_NS {

class StepHooks;
class FixClothContact;

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
  void write_data(FILE *) override;
  void write_data_all(FILE *) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  double memory_usage() override;

  // what fixes, computes and commands need to know of a type

  bool is_fluid(int itype) const { return materials.is_fluid(itype); }
  bool is_boundary(int itype) const { return materials.is_boundary(itype); }
  const sphcloth::Tait &equation_of_state(int itype) const { return materials.type(itype).eos; }
  double support(int itype) const { return support(itype, itype); }
  double support(int itype, int jtype) const { return materials.support(itype, jtype); }
  // was it said what this type is?
  bool has_role(int itype) const { return allocated && setflag[itype][itype]; }
  // do particles of these types look at each other at all?
  bool interact(int itype, int jtype) const { return materials.reach(itype, jtype) > 0.0; }
  double viscosity(int itype) const { return materials.viscosity(itype); }
  double laminar_viscosity(int itype) const { return materials.type(itype).nu; }
  bool integrates_density() const { return options.continuity; }
  sphcloth::KernelName kernel() const { return options.kernel; }

  // what a plane wall adds to the density, for the kernel in use
  sphcloth::WallTable wall_table() const;
  // what acts and what is stored, per mass, at a density: nothing below rest without tension
  double acting_pressure(const sphcloth::Tait &, double rho) const;
  double stored_energy(const sphcloth::Tait &, double rho) const;

  // number density of a square or cubic lattice of this type, by summation (1)
  double lattice_sum(int itype, double spacing) const;

  // To be wanted in init().  A boundary particle has the mass of fluid in its volume.
  using Wetting = LAMMPS_NS::Wetting;
  void want_wetting() const;
  Wetting wetting(int i);

  // of a force on owned atom i from something that is `apart` behind it
  void add_virial(int i, const Eigen::Vector3d &apart, const Eigen::Vector3d &force_on_it);

  // Are the owned atoms those of the last evaluation?  Only then the following may be asked.
  bool evaluated() const;

  // mass or volume of an owned atom
  double amount_of(int i) const { return amount[i]; }
  double pressure_of(int i) const;
  // of all roles that matter to it, inside the support
  int count_neighbors(int i);

  // per-atom pressure over density squared, owned and ghost, of the last evaluation
  const double *p_over_rho2() const { return pressure.data(); }

  // The largest speed at which a neighbour or a wall and an owned fluid particle came near when it
  // was active last; to be asked for in init()
  void want_approach() { fluid->model.also = sphcloth::Outputs::RATE_AND_APPROACH; }
  double approach_speed(int i);

  // volume of a particle, owned or ghost, in the last evaluation
  double volume(int i) const
  {
    return is_fluid(atom->type[i]) ? amount[i] / atom->rho[i] : amount[i];
  }

  // Particles with steps of their own, anew for each run.  Null: forces act for the step of all.
  void set_step_hooks(StepHooks *of_scheme) { hooks = of_scheme; }
  // What they ask for once the forces on the active fluid are known: to push walls once more, as
  // FluidBoundary::push_more(); the forces on boundaries, if all steps are equal; otherwise the impulses of
  // Fluid::record_impulses() on these owned particles.
  void push_walls_more(int i, double p_over_rho2, double times);
  void prolong_walls(double times);
  // what boundaries have been pushed so far, FluidBoundary::defer()
  void hand_over_pushes(const FluidBoundary::Take &take);
  void push_boundaries() { fluid->forces(particles(), sphcloth::Target::BOUNDARIES); }
  void give_impulses(const std::vector<int> &slots, const double *pressure_time,
                     const double *span);
  sphcloth::DualLists &order() { return fluid->order(); }
  bool feels_moving_wall(int i) const;
  bool is_beside_mesh(int i) const;
  // owned fluid particles that are updated in this evaluation, with block steps
  const std::vector<int> &active_particles() const { return active_fluid; }

  // Neighbours of an owned atom inside the support, and some a little outside: how many of these depends
  // on the ranks.
  sphcloth::NeighborSpan neighbors(int i, int type) { return fluid->neighbors(i, type); }
  bool inside_support(int i, int j) const;
  // the greatest of those inside, at least 0
  double p_over_rho2_beside(int i);

  // Column of a per-atom array that is 0 for a particle whose density and forces need no update;
  // without an array all are active.  Densities of the others may be interpolated by who says so, and
  // their pressures follow.
  void set_active(double **array, int column, bool interpolated = false)
  {
    active = array;
    active_column = column;
    pressures_follow = interpolated;
  }

  // d rho/dt goes to atom->drho with the forces; to be asked for in init()
  void want_density_rate()
  {
    fluid->model.also = std::max(fluid->model.also, sphcloth::Outputs::RATE);
  }

  // Time that has passed since the last evaluation, for a density that follows its rate
  void advance(double dt) { elapsed += dt; }

 private:
  enum class Stage { AMOUNT, DENSITY, GRADIENT };

  struct Options {    // of pair_style, plain for the restart file
    sphcloth::KernelName kernel = sphcloth::KernelName::WENDLAND_C2;
    sphcloth::Precision precision = sphcloth::Precision::DOUBLE;
    double support = 0.0;
    int tension = 0;       // 1: negative pressure acts, 0: it counts as zero
    int continuity = 0;    // 1: density from its rate, 0: by summation
    double delta = 0.1;    // diffusion of the density in the rate
    int reinit = 0;        // steps between re-initialisations of that density, 0: never
  };

  Options options;
  SPHMaterials materials;
  std::unique_ptr<sphcloth::Fluid> fluid;
  std::vector<FluidBoundary *> boundaries;
  FixClothContact *sheets;    // that part the fluid; null without
  StepHooks *hooks;    // of particles with steps of their own, null otherwise
  bool is_evaluated;
  // on any rank, at the last list build: boundary particles whose volume is measured, those whose
  // pressure is the fluid's, fluid
  bool measure_volume, extrapolate, any_fluid;
  std::vector<int> moved, moved_here;    // types of which a particle moves, on any rank and here
  std::vector<double> reach;    // (ntypes+1)^2, 0: never

  // scratch, kept from step to step
  double **active;
  int active_column;
  bool pressures_follow;
  double elapsed;
  std::vector<double> amount, pressure;    // per atom, owned and ghost
  std::vector<double> rate;
  std::vector<double> approach;    // empty unless it is asked for
  std::vector<double> gradient;    // of the density, [n][3], empty unless it diffuses
  std::vector<int> active_fluid;    // in the order of the lists, with block steps only
  std::uint64_t evaluated_order = 0;    // of the owned atoms in the arrays
  Stage stage;

  void allocate();
  void read_density(class ArgReader &);
  void forget_evaluation();
  void set_model();
  void find_sheets();
  bool excluded(int, int) const;
  bool diffuses() const { return options.continuity && options.delta > 0.0; }
  sphcloth::Particles particles();
  sphcloth::Fluid::Box box() const;
  void renew();
  void follow(const sphcloth::Particles &, bool new_neighbors);
  sphcloth::Motion motion(const sphcloth::Particles &) const;
  bool is_measured(int type) const;
  void measure_amounts(const sphcloth::Particles &, bool);
  void select(const sphcloth::Particles &);
  void densities(const sphcloth::Particles &);
  void integrate_density(const sphcloth::Particles &);
  void density_rates(const sphcloth::Particles &, double back);
  void pressures(const sphcloth::Particles &, bool of_all);
  void check_densities() const;
  void boundary_pressures(const sphcloth::Particles &);
  void tally_virial(sphcloth::Particles);
  void tally_energy();
  template <class F> void for_each_fluid(F &&) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
