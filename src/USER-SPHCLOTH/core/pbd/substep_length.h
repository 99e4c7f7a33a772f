// SPDX-License-Identifier: GPL-2.0-or-later
// How long the substeps of a cloth are: as long as the softness allows that the present load has
// left to its constraints (core/pbd/solver_softness.h).

#ifndef SPHCLOTH_CORE_PBD_SUBSTEP_LENGTH_H
#define SPHCLOTH_CORE_PBD_SUBSTEP_LENGTH_H

#include <algorithm>
#include <cmath>

#include "core/pbd/solver_softness.h"

namespace sphcloth {

class SubstepLength {
 public:
  // how many substeps a step of dt needs; the longest step so far takes at least `usual`
  double substeps(double dt, int usual)
  {
    constexpr double SPARED = 0.1;    // of a substep, which a little load would need
    state.longest = std::max(state.longest, dt / usual);
    of_longest_step = dt / (usual * state.longest);
    state.hardness = expected();
    return std::ceil(dt / (state.longest * std::sqrt(state.hardness)) - SPARED);
  }

  // before the first step: the strain that edges have, over the one that is allowed
  void begin(double strain)
  {
    if (strain <= 1.0) return;
    state.yield = strain / SOFT;
    state.phase = STRAINED;
  }

  // Of the last step: how soft the hardest constraint was, over that of the longest substep, and
  // the strain over the one that was allowed then.
  void found(double hardest, double strain)
  {
    state.hardest_before = state.hardest;
    state.hardest = hardest;
    watch(strain);
  }

  // How far edges are stretched, and what their load strains them by, both over the strain that was
  // allowed then.  Where substeps were much too long for the load they have given way farther than
  // springs would.  Then more is allowed, so that springs at this strain are as hard as the
  // substeps have made them: harder ones would give back more than they took.
  static constexpr double TOO_FAR = 2.0;    // over the strain by the load
  void stretched(double strain, double by_load)
  {
    const bool was_too_soft = state.hardest < TOO_SOFT * state.hardness;
    if (!was_too_soft && strain < TOO_FAR * std::max(SOFT, by_load)) return;
    const double root = 1.0 / std::sqrt(state.hardness);
    const double y = std::pow((root - 1.0) / HARDENING, 0.25);
    state.yield *= std::max(1.0, strain / std::clamp(y, SOFT, MAX_OF_ALLOWED));
  }

  // A softness that is not bounded by a strain: it follows substeps that are given, if they become
  // longer at once, else slowly.
  void follow(double substep)
  {
    constexpr double FALLS = 1.01;    // in a step: a period of an edge is some six substeps
    state.longest = std::max(state.longest / FALLS, substep);
  }

  // which the solver of unloaded constraints is as soft as
  double longest() const { return state.longest; }
  // what the allowed strain is multiplied with where something holds the vertices apart
  double yield() const { return state.yield; }

  // The strain stays above what hardens the edges, and stays where more is allowed: something holds
  // the vertices apart.  overloaded: a load that no hardening bears.
  bool is_held() const { return state.phase == HELD; }
  bool is_overloaded() const { return state.phase == OVERLOADED; }

  struct State {    // plain and without gaps
    double longest = 0.0;
    double hardest = 1.0, hardest_before = 1.0;    // of the last two steps
    double hardness = 1.0;    // that the substeps of this step are made for
    double yield = 1.0;
    double phase = BORNE, steps = 0.0, strain_then = 0.0;
  };
  State state;

 private:
  static constexpr double BORNE = 0.0, YIELDS = 1.0, HELD = 2.0, OVERLOADED = 3.0, STRAINED = 4.0;
  static constexpr double SOFT = 1.0 / 3.0;    // of the allowed strain: an edge is hardly harder
  static constexpr double TOO_SOFT = 0.45;    // substeps follow a load that doubles in a step
  static constexpr double CHANGE = 1.03;    // of the yield, in a step
  double of_longest_step = 1.0;    // the length of the step over that of the longest

  // A load that grows hardens in the coming step as it did in the last one.  In a step the hardness
  // doubles at the utmost, since what is stretched already would pull as much harder, and substeps
  // become longer slowly: the sheet is the calmer the less they vary.
  double expected() const
  {
    constexpr double FASTEST = 0.5, RELAXES = 1.03;
    const double grows = std::clamp(state.hardest / state.hardest_before, FASTEST, 1.0);
    return std::clamp(state.hardest * grows, state.hardness * FASTEST, state.hardness * RELAXES);
  }

  // By time: what is allowed less pulls at what is stretched.
  void shrink_yield()
  {
    state.yield = std::max(1.0, state.yield / std::pow(CHANGE, of_longest_step));
  }

  // Edges that are strained at the start are as soft as if they were allowed to be, until they
  // shrink.  Where edges harden no further for many steps, more is allowed from step to step,
  // until the constraints are soft again.  A load stretches them by as much more, then that was of
  // no use.

  void watch(double strain)
  {
    constexpr double STEPS_ABOVE = 30.0, GROWS = 1.25, AT_REST = 300.0;
    State &s = state;
    if (s.phase == YIELDS) {
      s.yield *= CHANGE;
      if (strain * s.yield > GROWS * s.strain_then) s.phase = OVERLOADED;
      if (strain < SOFT) s.phase = HELD;
      return;
    }
    const bool yields_still = s.phase == HELD || s.phase == STRAINED;
    s.steps = strain > MAX_OF_ALLOWED || s.phase == STRAINED ? s.steps + 1.0 : 0.0;
    if (!yields_still || strain < SOFT * SOFT) shrink_yield();
    if (s.phase == STRAINED) {
      if (s.steps > AT_REST) s.phase = HELD;
      if (strain * s.yield < 1.0) s.phase = BORNE;
      return;
    }
    if (s.steps == 0.0 && s.yield == 1.0) s.phase = BORNE;
    if (s.steps < STEPS_ABOVE || s.phase == OVERLOADED) return;
    s.phase = YIELDS;
    s.strain_then = strain * s.yield;
  }
};

}    // namespace sphcloth

#endif
