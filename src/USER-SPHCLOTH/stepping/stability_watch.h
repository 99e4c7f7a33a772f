// SPDX-License-Identifier: GPL-2.0-or-later
// The longest stable step of all particles together, found anew as often as it changes: where it
// shrinks in every step, where it does not every few steps, and in every step while nothing is
// under pressure.

#ifndef SPHCLOTH_STEPPING_STABILITY_WATCH_H
#define SPHCLOTH_STEPPING_STABILITY_WATCH_H

#include "lmptype.h"

#include "core/timestep/step_limits.h"

#include <algorithm>
#include <cstdint>

namespace LAMMPS_NS {

class StabilityWatch {
 public:
  static constexpr int LONGEST_WAIT = 8;    // steps

  struct State {    // plain, for restart files
    sphcloth::StepLimit tightest;
    tagint particle = 0;    // that has it
    int interval = 0, remaining = 0;    // steps from one search to the next; 0: never searched
    std::uint64_t settings = 0;    // at the end of the last run; 0: there was none
  };

  // A run begins: the limit is found in its first evaluation where anything that it follows from
  // has changed, or particles since the last run, so that several runs are one run.
  bool begin_run(std::uint64_t settings, bool atoms_changed)
  {
    if (settings == now.settings && !atoms_changed) return false;
    now = State();
    now.settings = settings;
    return true;
  }
  // What has changed them in the run has been followed: find() says what they are now.
  template <class Find> void end_run(Find find)
  {
    if (now.settings != 0) now.settings = find();
  }
  // is the limit to be found in the evaluation that comes next?
  bool due() const { return now.remaining == 0; }
  // it has changed by more than the motion
  void demand() { now.remaining = 0; }
  // of all ranks, after an evaluation in which it was due
  void found(const sphcloth::StepLimit &tightest, tagint particle, bool in_flight)
  {
    const bool shrinks = tightest.dt < (1.0 - SMALL_CHANGE) * now.tightest.dt;
    const bool at_once = now.interval == 0 || shrinks || in_flight;
    now.interval = at_once ? 1 : std::min(2 * now.interval, LONGEST_WAIT);
    now.remaining = now.interval;
    now.tightest = tightest;
    now.particle = particle;
  }
  void begin_step() { now.remaining = std::max(0, now.remaining - 1); }

  const State &state() const { return now; }
  void restore(const State &before) { now = before; }

 private:
  static constexpr double SMALL_CHANGE = 0.05;
  State now;
};

}    // namespace LAMMPS_NS

#endif
