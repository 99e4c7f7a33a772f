// SPDX-License-Identifier: GPL-2.0-or-later
// One evaluation of the fluid, phase by phase, as pair_style sph/tait drives it: volumes of
// boundary particles, densities, pressures, forces.  Fixes and computes see its base, the results.

#ifndef SPHCLOTH_FLUID_FLUID_EVALUATION_H
#define SPHCLOTH_FLUID_FLUID_EVALUATION_H

#include "fluid/fluid_state.h"
#include "fluid/measured_positions.h"
#include "lammps_util/list_guard.h"

#include <vector>

namespace LAMMPS_NS {

class FluidEvaluation : public FluidState {
 public:
  FluidEvaluation(class LAMMPS *lmp_, Pair *pair_, GhostExchange &ghosts_) :
      FluidState(lmp_, pair_, ghosts_), lists_of_atoms(lmp_)
  {
  }

  // before a run: other settings, then all types, then each pair of types with the reach of its
  // lists
  void forget();    // lists, kernel and materials
  void begin_run();
  void set_pair(int i, int j, double listed);

  // an evaluation, in this order
  void begin(bool new_neighbors);    // lists and volumes
  void find_densities_and_pressures();
  void find_forces();    // of pairs of particles and of boundaries
  // of the forces of pairs of particles on all particles, also on inactive ones
  void find_virials(sphcloth::Fluid::Receiver receive, void *context);
  void end();    // impulses, and what boundaries pass on

  static constexpr int LARGEST_GHOST_SIZE = FluidStability::GHOST_SIZE;
  static int ghost_size(GhostData);
  int pack(GhostData, int n, const int *list, double *buf) const;
  void unpack(GhostData, int n, int first, const double *buf);
  // from ghosts back to their owners
  int pack_reverse(GhostData, int n, int first, double *buf) const;
  void add(GhostData, int n, const int *list, const double *buf);

  double bytes() const;

 private:
  std::vector<double> list_reach;    // of pairs of types, (ntypes+1)^2, 0: never
  bool new_lists = false;    // in this evaluation
  ListGuard lists_of_atoms;
  // on any rank, at the last list build: boundary particles whose volume is measured, those whose
  // pressure is the fluid's, fluid
  bool measure_volume = false, extrapolate = false, any_fluid = true;
  std::vector<int> moved, moved_here;    // types of which a particle moves, on any rank and here
  MeasuredPositions measured;

  void find_sides();
  double *pack(GhostData, int i, double *buf) const;    // of one atom; returns the end
  void begin_lists();    // new atoms: masses, and arrays as large
  void update_lists(const sphcloth::Particles &);
  sphcloth::Motion usual_motion(const sphcloth::Particles &) const;
  sphcloth::Fluid::Box box() const;
  void select(const sphcloth::Particles &);
  void measure_volumes(const sphcloth::Particles &);
  void find_equal_masses(const sphcloth::Particles &);
  void find_densities(const sphcloth::Particles &);
  void find_pressures(const sphcloth::Particles &);
  void push(FluidBoundary &);
  void find_boundary_pressures(const sphcloth::Particles &);
  void find_viscosity_shares(const sphcloth::Particles &);
  void find_frequencies();
};

}    // namespace LAMMPS_NS

#endif
