// SPDX-License-Identifier: GPL-2.0-or-later
// Exact times, see output_times.h.

#include "stepping/output_times.h"

#include "input.h"
#include "lammps_util/atom_tools.h"
#include "modify.h"
#include "output.h"
#include "timer.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

// part of a step by which a time may miss the one that it counts as
static constexpr double SLACK = 1e-6;
// of the step that others allow: one that is shorter is set by the output time
static constexpr double HARDLY_SHORTER = 0.9;

// A time that is nearer than a small part of a step has passed.

double OutputTimes::next(double dt) const
{
  const double now = physical_time(update), slack = SLACK * dt;
  double next = std::numeric_limits<double>::infinity();
  if (interval > 0.0) next = output_time(output_times_until(now, interval, slack) + 1.0, interval);
  if (now + slack < until) next = std::min(next, output_time(1.0, until));
  return next;
}

void OutputTimes::head_for(StepLimit &step)
{
  const double remaining = next(step.dt) - physical_time(update);
  const double dt = step_towards(remaining, step.dt);
  arriving = dt == remaining;
  whole = step.dt;
  if (dt < HARDLY_SHORTER * step.dt) step.by = Limit::OUTPUT;
  step.dt = dt;
}

bool OutputTimes::is_now() const
{
  if (interval == 0.0) return false;
  const double now = physical_time(update), slack = SLACK * std::min(update->dt, interval);
  return now - output_time(output_times_until(now, interval, slack), interval) < slack;
}

bigint OutputTimes::next_thermo() const
{
  const bigint next = update->ntimestep + 1;
  return arriving ? next : std::max(next, update->laststep + 1);
}

// A variable that says when thermodynamic output is due was evaluated when it was not yet known
// that the next step ends at an output time.

void OutputTimes::announce_thermo()
{
  const bigint next = update->ntimestep + 1;
  if (!output->var_thermo || output->next_thermo <= next) return;
  modify->clearstep_compute();
  const double due = input->variable->compute_equal(output->ivar_thermo);
  if (static_cast<bigint>(due) == next) want_thermo(next);
}

void OutputTimes::want_thermo(bigint step)
{
  modify->addstep_compute_all(step);
  output->next_thermo = step;
  output->next = std::min(output->next, step);
}

// As by the command timer, the last step with thermodynamic output.  A row that is due now is not
// written yet, and the next one follows from it and from the last step of the run.

void OutputTimes::look_for_end()
{
  if (until == 0.0) return;
  const double now = physical_time(update), slack = SLACK * update->dt;
  if (now + slack >= until) {
    has_ended_run = has_ended_run || !timer->is_timeout();
    return timer->force_timeout();
  }
  const bigint next = update->ntimestep + 1;
  if (now + update->dt + slack < until) return;
  update->laststep = std::min(update->laststep, next);
  if (output->next_thermo > next) want_thermo(next);
}

// What something else has ended stays ended: fix halt ... error soft, timer timeout.

void OutputTimes::end_run()
{
  if (has_ended_run) timer->reset_timeout();
  has_ended_run = false;
}
