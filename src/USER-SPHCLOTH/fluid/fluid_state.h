// SPDX-License-Identifier: GPL-2.0-or-later
// The fluid of pair_style sph/tait on one rank: arrays, lists and the active particles, written by
// FluidEvaluation, and what fixes, computes and stepping schemes ask of the last evaluation.

#ifndef SPHCLOTH_FLUID_FLUID_STATE_H
#define SPHCLOTH_FLUID_FLUID_STATE_H

#include "atom.h"
#include "fluid/fluid_boundary.h"
#include "fluid/fluid_lattices.h"
#include "fluid/fluid_stability.h"
#include "fluid/free_surface.h"
#include "fluid/integrated_density.h"
#include "fluid/scaled_mass.h"
#include "fluid/sph_materials.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

namespace LAMMPS_NS {

class Force;
class Pair;
class SideSource;
class StepHooks;

class FluidState : public SPHMaterials {
 public:
  // name of extract() of the pair style
  static constexpr const char *EXTRACT = "fluid_state";

  FluidState(class LAMMPS *lmp_, Pair *pair_, GhostExchange &ghosts_) :
      SPHMaterials(lmp_), lattices(lmp_, *this), ghosts(ghosts_),
      stability(lmp_, *this, lattices, surface), scaled(lmp_, ghosts_),
      integrated(lmp_, *this, ghosts_), surface(lmp_, *this), pair(pair_)
  {
  }
  FluidLattices lattices;

  // of the pair style in use; null if it is not sph/tait
  static FluidState *find(Force *);

  // is this the pair style of the run, without others beside it?
  bool is_of(const Pair *style) const { return style == pair; }
  // has pair_coeff given the type a role?
  bool has_role(int itype) const;
  // are the owned atoms those of the last evaluation?  All that follows needs it.
  bool evaluated() const;
  // one that is no fluid and has atoms in the group, on any rank; 0: none; collective
  int foreign_type_in(int groupbit) const;

  // Of owned atoms, or of all atoms where it says so

  // mass of fluid, volume of a boundary particle
  double mass_or_volume_of(int i) const { return mass_or_volume[i]; }
  // of all atoms
  double volume(int i) const
  {
    return is_fluid(atom->type[i]) ? mass_or_volume[i] / atom->rho[i] : mass_or_volume[i];
  }
  double pressure_of(int i) const;
  // pressure over density squared, of all atoms
  const double *p_over_rho2_of_all() const { return p_over_rho2.data(); }
  // is an owned fluid particle without pressure?
  bool is_in_flight(int i) const { return gap_to_pressure(atom->type[i], atom->rho[i]) > 0.0; }
  // its maximum among the neighbors inside the support, at least 0
  double p_over_rho2_beside(int i);

  // Neighbors inside the support, and some a little outside: how many of these depends on the
  // ranks.
  sphcloth::NeighborSpan neighbors(int i, int type) { return core->neighbors(i, type); }
  bool inside_support(int i, int j) const;
  // of all types that interact with it, inside the support
  int count_neighbors(int i);
  sphcloth::DualLists &order() { return core->order(); }

  // Outputs that are to be wanted in init(): d rho/dt in atom->drho; the maximum speed at which a
  // neighbor or a boundary and an owned fluid particle approached when it was active last; the
  // fluid that moves with a vertex or a boundary particle
  void want_density_rate();
  void want_approach() { core->model.outputs = sphcloth::Outputs::RATE_AND_APPROACH; }
  void want_wetting() const;
  // the fastest motions that fluid, and vertices of this mobility, can make; and that less moves
  // together where neighbors are in free flight
  void want_frequencies(const VertexMobility *vertices) { stability.want(vertices); }
  void want_shares_under_pressure(bool whether) { stability.want_shares(whether); }
  void want_frequencies_now(bool whether) { stability.want_now(whether); }
  const Frequencies &frequencies(int i) const { return stability[i]; }
  void set_frequencies(int i, const Frequencies &before) { stability.set(i, before); }
  // is a vertex near an active particle, which may press on it?
  bool is_near_vertices(int i)
  {
    return stability.is_near_vertices(*core, particles(), boundaries, i);
  }
  ScaledMass &scaled_mass() { return scaled; }
  double approach_speed(int i);
  Wetting wetting(int i);
  // the rates of a type of fluid, of this viscosity at the boundary
  Wetting wetting_by(int fluid_type, double nu) const;

  // of this rank, since it was asked last
  double take_pair_evaluations() { return core->take_pair_evaluations(); }

  bool feels_moving_wall(int i) const;
  bool is_beside_mesh(int i) const;
  // of a force on owned atom i; `from` points to i from where its partner is
  void add_virial(int i, const Eigen::Vector3d &from, const Eigen::Vector3d &force_on_it);

  // Column of a per-atom array that is 0 for a particle whose density and forces need no update;
  // without an array all are active.  Densities of inactive particles may be interpolated by a fix;
  // their pressures then follow.
  void set_active(double **array, int column, bool interpolated = false);
  // owned fluid particles that are updated in this evaluation, with step hooks only
  const std::vector<int> &active_particles() const { return active_fluid; }
  // time that has passed since the last evaluation, for a density that follows its rate
  void advance(double dt) { integrated.advance(dt); }

  // The square of the speed of sound of a fluid, from the next evaluation on
  void change_stiffness(int type, double k);

  // Time steps of individual particles, anew for each run.  Null: forces act for the step of all.
  void set_step_hooks(StepHooks *of_scheme) { hooks = of_scheme; }
  // What the hooks call once the forces on the active fluid are known: FluidBoundary::push_more(),
  // prolong() and defer() of all boundaries; the forces on boundary particles, if all steps are
  // equal; otherwise impulses by source.
  void push_walls_more(int i, double p_over_rho2_of_i, double times);
  void prolong_walls(double times);
  void hand_over_pushes(const FluidBoundary::Take &take);
  void push_boundaries() { core->forces(particles(), sphcloth::Target::BOUNDARIES); }
  void give_impulses(const sphcloth::Impulses &of) { core->impulses(particles(), of); }
  // the only particles that may have got some; null: any
  const std::vector<int> *touched_particles() const { return core->touched(); }
  // the forces that particles exert on the active fluid, alone
  void find_pair_forces(std::vector<double> &forces);

 protected:
  GhostExchange &ghosts;
  FluidStability stability;
  ScaledMass scaled;
  IntegratedDensity integrated;
  FreeSurface surface;
  Pair *const pair;
  std::unique_ptr<sphcloth::Fluid> core;
  std::vector<FluidBoundary *> boundaries, renormalizing;    // all; the last of them
  SideSource *sides = nullptr;    // fluid on two of them does not interact; null without sheets
  StepHooks *hooks = nullptr;
  bool is_evaluated = false;
  std::uint64_t evaluated_order = 0;    // of the owned atoms in the arrays

  double **active = nullptr;
  int active_column = 0;
  bool pressures_follow = false;
  std::vector<int> active_fluid;    // in the order of the lists

  std::vector<double> mass_or_volume, p_over_rho2;    // of all atoms
  std::vector<double> approach;    // empty unless wanted
  std::vector<double> viscosity_shares;    // of all atoms, empty unless it is switched

  sphcloth::Particles particles();
  // of a pair of types in the loops
  const sphcloth::PairTerms &set_terms(int i, int j);
};

}    // namespace LAMMPS_NS

#endif
