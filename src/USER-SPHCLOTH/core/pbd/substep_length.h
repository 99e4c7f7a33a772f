// SPDX-License-Identifier: GPL-2.0-or-later
// How long the substeps of a cloth are: as long as the softness allows that the present load has
// left to its constraints (core/pbd/solver_softness.h), and shorter while contact lags behind.

#ifndef SPHCLOTH_CORE_PBD_SUBSTEP_LENGTH_H
#define SPHCLOTH_CORE_PBD_SUBSTEP_LENGTH_H

#include <algorithm>
#include <cmath>

#include "core/pbd/solver_softness.h"

namespace sphcloth {

class SubstepLength {
 public:
  static constexpr double MISSED = 0.5;    // share of contact that is too much

  // how many substeps a step of dt needs; the longest step so far takes at least `usual`
  double substeps(double dt, int usual)
  {
    constexpr double SPARED = 0.1;    // of a substep, which a little load would need
    state.longest = std::max(state.longest, dt / usual);
    of_longest_step = dt / (usual * state.longest);
    follow_load();
    refine_for_contact();
    const double substep = state.longest * std::sqrt(with_margin(state.hardness)) / state.refined;
    return std::ceil(dt / substep - SPARED);
  }

  // In steps no longer than the longest one: substeps of this length, but no more than a load may
  // ask for.
  double substeps_for(double dt, double substep) const
  {
    const double shortest = state.longest * std::sqrt(with_margin(hardness_of(MAX_OF_ALLOWED)));
    return std::ceil(dt / std::max(substep, shortest));
  }

  // before the first step: the strain that edges have, over the one that is allowed
  void begin(double strain)
  {
    if (strain <= 1.0) return;
    state.yield = strain / SOFT;
    state.strain_then = strain;
    state.phase = STRAINED;
  }

  // Of the last step: how soft the hardest constraint was, over that of the longest substep, and
  // the strain over the one that was allowed then.
  void found(double hardest, double strain)
  {
    const double before = state.yield;
    state.hardest = hardest;
    watch(strain);
    allow_what_was_borne();
    // what is allowed less hardens an edge that stays as long
    const double less = before / state.yield;
    if (less > 1.0) state.hardest = hardness_of(less * strain_with(hardest));
  }

  // Of the last step: what contact did not pass on in the substeps, as a share of the impulses that
  // stop what touches the cloth; the largest of several.
  void missed_in_contact(double share) { state.missed = std::max(state.missed, share); }

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
    double hardest = 1.0;    // of the last step
    double hardness = 1.0;    // that the substeps of this step are made for
    double yield = 1.0, least_yield = 1.0;    // the second one where something holds them apart
    double phase = BORNE, steps = 0.0, strain_then = 0.0;
    double since = 0.0;    // the yield was raised, in longest steps
    double missed = 0.0;    // in contact in the last step
    double refined = 1.0;    // so many times more substeps for that
  };
  State state;

 private:
  static constexpr double BORNE = 0.0, YIELDS = 1.0, HELD = 2.0, OVERLOADED = 3.0, STRAINED = 4.0;
  static constexpr double SOFT = 1.0 / 3.0;    // of the allowed strain: an edge is hardly harder
  static constexpr double CHANGE = 1.03;    // of the yield, in a step
  double of_longest_step = 1.0;    // the length of the step over that of the longest

  // Substeps that are only just short enough let the hardest edges ring, and what comes later in a
  // sweep stretches an edge by as much as its law does.
  static double with_margin(double hardness) { return 0.5 * hardness * (1.0 + hardness); }

  // A change of the substeps shakes a sheet, and what it shakes asks for the next change: they are
  // shorter at once where the load asks for it, and longer, slowly, only if it leaves them room.
  void follow_load()
  {
    constexpr double ROOM = 1.1, RELAXES = 1.03;    // the second one in a step
    const double enough = std::min(1.0, ROOM * state.hardness);
    if (state.hardest >= enough || state.hardest < state.hardness)
      state.hardness = std::min(state.hardest, RELAXES * state.hardness);
  }

  // Where substeps were too long for the load, edges were only as hard as these and have given way
  // farther than springs would.  More is allowed, so that springs at this strain are as hard as the
  // substeps have made them: harder ones would give back more than they took.
  void allow_what_was_borne()
  {
    constexpr double VARIES = 0.95;    // a load at rest
    const double borne = VARIES * state.hardness;
    const double strain = strain_with(state.hardest) * (borne / state.hardest);
    const double more = strain / std::max(SOFT, strain_with(borne));
    if (more <= 1.0) return;
    state.yield *= more;
    state.since = 0.0;
  }

  // A sheet that is light beside what lies on it passes a part of its pull on to that in a substep,
  // and the smaller the parts that it has to pass on are, the less of them is missing.
  void refine_for_contact()
  {
    constexpr double GROWS = 1.3, LARGEST = 10.0;
    state.refined = state.missed > MISSED
        ? std::min(LARGEST, GROWS * state.refined)
        : std::max(1.0, state.refined / std::pow(CHANGE, of_longest_step));
    state.missed = 0.0;
  }

  // What is allowed less lifts a load, and pulls at what has struck the sheet: slowly where edges
  // are hard, until the load has lasted.  All by time, in units of the longest step.
  void shrink_yield(double strain)
  {
    constexpr double LASTS = 100.0;
    State &s = state;
    s.since = std::min(s.since + of_longest_step, LASTS);
    const double speed = strain < SOFT ? 1.0 : (1.0 + 2.0 * s.since / LASTS) / 3.0;
    const double shrunk = s.yield / std::pow(CHANGE, speed * of_longest_step);
    if (strain < SOFT * SOFT) s.least_yield = std::max(1.0, std::min(s.least_yield, shrunk));
    s.yield = std::max(s.least_yield, shrunk);
  }

  // Edges that are strained at the start are as soft as if they were allowed to be, and harden
  // slowly.  If that does not bring their strain down, or if edges harden no further for many
  // steps, more is allowed from step to step until the constraints are soft again, and stays so.
  // If a load stretches them by as much more that was of no use.

  void watch(double strain)
  {
    constexpr double STEPS_ABOVE = 30.0, GROWS = 1.25;
    State &s = state;
    const double absolute = strain * s.yield;
    if (s.phase == YIELDS) {
      s.yield *= CHANGE;
      if (absolute > GROWS * s.strain_then) s.phase = OVERLOADED;
      if (strain < SOFT) s.phase = HELD;
      s.least_yield = s.phase == HELD ? s.yield : 1.0;
      return;
    }
    s.steps = strain > MAX_OF_ALLOWED ? s.steps + 1.0 : 0.0;
    shrink_yield(strain);
    // from a third of what is allowed a load would come to half of it, for half the yield
    const bool stays = s.phase == STRAINED && strain > 2.0 * SOFT && 2.0 * absolute > s.strain_then;
    const bool is_allowed = s.steps == 0.0 && s.yield == 1.0;
    if (is_allowed || (s.phase == STRAINED && absolute < 1.0)) s.phase = BORNE;
    if (!stays && (s.steps < STEPS_ABOVE || s.phase == OVERLOADED)) return;
    s.phase = YIELDS;
    s.strain_then = absolute;
  }
};

}    // namespace sphcloth

#endif
