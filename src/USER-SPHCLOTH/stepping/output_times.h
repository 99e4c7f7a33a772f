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
  // when a step of dt is the next; infinite if there is none
  double next(double dt) const;
  // Shortens the step that comes next, if it has to be.
  void head_for(sphcloth::StepLimit &step);
  // that step, had it not been shortened; 0 without such times
  double uncut() const { return whole; }
  // does it end at such a time?
  bool arrives() const { return arriving; }
  void set_arrives(bool it_does) { arriving = it_does; }

  // is it an output time?
  bool is_now() const;
  // the step for thermodynamic output: the one that comes next, or one that never comes
  bigint next_thermo() const;
  void announce_thermo();
  // Ends a run that has arrived; to be told when it is over.
  void look_for_end();
  void end_run();

 private:
  double whole = 0.0;
  bool arriving = false;

  void want_thermo(bigint step);
};

}    // namespace LAMMPS_NS

#endif
