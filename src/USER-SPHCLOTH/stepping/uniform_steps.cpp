// SPDX-License-Identifier: GPL-2.0-or-later
// One step for all particles, constant or by the tightest limit anywhere.

#include "stepping/uniform_steps.h"

#include "core/util/bytes.h"
#include "fluid/fluid_state.h"
#include "stepping/kick_drift.h"
#include "stepping/step_report.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

// what will be under pressure before the limit is found again counts
static_assert(FluidStability::STEPS_AHEAD >= StabilityWatch::LONGEST_WAIT);

void UniformSteps::init(FluidState *style, Change change)
{
  Stepper::init(style, change);
  if (!constant) parts.control.watch.begin_run(parts.limits.settings(), change != Change::NOTHING);
  fluid->want_frequencies_now(!constant && parts.control.watch.due());
}

void UniformSteps::move()
{
  parts.control.watch.begin_step();
  fluid->want_frequencies_now(!constant && parts.control.watch.due());
  const UpdateRows &rows = parts.rows;
  const Moved n = kick_and_drift(
      atom, update, force, parts.fix->groupbit,
      [&](int i) { return rows[i][UpdateRows::ACTIVE] == 0.0; },
      [&](int i) { return parts.first_kick.share(i); });
  parts.report.updates += n.moved;
  tell_active(n.at_rest == 0);
}

void UniformSteps::choose_step()
{
  if (constant) return;
  integrated.clear();
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & parts.fix->groupbit) integrated.push_back(i);
  if (parts.options.lambda.stability > 0.0 && parts.control.watch.due()) find_stable_step();
  const StepLimit tightest = tightest_limit();
  parts.control.choose(tightest, limited);
}

// Of all ranks.  A step that no pressure allows is one of free flight.

void UniformSteps::find_stable_step()
{
  constexpr double LONGEST_UNDER_PRESSURE = 2.0;    // of h_s/c0
  StepLimit mine;
  tagint particle = 0;
  for (const int i : integrated) {
    const StepLimit limit = parts.limits.stable_limit(i);
    parts.rows[i][UpdateRows::STABLE_STEP] = limit.dt;
    parts.rows[i][UpdateRows::STABLE_BY] = static_cast<double>(limit.by);
    if (limit.dt < mine.dt) particle = atom->tag[i];
    mine.tighten(limit.dt, limit.by);
  }
  const StepLimit tightest = parts.control.tightest_of_ranks(mine);
  const bool in_flight = tightest.dt > LONGEST_UNDER_PRESSURE * parts.limits.shortest_sound_time();
  parts.control.watch.found(tightest, parts.control.owner_of(tightest, mine, particle), in_flight);
}

StepLimit UniformSteps::tightest_limit()
{
  const double now = physical_time(update);
  StepLimit tightest;
  limited = 0;
  parts.report.forget_particles();
  const auto tighten = [&](int i, const StepLimit &limit) {
    if (limit.dt < tightest.dt) limited = atom->tag[i];
    tightest.tighten(limit.dt, limit.by);
  };
  parts.limits.for_particles(integrated, {}, [&](int i, const StepLimit &others) {
    double *row = parts.rows[i];
    StepLimit limit = others;
    if (const double stable = row[UpdateRows::STABLE_STEP]; stable > 0.0)
      limit.tighten(stable, limit_of(row[UpdateRows::STABLE_BY]));
    row[UpdateRows::OWN_STEP] = std::min(limit.dt, parts.options.ceiling);
    row[UpdateRows::LAST_UPDATE] = now;
    parts.report.count_particle(limit);
    tighten(i, others);
  });
  parts.limits.for_vertices([&](int i, const StepLimit &limit) {
    parts.report.count_particle(limit);
    tighten(i, limit);
  });
  const StabilityWatch::State &watch = parts.control.watch.state();
  if (watch.tightest.dt < tightest.dt) limited = watch.particle;
  tightest.tighten(watch.tightest.dt, watch.tightest.by);
  return tightest;
}

double UniformSteps::bytes() const { return bytes_of(integrated); }
