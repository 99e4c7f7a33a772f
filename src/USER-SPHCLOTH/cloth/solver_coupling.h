// SPDX-License-Identifier: GPL-2.0-or-later
// What meets a cloth while it is solved: fix pbd/cloth calls it between the sweeps over its own
// constraints, so that both are met together.  Owned vertices are those of the fix, in its order.

#ifndef SPHCLOTH_CLOTH_SOLVER_COUPLING_H
#define SPHCLOTH_CLOTH_SOLVER_COUPLING_H

#include "core/pbd/cloth_solver.h"

#include <Eigen/Core>

namespace LAMMPS_NS {

class SolverCoupling {
 public:
  // From where the vertices start, and where they would go without constraints, in a step of dt.
  // Collective; false on all ranks: nothing is near, and the rest is not called.
  virtual bool begin_step(const sphcloth::Vertex *start, const sphcloth::Vertex *end,
                          double dt) = 0;
  virtual void begin_substep(const sphcloth::Vertex *start, const sphcloth::Vertex *v,
                             double dt) = 0;
  virtual void
  project(sphcloth::Vertex *displacement) = 0;    // since that start, of owned vertices: changes it
  virtual void end_substep(sphcloth::Vertex *v, double dt) = 0;    // changes velocities
  virtual void end_step() = 0;

  // what an owned vertex got in this step, in mass times velocity
  virtual Eigen::Vector3d impulse_on(int slot) const = 0;

 protected:
  ~SolverCoupling() noexcept(false) = default;
};

}    // namespace LAMMPS_NS

#endif
