// SPDX-License-Identifier: GPL-2.0-or-later
// The step that all ranks take next: chosen from the tightest limit anywhere, (12) of the paper, or
// told by a scheme that has chosen it; cut at output times; made known to the whole of LAMMPS.

#ifndef SPHCLOTH_STEPPING_STEP_CONTROL_H
#define SPHCLOTH_STEPPING_STEP_CONTROL_H

#include "pointers.h"

#include "core/timestep/step_limits.h"
#include "stepping/output_times.h"
#include "stepping/stability_watch.h"
#include "stepping/step_options.h"

#include <string>

namespace LAMMPS_NS {

class Fix;
class FluidState;

class StepControl : protected Pointers {
 public:
  OutputTimes times;
  StabilityWatch watch;    // where all take the same step

  // label of the fix for errors, group of the fluid that it integrates
  StepControl(LAMMPS *, const StepOptions &, std::string label, int groupbit);

  void init(FluidState *, double shortest_sound_time);
  void set_sound_time(double shortest) { control.sound_time = shortest; }

  // a step of the run begins, whatever LAMMPS calls it: reset_timestep changes its number
  void begin_step() { n_steps++; }
  bigint steps() const { return n_steps; }

  // collective: the next step from the tightest limit of this rank, and the ID of the particle or
  // vertex that has it
  void choose(const sphcloth::StepLimit &mine, tagint particle);
  // From init() of this fix, the step that comes next in a run that goes on: what is initialized
  // already is told, what follows will read it.
  void resume(double dt, const Fix *initialized_now) { tell_timestep(dt, initialized_now); }
  // the next step, as a scheme has chosen it
  void take(double dt, sphcloth::Limit by, bool ends_at_output_time);
  // is the step controlled by compression?  Then, collective: the step that the controller allows
  // behind one of this length, which was chosen at this compression
  bool controls() const { return control.eta > 0.0; }
  double controlled_step(double before, double largest_compression_before);
  double compression_found() const { return compression.largest; }    // by that
  void end_step();

  // By how much the physical time is later than at the end of the last step: 0, unless it has been
  // reset since.
  double jump(double now) const;
  void set_time(double now) { time = now; }

  sphcloth::Limit limited_by() const { return limit; }
  // of this rank
  double largest_compression() const;
  // the largest speed of sound at rest of all fluids
  double fastest_sound() const;

  // `wanted`, held between floor and ceiling and to the growth from the step before; an error if it
  // is below a floor that ends the run
  sphcloth::StepLimit bounded(const sphcloth::StepLimit &wanted, double before) const
  {
    return sphcloth::bounded_step(wanted, before, options.growth, options.floor(), options.ceiling);
  }
  bool is_too_short(const sphcloth::StepLimit &step) const
  {
    return step.by == sphcloth::Limit::FLOOR && !options.clamp_at_floor;
  }
  // 0: it is no limit of a particle
  std::string too_short(const sphcloth::StepLimit &wanted, tagint particle) const;

  // an error: the time was reset between an output time and the end of a base step
  void refuse_reset(double output_time, double end) const;

  // collective: the tightest limit of all ranks, and the ID of the particle or vertex that has it
  sphcloth::StepLimit tightest_of_ranks(const sphcloth::StepLimit &mine) const;
  tagint owner_of(const sphcloth::StepLimit &of_ranks, const sphcloth::StepLimit &mine,
                  tagint particle) const;

  // for restart files
  struct State {
    double previous;    // the last step, before an output time cut it; 0 before the first
    double largest_before;    // compression when that step was chosen
    sphcloth::Limit limited_by;
    bigint steps;
    double time;    // at the end of the last step
    StabilityWatch::State watch;
  };
  State state() const { return {previous, largest_before, limit, n_steps, time, watch.state()}; }
  void restore(const State &);

 private:
  const StepOptions &options;
  std::string label;
  int groupbit;
  FluidState *fluid;
  sphcloth::FluctuationControl control;
  double previous, largest_before;
  sphcloth::Compression compression;    // when the step that comes next was chosen
  sphcloth::Limit limit;
  bigint n_steps;
  double time;    // physical, at the end of the last step

  sphcloth::Compression compression_of_ranks() const;
  void set_timestep(double dt);
  void tell_timestep(double dt, const Fix *end);
  void reschedule_dumps();
};

}    // namespace LAMMPS_NS

#endif
