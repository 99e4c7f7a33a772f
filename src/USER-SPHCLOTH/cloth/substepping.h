// SPDX-License-Identifier: GPL-2.0-or-later
// How a step of a cloth is solved: into how many substeps it is cut, and the sweeps over the
// constraints in each of them, (7) to (9) and lines 19 to 29 of Algorithm 1.
//
// Macklin et al., Small steps in physics simulation, SCA 2019 (substeps with one sweep each).

#ifndef SPHCLOTH_CLOTH_SUBSTEPPING_H
#define SPHCLOTH_CLOTH_SUBSTEPPING_H

#include "cloth/cloth_constraints.h"
#include "cloth/cloth_vertices.h"
#include "cloth/holder_forces.h"
#include "cloth/solver_coupling.h"
#include "core/pbd/constraint_errors.h"
#include "core/pbd/substep_groups.h"
#include "core/pbd/substep_length.h"
#include "lammps_util/replaced_velocities.h"
#include "pointers.h"

#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

// GAUSS_SEIDEL: a projection sees all before it.  JACOBI: it sees none of its own sweep, and the
// share that it may move is one over the number of constraints at its vertices.  SUBSTEPS: as many
// small steps as there are iterations, each with one sweep.

enum class ClothSolver { GAUSS_SEIDEL, JACOBI, SUBSTEPS };

class Substepping : protected Pointers {
 public:
  struct Options {
    ClothSolver solver = ClothSolver::SUBSTEPS;
    int iterations = 10;
    // strain that the solver may add, which says how long a substep may be; 0: there are as many as
    // iterations
    double strain = 0.01;
    bool symmetric_sweeps = false;    // forward through the constraints, then backward
    bool from_start =
        true;    // edges are projected along their directions at the start of the step
    double tolerance = 0.0;    // of the residual, 0: all iterations are done
    double damping = 0.0;    // rate at which stretching motion decays, 1/time
  };

  // owner: the fix, for warnings
  Substepping(LAMMPS *lmp_, std::string owner_, const Options &options_,
              ClothConstraints &constraints_, ClothVertices &vertices_,
              const ReplacedVelocities &velocities_) :
      Pointers(lmp_), owner(std::move(owner_)), options(options_), constraints(constraints_),
      vertices(vertices_), velocities(velocities_)
  {
  }

  bool uses(ClothSolver one) const { return options.solver == one; }
  int usual_substeps() const { return uses(ClothSolver::SUBSTEPS) ? options.iterations : 1; }
  // after each list build: what is soft whatever the load is.  Collective.
  void measure_compliances();
  // how many substeps the next step takes, of dt, under the load of the last one
  int wanted_substeps(double dt);

  // what contact did not pass on in the last step, as a share
  void missed_in_contact(double share);

  // cuts the next step into substeps, with what meets the cloth in it; forces of the holders are
  // summed where they are wanted
  void begin_step(double dt, int substeps, const std::vector<SolverCoupling *> &, HolderForces &);
  int substeps() const { return n_substeps; }
  // for which forces act on a vertex in the step that has begun, over its length
  double part_with_forces(int slot) const;
  const std::vector<SolverCoupling *> &present() const { return *couplings; }
  double substep_dt() const { return step_dt / n_substeps; }

  // Substep n of several cloths from vertices.start and velocities v, phase by phase: what couples
  // them finds all in the same one.
  static void substep(int n, const std::vector<Substepping *> &cloths);
  void end_step();

  // largest C + a lambda of this rank's constraints, relative to lengths; elastic energy of those
  // that it owns
  double residual() const;
  double energy() const;
  // largest strain that the solver adds to this rank's edges under their loads; 0 with whole steps
  double unconverged() const;
  int sweeps_of_last_step() const { return n_substeps * sweeps; }

  struct State {    // of the restart file: plain and without gaps
    sphcloth::SubstepLength::State length;
    double started;
  };
  State state() const { return {length.state, started ? 1.0 : 0.0}; }
  void set_state(const State &from)
  {
    length.state = from.length;
    started = from.started != 0.0;
  }

 private:
  const std::string owner;
  const Options &options;
  ClothConstraints &constraints;
  ClothVertices &vertices;
  const ReplacedVelocities &velocities;
  const std::vector<SolverCoupling *> *couplings = nullptr;    // of this step
  HolderForces *holders = nullptr;
  double step_dt = 0.0;
  int n_substeps = 1;
  int sweeps = 0;    // of the last substep
  sphcloth::SubstepLength length;
  double longest_of_hinges = 0.0;    // time that one projection may stand for
  double longest_without_size = 0.0;    // substep that edges without a size bear
  sphcloth::SubstepGroups hinge_groups, damping_groups;
  int hinges_for = 1;    // so many substeps are hinges projected in this one; 0: not at all
  bool warned = false;
  int steps_missed = 0;    // in which contact missed much, since it last missed little
  bool started = false;    // `length` follows from steps

  double inv_dt_sq(double substeps = 1.0) const;
  void begin_substep(int n);
  void sweep();
  bool is_done();
  void end_substep();
  double first_kick(int slot) const;
  void apply_forces(double dtf, bool first);
  void predict(bool last);
  void set_velocities();
  void damp(int substeps);
  void gauss_seidel(const sphcloth::ClothState &);
  void project_color(int color, const sphcloth::ClothState &);
  void jacobi(const sphcloth::ClothState &);
  // each substep goes through the constraints once, in one direction
  bool single_sweeps() const { return uses(ClothSolver::SUBSTEPS) && !options.symmetric_sweeps; }
  bool follows_load() const { return uses(ClothSolver::SUBSTEPS) && options.strain > 0.0; }
  // an edge takes all where the user says how many substeps there are
  double max_edge_share() const
  {
    return single_sweeps() && follows_load() ? sphcloth::STABLE_EDGE_SHARE : 1.0;
  }
  double max_hinge_share() const { return single_sweeps() ? sphcloth::STABLE_HINGE_SHARE : 1.0; }
  bool converged() const;
  void warn(const std::string &of);
  template <std::size_t N>
  sphcloth::SolverError error_of(const sphcloth::Constraints<N> &, double allowed, double share,
                                 int substeps) const;
  double longest_sq() const;
  // of a rigid constraint over W L^2, where no load hardens it
  static double softest(double share) { return 1.0 / share - sphcloth::SINGLE_SWEEP_SOFTNESS; }
  double strain_at_start() const;
  double allowed_strain() const { return options.strain * length.yield(); }
  // of a compliance, what the solver may add to that of an edge without a size
  double share_without_size() const { return sphcloth::SHARE_WITHOUT_SIZE * options.strain; }
};

}    // namespace LAMMPS_NS

#endif
