// SPDX-License-Identifier: GPL-2.0-or-later
// How long the substeps of a cloth are, and how soft its solver.
//
// What a single sweep leaves of the error of a constraint is that of a spring of the stiffness
// m/h^2, h the substep (Macklin et al., SCA 2019).  So a strain that the solver may add, and the
// load, say how long a substep may be.  If the stiffness followed h at once, it would feed what is
// stretched: the solver stays as soft as in substeps of a `length` that varies slowly, and the
// present ones are never longer.

#ifndef SPHCLOTH_CORE_PBD_SUBSTEP_LENGTH_H
#define SPHCLOTH_CORE_PBD_SUBSTEP_LENGTH_H

#include <algorithm>
#include <cmath>

namespace sphcloth {

class SubstepLength {
 public:
  // how many substeps a step of dt needs; the longest step so far takes at least `usual`
  double substeps(double dt, int usual)
  {
    state.longest_step = std::max(state.longest_step, dt);
    const double longest = state.longest_step / usual;
    if (state.length == 0.0)
      state.length = longest;
    else {
      const double error = state.demand * state.length * state.length;
      watch(error);
      double wanted = std::min(longest, state.length / std::sqrt(error));
      if (state.held_error > 0.0) wanted = std::max(wanted, state.length_then);
      state.length = std::clamp(wanted, state.length / CHANGE, state.length * CHANGE);
    }
    constexpr double ROUNDING = 1e-6;
    return std::ceil(dt / state.length - ROUNDING);
  }

  // of a step whose substeps are given; the solver is never stiffer than the present ones make it
  void use(double substep) { state.length = std::max(state.length, substep); }
  void stiffen() { state.length /= CHANGE; }

  // of the last step: 1/h^2 of the longest substep h in which the strain is not above the allowed
  void set_demand(double demand) { state.demand = demand; }

  // substep that the solver is as soft as
  double length() const { return state.length; }

  // The strain is above the allowed one in substeps of any length: something holds the vertices
  // apart, and shorter ones are of no use.
  bool is_held() const { return state.held_steps >= HELD; }

  struct State {    // plain and without gaps
    double longest_step = 0.0, length = 0.0, demand = 0.0;
    double length_then = 0.0, error_then = 0.0;    // since when a strain above is watched; 0: none
    double held_error = 0.0, held_steps = 0.0;    // that shorter substeps did not change; 0: none
    double mean_error = 0.0;    // of recent steps
  };
  State state;

 private:
  static constexpr double CHANGE = 1.01;    // in a step: a period of an edge is some six substeps
  static constexpr double HELD = 150.0;    // steps, in which the length is again what it was

  // Substeps of half the length leave a quarter of the strain of a load, and all of one that is
  // held: then they become what they were, which a load would answer with more strain.  A load that
  // grows is watched anew.

  void watch(double error)
  {
    constexpr double SHORTER = 0.5, SMALLER = 0.7, GROWS = 1.2, HELD_GROWS = 1.5, MEMORY = 30.0;
    State &s = state;
    if (error <= 1.0) {
      s.length_then = s.error_then = s.held_error = s.held_steps = 0.0;
      s.mean_error = error;
      return;
    }
    if (s.length_then == 0.0) s.mean_error = error;
    s.mean_error += (error - s.mean_error) / MEMORY;
    if (s.held_error > 0.0) {
      s.held_steps++;
      if (s.mean_error > HELD_GROWS * s.held_error)
        s.length_then = s.held_error = s.held_steps = 0.0;
    } else if (s.length_then == 0.0 || s.mean_error > GROWS * s.error_then) {
      s.length_then = s.length;
      s.error_then = s.mean_error;
    } else if (s.length <= SHORTER * s.length_then) {
      if (s.mean_error > SMALLER * s.error_then) {
        s.held_error = s.mean_error;
        s.held_steps = 0.0;
      } else
        s.length_then = 0.0;
    }
  }
};

}    // namespace sphcloth

#endif
