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
#include "pointers.h"

#include <limits>
#include <vector>

namespace LAMMPS_NS {

// what the step of a cloth depends on

struct StepInfo {
  double dt = 0.0;
  bool powers_of_two = false;    // steps go to and fro between them
};

// GAUSS_SEIDEL: a projection sees all before it.  JACOBI: it sees none of its own sweep, and the
// share that it may move is one over the number of constraints at its vertices.  SUBSTEPS: as many
// small steps as there are iterations, each with one sweep.

enum class ClothSolver { GAUSS_SEIDEL, JACOBI, SUBSTEPS };

class Substepping : protected Pointers {
 public:
  struct Options {
    ClothSolver solver = ClothSolver::SUBSTEPS;
    int iterations = 10;
    bool symmetric_sweeps = false;    // forward through the constraints, then backward
    bool from_start =
        true;    // edges are projected along their directions at the start of the step
    double tolerance = 0.0;    // of the residual, 0: all iterations are done
    double damping = 0.0;      // rate at which stretching motion decays, 1/time
  };

  Substepping(LAMMPS *lmp_, const Options &options_, ClothConstraints &constraints_,
              ClothVertices &vertices_) :
      Pointers(lmp_), options(options_), constraints(constraints_), vertices(vertices_)
  {
  }

  bool uses(ClothSolver one) const { return options.solver == one; }
  int usual_substeps() const { return uses(ClothSolver::SUBSTEPS) ? options.iterations : 1; }

  // cuts the next step into substeps, with what meets the cloth in it; forces of the holders are
  // summed where they are wanted
  void begin_step(const StepInfo &, const std::vector<SolverCoupling *> &, HolderForces &);
  int substeps() const { return n_substeps; }
  const std::vector<SolverCoupling *> &present() const { return *couplings; }
  double substep_dt() const { return step_dt / n_substeps; }

  // Substep n of several cloths from vertices.start and velocities v, phase by phase: what couples
  // them finds all in the same one.
  static void substep(int n, const std::vector<Substepping *> &cloths);
  void end_step() { started = true; }

  // largest C + a lambda of this rank's constraints, relative to lengths; elastic energy of those
  // that it owns
  double residual() const;
  double energy() const;
  int sweeps_of_last_step() const { return n_substeps * sweeps; }

  struct State {    // of the restart file: plain and without gaps
    double shortest, started;
  };
  State state() const { return {recent_shortest, started ? 1.0 : 0.0}; }
  void set_state(const State &from)
  {
    recent_shortest = from.shortest;
    started = from.started != 0.0;
  }

 private:
  const Options &options;
  ClothConstraints &constraints;
  ClothVertices &vertices;
  const std::vector<SolverCoupling *> *couplings = nullptr;    // of this step
  HolderForces *holders = nullptr;
  // steps: the present one, and the shortest of the recent ones
  double step_dt = 0.0, recent_shortest = std::numeric_limits<double>::infinity();
  int n_substeps = 1;
  int sweeps = 0;    // of the last substep
  bool started = false;    // velocities are those of half a step ago, see direction start

  double inv_dt_sq() const;
  void begin_substep(int n);
  void sweep();
  bool is_done();
  void end_substep();
  void apply_forces(double dt);
  void predict(bool last);
  void set_velocities();
  void damp();
  void gauss_seidel(const sphcloth::ClothState &);
  void project_color(int color, const sphcloth::ClothState &);
  void jacobi(const sphcloth::ClothState &);
  // each substep goes through the constraints once, in one direction
  bool single_sweeps() const { return uses(ClothSolver::SUBSTEPS) && !options.symmetric_sweeps; }
  bool converged() const;
};

}    // namespace LAMMPS_NS

#endif
