// SPDX-License-Identifier: GPL-2.0-or-later
// Steps of individual particles as in (13) to (15) of the paper.

#include "stepping/individual_steps.h"

#include "core/util/bytes.h"
#include "force.h"
#include "lammps_util/atom_tools.h"
#include "stepping/step_report.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

IndividualSteps::IndividualSteps(LAMMPS *lmp_, const SteppingParts &parts_) : Stepper(lmp_, parts_)
{
  kept.create(IndividualColumns::N_COLUMNS, atom->nmax);
}

void IndividualSteps::move()
{
  drift();
  select_active();
}

// From the last update, a time T ago, to now: v = v_last + T a, x = x_last + T v.  What is added to
// v and x in one step follows, so that other fixes may move a particle in between.

void IndividualSteps::drift()
{
  const double dt = update->dt, before = physical_time(update) - dt;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & parts.fix->groupbit)) continue;
    const double elapsed = before - parts.rows[i][UpdateRows::LAST_UPDATE];
    const double kick = parts.first_kick.share(i) * dt;
    double *x = atom->x[i], *v = atom->v[i];
    for (int d = 0; d < 3; d++) {
      const double accel = kept[IndividualColumns::ACCELERATION + d][i];
      v[d] += kick * accel;
      x[d] += dt * (v[d] + elapsed * accel);
    }
  }
}

// (15): particles whose own step, in whole steps of now, divides the number of the step; and, if
// asked, (14): those whose own step has passed, which (15) may pass over, since both steps change.
// The density of inactive particles is interpolated, line 12.

void IndividualSteps::select_active()
{
  const double dt = update->dt, now = physical_time(update);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & parts.fix->groupbit)) continue;
    double *row = parts.rows[i];
    const double own_step = row[UpdateRows::OWN_STEP];
    const double wait = (now - row[UpdateRows::LAST_UPDATE]) / own_step;
    const bool active = parts.control.steps() % whole_steps(own_step, dt) == 0 ||
        (parts.options.overdue && wait > 1.0);
    row[UpdateRows::ACTIVE] = active;
    if (active)
      parts.report.count_update(wait);
    else
      atom->rho[i] += dt * kept[IndividualColumns::DENSITY_RATE][i];
  }
  tell_active(false);
}

void IndividualSteps::choose_step()
{
  const StepLimit tightest = tightest_limit();
  parts.control.choose(tightest, limited);
}

StepLimit IndividualSteps::tightest_limit()
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
  updated.clear();
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & parts.fix->groupbit)) continue;
    const double *row = parts.rows[i];
    if (row[UpdateRows::ACTIVE] != 0.0)
      updated.push_back(i);
    else
      take(i, {row[UpdateRows::OWN_STEP], limit_of(kept[IndividualColumns::LIMITED_BY][i])});
  }
  parts.limits.for_particles(updated, {}, [&](int i, const StepLimit &limit) {
    keep(i, limit, now);
    take(i, limit);
  });
  parts.limits.for_vertices(take);
  return tightest;
}

// until the next update

void IndividualSteps::keep(int i, const StepLimit &limit, double now)
{
  parts.rows[i][UpdateRows::OWN_STEP] = std::min(limit.dt, parts.options.ceiling);
  parts.rows[i][UpdateRows::LAST_UPDATE] = now;
  const double to_accel = force->ftm2v / atom_mass(atom, i);
  for (int d = 0; d < 3; d++)
    kept[IndividualColumns::ACCELERATION + d][i] = to_accel * atom->f[i][d];
  kept[IndividualColumns::DENSITY_RATE][i] = atom->drho[i];
  kept[IndividualColumns::LIMITED_BY][i] = static_cast<double>(limit.by);
}

double IndividualSteps::bytes() const { return kept.bytes() + bytes_of(updated); }
