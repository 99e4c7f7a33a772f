// SPDX-License-Identifier: GPL-2.0-or-later
// Sleeping particles.

#include "stepping/sleeping_water.h"

#include "atom.h"
#include "core/neighbor/dual_lists.h"
#include "core/util/bytes.h"
#include "domain.h"
#include "fluid/fluid_state.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/lammps_version.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

using Columns = BlockColumns;

// How long a particle is slow before it sleeps, and how long it sleeps beside active particles
// before it is asked again: in times that sound needs across the support.

static constexpr double SLOW_BEFORE_SLEEP = 20.0, SLEEP_BESIDE_ACTIVE = 100.0;

bool SleepingWater::is_slow(int i) const
{
  const double *v = atom->v[i], limit = state.options.sleep;
  return v[0] * v[0] + v[1] * v[1] + v[2] * v[2] < limit * limit;
}

bool SleepingWater::is_at_rest(int i)
{
  const double now = physical_time(update);
  double &since = state.columns[Columns::SLOW_SINCE][i];
  if (!is_slow(i)) since = now;
  if (now - since < SLOW_BEFORE_SLEEP * limits.sound_time(i) || state.fluid->feels_moving_wall(i))
    return false;
  return all_neighbors_are_slow(i);
}

bool SleepingWater::all_neighbors_are_slow(int i) const
{
  for (int t = 1; t <= atom->ntypes; t++) {
    const NeighborSpan near = state.fluid->neighbors(i, t);
    for (int k = 0; k < near.n; k++)
      if (!is_slow(near.of[k]) && state.fluid->inside_support(i, near.of[k])) return false;
  }
  return true;
}

void SleepingWater::find_resting()
{
  resting.clear();
  for (const int i : state.fluid->active_particles())
    if (is_at_rest(i)) resting.push_back(i);
  state.n_at_rest = static_cast<int>(resting.size());
  for (int i = 0; i < atom->nlocal; i++)
    state.n_at_rest += state.fluid->is_fluid(atom->type[i]) && state.is_asleep(i);
}

// Before forces are found: those that are found again where the next run begins are the same.

bool SleepingWater::stop_resting()
{
  find_resting();
  const int here = resting.empty() ? 0 : 1;
  int anywhere;
  MPI_Allreduce(&here, &anywhere, 1, MPI_INT, MPI_MAX, world);
  if (!anywhere) return false;
  state.make_room();
  std::fill_n(state.kicks.begin(), 3 * atom->nlocal, 0.0);
  for (const int i : resting)
    for (int d = 0; d < 3; d++) {
      state.kicks[3 * i + d] = -atom->v[i][d];
      atom->v[i][d] = 0.0;
    }
  state.forward_kicks();
  return true;
}

void SleepingWater::fall_asleep()
{
  for (const int i : resting) {
    state.columns[Columns::BIN][i] = state.bin[i] = Columns::ASLEEP;
    state.columns[Columns::SLOW_SINCE][i] = physical_time(update);
    state.ranges_known = false;
  }
}

void SleepingWater::begin_run()
{
  n_atoms = atom->natoms;
  if (!enabled()) return;
  const std::uint64_t fixes = limits.fixes_that_hold(true);
  if (fixes != state.clock.fixes)
    for (int i = 0; i < atom->nlocal; i++) disturb(i);
  state.clock.fixes = fixes;
}

// Contact or a command has given it speed, another force acts on it than when it fell asleep, or a
// wall beside it moves.

void SleepingWater::wake_disturbed()
{
  if (!enabled()) return;
  const bool some_vanished = atom->natoms < n_atoms;
  n_atoms = atom->natoms;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!state.fluid->is_fluid(atom->type[i]) || !state.is_asleep(i)) continue;
    double change_sq = 0.0;
    for (int d = 0; d < 3; d++) {
      const double change = atom->f[i][d] - state.columns.external_force(d)[i];
      change_sq += change * change;
    }
    if (some_vanished || !is_slow(i) || gains_speed(i, change_sq) ||
        state.fluid->feels_moving_wall(i)) {
      wake(i);
      for (int d = 0; d < 3; d++) state.columns.external_force(d)[i] = atom->f[i][d];
    }
  }
}

// By a force that is unlike any, which restart files have, too.

void SleepingWater::disturb(int i)
{
  if (state.is_asleep(i))
    state.columns.external_force(0)[i] = std::numeric_limits<double>::infinity();
}

void SleepingWater::wake_beside(const std::vector<std::array<double, 3>> &positions)
{
  n_atoms -= static_cast<bigint>(positions.size());
  for (int i = 0; i < atom->nlocal; i++) {
    if (!state.fluid->is_fluid(atom->type[i]) || !state.is_asleep(i)) continue;
    const double support = state.fluid->support(atom->type[i]);
    for (const auto &position : positions) {
      double away[3], sq = 0.0;
      for (int d = 0; d < 3; d++) away[d] = atom->x[i][d] - position[d];
      release::minimum_image(domain, away);
      for (const double a : away) sq += a * a;
      if (sq < support * support) disturb(i);
    }
  }
}

// from a force, squared, for as long as water has to be slow before it sleeps

bool SleepingWater::gains_speed(int i, double force_sq) const
{
  if (force_sq == 0.0) return false;
  const double accel = limits.acceleration(i, std::sqrt(force_sq));
  return SLOW_BEFORE_SLEEP * limits.sound_time(i) * accel > state.options.sleep;
}

void SleepingWater::mark_beside_moving_boundaries()
{
  for (const int i : state.boundaries)
    if (!is_slow(i)) wake_neighbors(i);
}

void SleepingWater::wake_neighbors(int i)
{
  for (int t = 1; t <= atom->ntypes; t++) {
    const NeighborSpan near = state.fluid->neighbors(i, t);
    for (int k = 0; k < near.n; k++) {
      const int j = near.of[k];
      if (state.asleep[j] && state.fluid->inside_support(i, j))
        state.mark_atom(j, BlockState::WAKE);
    }
  }
}

bool SleepingWater::has_slept_long(int i, double now) const
{
  return now - state.columns[Columns::SLOW_SINCE][i] > SLEEP_BESIDE_ACTIVE * limits.sound_time(i);
}

void SleepingWater::wake(int i)
{
  BlockColumns &columns = state.columns;
  if (columns.is_asleep(i)) {
    columns[Columns::BIN][i] = state.clock.deepest;
    columns[Columns::EVENT][i] = Columns::NEW;
    columns[Columns::SLOW_SINCE][i] = physical_time(update);
    state.forget_frequencies(i);
  } else if (!state.is_new(i))
    columns[Columns::EVENT][i] = Columns::WOKEN;
}

double SleepingWater::bytes() const { return bytes_of(resting); }
