// SPDX-License-Identifier: GPL-2.0-or-later
// Equations (10) to (12): the step of the run.

#include "stepping/step_control.h"

#include "atom.h"
#include "error.h"
#include "fix.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "integrate.h"
#include "lammps_util/atom_tools.h"
#include "modify.h"
#include "output.h"
#include "pair.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <utility>

using namespace LAMMPS_NS;
using namespace sphcloth;

StepControl::StepControl(LAMMPS *lmp_, const StepOptions &options_, std::string label_,
                         int groupbit_) :
    Pointers(lmp_), times(lmp_), options(options_), label(std::move(label_)), groupbit(groupbit_),
    fluid(nullptr), previous(0.0), largest_before(0.0), limit(Limit::NONE),
    n_steps(update->ntimestep), time(physical_time(update))
{
}

void StepControl::init(FluidState *style, double shortest_sound_time)
{
  fluid = style;
  control.eta = options.eta;
  control.sound_time = shortest_sound_time;
}

void StepControl::restore(const State &before)
{
  previous = before.previous;
  largest_before = before.largest_before;
  limit = before.limited_by;
  n_steps = before.steps;
  time = before.time;
  watch.restore(before.watch);
}

/* ----------------------------------------------------------------------
   the next step
------------------------------------------------------------------------- */

void StepControl::choose(const StepLimit &mine, tagint particle)
{
  StepLimit wanted = tightest_of_ranks(mine);
  if (controls()) wanted.tighten(controlled_step(previous, largest_before), Limit::FLUCTUATION);
  StepLimit step = bounded(wanted, previous);
  if (is_too_short(step)) {
    error->all(FLERR, too_short(wanted, owner_of(wanted, mine, particle)));
  }
  if (times.any()) times.head_for(step);
  limit = step.by;
  if (step.dt != update->dt) set_timestep(step.dt);
  if (times.arrives()) times.announce_thermo();
}

double StepControl::controlled_step(double before, double largest_compression_before)
{
  compression = compression_of_ranks();
  return control.step(before, compression, largest_compression_before);
}

void StepControl::take(double dt, Limit by, bool ends_at_output_time)
{
  limit = by;
  times.set_arrives(ends_at_output_time);
  if (dt != update->dt) set_timestep(dt);
  if (times.arrives()) times.announce_thermo();
}

void StepControl::end_step()
{
  previous = times.uncut() > 0.0 ? times.uncut() : update->dt;
  largest_before = compression.largest;
  time = physical_time(update);
}

double StepControl::jump(double now) const
{
  constexpr double OF_STEP = 1e-6, ROUNDING = 1e-12;
  const double by = now - time;
  return std::fabs(by) > OF_STEP * update->dt + ROUNDING * std::fabs(now) ? by : 0.0;
}

std::string StepControl::too_short(const StepLimit &wanted, tagint particle) const
{
  const std::string of = particle ? fmt::format(" of particle {}", particle) : "";
  const std::string failed = options.min > 0.0
      ? ""
      : fmt::format(" ({:g} of max {}): a run that needs such steps has failed before, give its "
                    "limits smaller coefficients; or",
                    StepOptions::DEFAULT_MIN, options.ceiling);
  return fmt::format("{}: the {} limit{} asks for a step of {}, below min {}{}{} lower min, or use "
                     "'below clamp' to go on with min and count",
                     label, limit_name(wanted.by), of, wanted.dt, options.floor(), failed,
                     failed.empty() ? ":" : "");
}

void StepControl::refuse_reset(double output_time, double end) const
{
  error->all(FLERR,
             "{}: the time has been reset to {}, the next output time is {}, but all particles are "
             "synchronized again at {}: reset the time where a run has ended at an output time",
             label, physical_time(update), output_time, end);
}

StepLimit StepControl::tightest_of_ranks(const StepLimit &mine) const
{
  struct {
    double dt;
    int by;
  } in = {mine.dt, static_cast<int>(mine.by)}, out;
  MPI_Allreduce(&in, &out, 1, MPI_DOUBLE_INT, MPI_MINLOC, world);
  return {out.dt, static_cast<Limit>(out.by)};
}

tagint StepControl::owner_of(const StepLimit &of_ranks, const StepLimit &mine,
                             tagint particle) const
{
  const tagint here = mine.dt == of_ranks.dt ? particle : 0;
  tagint anywhere = 0;
  MPI_Allreduce(&here, &anywhere, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  return anywhere;
}

/* ----------------------------------------------------------------------
   how far the fluid is compressed
------------------------------------------------------------------------- */

double StepControl::largest_compression() const
{
  double largest = 0.0;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit)
      largest =
          std::max(largest, atom->rho[i] / fluid->equation_of_state(atom->type[i]).rho0 - 1.0);
  return largest;
}

double StepControl::fastest_sound() const
{
  double fastest = 0.0;
  for (int t = 1; t <= atom->ntypes; t++)
    if (fluid->is_fluid(t)) fastest = std::max(fastest, fluid->equation_of_state(t).sound_speed());
  return fastest;
}

Compression StepControl::compression_of_ranks() const
{
  double largest = largest_compression(), mine[2] = {0.0, 0.0}, all[2];
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) {
      const double rho0 = fluid->equation_of_state(atom->type[i]).rho0;
      mine[0] += std::max(0.0, atom->rho[i] / rho0 - 1.0);
      mine[1] += 1.0;
    }
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, world);
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, world);
  return {largest, all[1] > 0.0 ? all[0] / all[1] : 0.0};
}

/* ----------------------------------------------------------------------
   LAMMPS's time step
------------------------------------------------------------------------- */

void StepControl::set_timestep(double dt)
{
  tell_timestep(dt, nullptr);
  output->reset_dt();
  if (output->any_time_dumps && update->setupflag == 0) reschedule_dumps();
}

// The time reached so far is booked first; every style that keeps a copy of dt is told, of fixes
// those before `end`.

void StepControl::tell_timestep(double dt, const Fix *end)
{
  update->update_time();
  update->dt = dt;
  update->dt_default = 0;
  update->integrate->reset_dt();
  if (force->pair) force->pair->reset_dt();
  for (Fix *other : modify->get_fix_list()) {
    if (other == end) break;
    other->reset_dt();
  }
}

// LAMMPS has found anew at which step each dump by time is due, but if that is earlier now, dumps
// of style atom or xyz would be overlooked.

void StepControl::reschedule_dumps()
{
  for (int k = 0; k < output->ndump; k++)
    output->next_dump_any = k ? std::min(output->next_dump_any, output->next_dump[k])
                              : output->next_dump[k];
  output->next = std::min({output->next_dump_any, output->next_restart, output->next_thermo});
}
