// SPDX-License-Identifier: GPL-2.0-or-later
// Exact times: steps that end at multiples of an interval, where output is due, and at the end of a
// run.

#ifndef SPHCLOTH_STEPPING_OUTPUT_TIMES_H
#define SPHCLOTH_STEPPING_OUTPUT_TIMES_H

#include "pointers.h"

#include "core/timestep/step_limits.h"

namespace LAMMPS_NS {

class OutputTimes : protected Pointers {
 public:
  double interval = 0.0;    // of output times, 0: none
  double until = 0.0;    // physical time at which a run ends, 0: never

  explicit OutputTimes(LAMMPS *lmp_) : Pointers(lmp_) {}

  bool any() const { return interval > 0.0 || until > 0.0; }
  // the next output time or end of a run, as a step of dt sees it; infinite if there is none
  double next(double dt) const;
  // shortens the next step to end there, if it has to
  void head_for(sphcloth::StepLimit &step);
  // length of that step before it was shortened; 0 without such times
  double uncut() const { return whole; }
  // does that step end at such a time?
  bool arrives() const { return arriving; }
  void set_arrives(bool at_its_end) { arriving = at_its_end; }

  // is it an output time?
  bool is_now() const;
  // the step for thermodynamic output: the one that comes next, or one that never comes
  bigint next_thermo() const;
  void announce_thermo();
  // ends a run that has arrived; end_run(): the run is over
  void look_for_end();
  void end_run();

 private:
  double whole = 0.0;
  bool arriving = false;
  bool has_ended_run = false;

  void want_thermo(bigint step);
};

}    // namespace LAMMPS_NS

#endif
