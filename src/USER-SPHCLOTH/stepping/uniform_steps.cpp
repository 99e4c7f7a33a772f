// SPDX-License-Identifier: GPL-2.0-or-later
// One step for all particles, constant or by the tightest limit anywhere.

#include "stepping/uniform_steps.h"

#include "core/util/bytes.h"
#include "stepping/kick_drift.h"
#include "stepping/step_report.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

void UniformSteps::move()
{
  const UpdateRows &rows = parts.rows;
  const Moved n = kick_and_drift(atom, update, force, parts.fix->groupbit,
                                 [&](int i) { return rows[i][UpdateRows::ACTIVE] == 0.0; });
  parts.report.updates += n.moved;
  tell_active(n.at_rest == 0);
}

void UniformSteps::choose_step()
{
  if (constant) return;
  const StepLimit tightest = tightest_limit();
  parts.control.choose(tightest, limited);
}

StepLimit UniformSteps::tightest_limit()
{
  const double now = physical_time(update);
  StepLimit tightest;
  limited = 0;
  parts.report.forget_particles();
  const auto take = [&](int i, const StepLimit &limit) {
    parts.report.count_particle(limit);
    if (limit.dt < tightest.dt) limited = atom->tag[i];
    tightest.tighten(limit.dt, limit.by);
  };
  integrated.clear();
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & parts.fix->groupbit) integrated.push_back(i);
  parts.limits.for_particles(integrated, nullptr, [&](int i, const StepLimit &limit) {
    double *row = parts.rows[i];
    row[UpdateRows::OWN_STEP] = std::min(limit.dt, parts.options.ceiling);
    row[UpdateRows::LAST_UPDATE] = now;
    take(i, limit);
  });
  parts.limits.for_vertices(take);
  return tightest;
}

double UniformSteps::bytes() const { return bytes_of(integrated); }
