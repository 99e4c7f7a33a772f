// SPDX-License-Identifier: GPL-2.0-or-later
// Steps of individual particles in powers of two.

#include "stepping/block_steps.h"

#include "atom.h"
#include "fluid/fluid_state.h"
#include "lammps_util/atom_tools.h"
#include "stepping/kick_drift.h"
#include "stepping/step_report.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

using Columns = BlockColumns;

BlockSteps::BlockSteps(LAMMPS *lmp_, const SteppingParts &parts_, const BlockClock &clock) :
    Stepper(lmp_, parts_), state(lmp_, parts.fix, parts.options.block), bins(lmp_, parts, state),
    sleeping(lmp_, state, parts.limits), impulses(lmp_, state, sleeping, parts.limits),
    half_kick(lmp_, state, parts.limits), frequencies(lmp_, state)
{
  state.clock = clock;
  state.columns.create(Columns::N_COLUMNS, atom->nmax);
  for (int i = 0; i < atom->nlocal; i++) state.add_particle(i);
}

void BlockSteps::init(FluidState *style, Change change)
{
  Stepper::init(style, change);
  all_selected = false;
  state.init(style);
  bins.init(style);
  fluid->set_step_hooks(this);
  count_flight();
  const std::uint64_t before = parts.control.watch.state().settings;
  const std::uint64_t settings = parts.limits.settings();
  if (parts.control.watch.begin_run(settings, change != Change::NOTHING) && before != 0)
    start_over(settings != before || change == Change::POSITIONS);
  sleeping.begin_run();
}

// Steps and impulses are of another state.  Where only velocities have been changed those that are
// disturbed wake, as in a run; in another scene nothing is known to be at rest.

void BlockSteps::start_over(bool other_scene)
{
  const BlockClock before = state.clock;
  state.clock = BlockClock();
  state.clock.uniform = before.uniform;
  state.clock.fixes = before.fixes;
  state.clock.defers = before.defers;    // what vertices are still to get
  for (int i = 0; i < atom->nlocal; i++) {
    if (state.is_asleep(i) && !other_scene) continue;
    state.add_particle(i);
    state.columns[Columns::REACH][i] = 0.0;
    parts.rows[i][UpdateRows::ACTIVE] = 1.0;
    if (double &sum = state.columns[Columns::SUM][i]; other_scene && sum != KeptDensity::NONE)
      sum = KeptDensity::UNKNOWN;
  }
}

void BlockSteps::forget_stability()
{
  Stepper::forget_stability();
  frequencies.forget();
}

/* ----------------------------------------------------------------------
   one smallest step
------------------------------------------------------------------------- */

void BlockSteps::move()
{
  kick_and_drift(
      atom, update, force, parts.fix->groupbit, [this](int i) { return state.is_asleep(i); },
      [this](int i) { return parts.first_kick.share(i); });
  sleeping.wake_disturbed();
  advance_clock();
  select_active();
  count_flight();
}

// Neighbors in free flight allow longer steps where all particles are asked how long it lasts.

void BlockSteps::count_flight()
{
  fluid->want_shares_under_pressure(state.clock.uniform && !state.clock.some_sleep);
}

void BlockSteps::advance_clock()
{
  BlockClock &clock = state.clock;
  clock.line.now += TimeBins::ticks(clock.deepest);
  clock.chosen = false;
  clock.defers = false;
  state.coarsest = clock.line.coarsest();
}

bool BlockSteps::updates_all_next() const
{
  return state.clock.begun() && state.clock.ends_base_step();
}

// particles whose step begins; sleeping particles stay as they are

void BlockSteps::select_active()
{
  if (all_selected && state.clock.uniform && !state.clock.some_sleep) {
    parts.report.updates += static_cast<double>(fluid->active_particles().size());
    return tell_active(true);
  }
  const double *bin = state.columns[Columns::BIN], *event = state.columns[Columns::EVENT];
  int n_active = 0, n = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!fluid->is_fluid(atom->type[i])) continue;
    const bool active = bin[i] >= state.coarsest || event[i] != Columns::NONE;
    parts.rows[i][UpdateRows::ACTIVE] = active;
    n_active += active;
    n++;
  }
  parts.report.updates += n_active;
  // not by the particles of this rank alone: an inactive one may come from another in this step
  const bool none_sleep = state.clock.uniform ? !state.clock.some_sleep : !sleeping.enabled();
  const bool all = state.coarsest == 0 && n_active == n && none_sleep;
  all_selected = all && state.clock.uniform;
  tell_active(all);
}

bool BlockSteps::correct_velocities()
{
  const bool kicked = half_kick.correct_velocities();
  const bool stopped = !state.clock.chosen && sleeping.enabled() && sleeping.stop_resting();
  return kicked || stopped;
}

// Unequal steps are chosen before forces are known, so that each particle gives its impulses in the
// pass that finds its force; equal ones after that.

const Impulses *BlockSteps::begin_impulses()
{
  state.make_room();
  if (state.clock.begun() && !state.clock.uniform) choose_bins();
  return impulses.begin();
}

void BlockSteps::choose_bins()
{
  if (!state.clock.chosen) {
    const bool was_uniform = state.clock.uniform;
    bins.choose();
    if (was_uniform && !state.clock.uniform) frequencies.forget();
    if (sleeping.enabled()) sleeping.fall_asleep();
    state.clock.chosen = true;
  }
  if (state.clock.uniform) return;
  state.refresh_inactive();    // atoms may have been sorted since they were chosen
  state.forward_bins();
}

void BlockSteps::apply_impulses()
{
  if (!state.clock.chosen) choose_bins();
  impulses.apply();
  half_kick.apply_deferred_impulses();
  impulses.note_total();
}

void BlockSteps::end_step() { bins.limit_vertices(); }

// It was chosen with the impulses that act in it.  The last step before an output time ends there,
// whatever was rounded on the way.

void BlockSteps::choose_step()
{
  impulses.note_external_forces();
  const BlockClock &clock = state.clock;
  const bool to_output = clock.reaches_output && clock.ends_base_step();
  const double dt = to_output ? clock.output_time - physical_time(update) : clock.smallest_step();
  parts.control.take(dt, clock.limit, to_output);
}

// The base step ends where it would have ended.  An output time before that would be missed.

void BlockSteps::shift_times(double by)
{
  Stepper::shift_times(by);
  double *slow_since = state.columns[Columns::SLOW_SINCE];
  for (int i = 0; i < atom->nlocal; i++) slow_since[i] += by;
  BlockClock &clock = state.clock;
  if (!clock.begun() || !parts.control.times.any()) return;
  constexpr double SLACK = 1e-6;    // of a step
  const double step = clock.smallest_step(), end = physical_time(update) + clock.line.remaining();
  clock.output_time = parts.control.times.next(step);
  clock.reaches_output = std::fabs(clock.output_time - end) < SLACK * step;
  if (!clock.reaches_output && clock.output_time < end)
    parts.control.refuse_reset(clock.output_time, end);
}

/* ----------------------------------------------------------------------
   what others ask
------------------------------------------------------------------------- */

void BlockSteps::find_intervals(std::vector<double> &of_type) const
{
  if (!state.clock.begun()) return;
  std::vector<double> updates(of_type.size(), 0.0), particles = updates;
  for (int i = 0; i < atom->nlocal; i++) {
    const int type = atom->type[i];
    if (!fluid->is_fluid(type) || state.is_asleep(i)) continue;
    updates[type] += std::ldexp(1.0, state.columns.bin(i) - state.clock.deepest);
    particles[type] += 1.0;
  }
  for (std::size_t t = 0; t < of_type.size(); t++)
    if (updates[t] > 0.0) of_type[t] = std::max(1.0, particles[t] / updates[t]);
}

// Particles that enter have no step behind them, and sleeping ones keep their density.

void BlockSteps::find_times_since_update(double *since) const
{
  const double now = physical_time(update);
  for (int i = 0; i < atom->nlocal; i++) {
    const double *row = parts.rows[i];
    const double time = state.is_new(i) ? 0.0 : now - row[UpdateRows::LAST_UPDATE];
    since[i] = row[UpdateRows::ACTIVE] != 0.0 ? time : -time;
    if (state.is_asleep(i)) since[i] = std::numeric_limits<double>::infinity();
  }
}

KeptDensity BlockSteps::kept_density()
{
  BlockColumns &columns = state.columns;
  constexpr int X = Columns::GRADIENT;
  return {columns[Columns::SUM],
          {columns[X], columns[X + 1], columns[X + 2]},
          columns[Columns::CHANGE]};
}

int BlockSteps::count_sleeping() const
{
  int n = 0;
  for (int i = 0; i < atom->nlocal; i++) n += fluid->is_fluid(atom->type[i]) && state.is_asleep(i);
  return n;
}

void BlockSteps::count_limits() const
{
  if (!state.clock.begun()) return;
  parts.report.forget_particles();
  for (int i = 0; i < atom->nlocal; i++)
    if (const double step = parts.rows[i][UpdateRows::OWN_STEP]; step > 0.0)
      parts.report.count_particle({step, limit_of(state.columns[Columns::BY][i])});
}

int BlockSteps::pack_forward(int n, const int *list, double *buf) const
{
  return state.pack_forward(n, list, buf);
}

void BlockSteps::unpack_forward(int n, int first, const double *buf)
{
  state.unpack_forward(n, first, buf);
}

int BlockSteps::pack_reverse(int n, int first, double *buf) const
{
  return state.pack_reverse(n, first, buf);
}

void BlockSteps::unpack_reverse(int n, const int *list, const double *buf)
{
  state.unpack_reverse(n, list, buf);
}

double BlockSteps::bytes() const
{
  return state.bytes() + bins.bytes() + sleeping.bytes() + impulses.bytes() + half_kick.bytes();
}
