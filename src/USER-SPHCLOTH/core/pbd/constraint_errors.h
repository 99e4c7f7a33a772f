// SPDX-License-Identifier: GPL-2.0-or-later
// Errors, loads and energies of the constraints of a cloth: what is asked for now and then.

#ifndef SPHCLOTH_CORE_PBD_CONSTRAINT_ERRORS_H
#define SPHCLOTH_CORE_PBD_CONSTRAINT_ERRORS_H

#include <functional>

#include "core/pbd/cloth_solver.h"
#include "core/pbd/solver_softness.h"

namespace sphcloth {

// what the solver adds to the errors of hard constraints with a size, under the multipliers of a
// substep
SolverError solver_error(const Constraints<2> &, const LoadedSolver &);
SolverError solver_error(const Constraints<4> &, const LoadedSolver &);

// Largest C + a lambda, which vanishes in a converged step, of the hard constraints that are not
// slack.  Of lengths it is relative: to the rest length, or to `length` where that is 0.
double residual(const Constraints<2> &, const Vertex *p, double inv_dt_sq, double length);
double residual(const Constraints<4> &, const Vertex *p, double inv_dt_sq);

// lambda grad C on every vertex with w = 0: on(slot, vector), once for each constraint that it is
// in. With `start` edges have the directions that they had there.
using OnHeld = std::function<void(int, const Vec3 &)>;
void for_each_held(const Constraints<2> &, const Vertex *p, const Vertex *start, const OnHeld &on);
void for_each_held(const Constraints<4> &, const Vertex *p, const Vertex *start, const OnHeld &on);

// Of rigid edges that can move, |C| over the size, of those that only pull, where they do
double largest_strain(const Constraints<2> &, const Vertex *p);

// C^2/(2 compliance), summed over the compliant constraints whose first vertex is below n_owned
double elastic_energy(const Constraints<2> &, const Vertex *p, int n_owned);
double elastic_energy(const Constraints<4> &, const Vertex *p, int n_owned);

}    // namespace sphcloth

#endif
