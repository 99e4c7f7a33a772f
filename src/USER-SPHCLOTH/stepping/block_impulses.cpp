// SPDX-License-Identifier: GPL-2.0-or-later
// Forces become impulses.

#include "stepping/block_impulses.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "fluid/fluid_state.h"
#include "lammps_util/atom_tools.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

using Columns = BlockColumns;

// A step is far too long if the limit of the force that is found with it is so many times shorter.
static constexpr double TOO_LONG = 2.0;

void BlockImpulses::note_pair_forces()
{
  if (!found) return;
  pair_forces.resize(3 * static_cast<std::size_t>(atom->nmax), 0.0);
  copy_forces(pair_forces);
}

void BlockImpulses::note_total()
{
  total.resize(3 * static_cast<std::size_t>(atom->nmax), 0.0);
  copy_forces(total);
}

// on active particles, at least

void BlockImpulses::copy_forces(std::vector<double> &to) const
{
  const std::vector<int> &active = state.fluid->active_particles();
  const std::size_t n = atom->nlocal;
  if (2 * active.size() > n) {
    std::copy_n(atom->f[0], 3 * n, to.begin());
    return;
  }
  for (const int i : active) std::copy_n(atom->f[i], 3, to.begin() + 3 * i);
}

// What other styles have added, and with it the acceleration and the rate of the density from which
// the next step follows.  A particle whose step is far too long for them ends it.

void BlockImpulses::note_external_forces()
{
  double *external[3];
  for (int d = 0; d < 3; d++) external[d] = state.columns.external_force(d);
  for (const int i : state.fluid->active_particles())
    for (int d = 0; d < 3; d++) external[d][i] = atom->f[i][d] - total[3 * i + d];
  if (state.held.any()) note_held();
  if (!state.clock.uniform) note_rates();
}

void BlockImpulses::note_held()
{
  double *held = state.columns[Columns::HELD];
  for (const int i : state.fluid->active_particles())
    held[i] = state.held.axes(atom->mask[i], atom->x[i], atom->f[i]);
}

void BlockImpulses::note_rates()
{
  const double *external[3];
  for (int d = 0; d < 3; d++) external[d] = state.columns.external_force(d);
  double *accel_sq = state.columns[Columns::ACCEL_SQ], *rate = state.columns[Columns::DENSITY_RATE];
  pushed.clear();
  for (const int i : state.fluid->active_particles()) {
    double f_sq = 0.0;
    for (int d = 0; d < 3; d++) {
      const double f = forces[3 * i + d] + external[d][i];
      f_sq += f * f;
    }
    const double per_force = limits.acceleration(i, 1.0), a_sq = per_force * per_force * f_sq;
    // the step goes with its fourth root
    constexpr double TOO_MUCH = TOO_LONG * TOO_LONG * TOO_LONG * TOO_LONG;
    const bool faster = a_sq > TOO_MUCH * accel_sq[i];
    const bool compressed = std::fabs(atom->drho[i]) > TOO_LONG * std::fabs(rate[i]);
    accel_sq[i] = a_sq;
    rate[i] = atom->drho[i];
    if ((faster || compressed) && state.columns.bin(i) < state.clock.deepest) pushed.push_back(i);
  }
  if (state.options.waking) wake_pushed();
}

void BlockImpulses::wake_pushed()
{
  const ParticleLimits::Rates rates{nullptr, state.columns[Columns::ACCEL_SQ],
                                    state.columns[Columns::DENSITY_RATE]};
  limits.for_particles(pushed, rates, [&](int i, const StepLimit &limit) {
    const double step = state.clock.line.step(state.columns.bin(i));
    if (step > TOO_LONG * limit.dt && !state.is_asleep(i)) sleeping.wake(i);
  });
}

const Impulses *BlockImpulses::begin()
{
  found = state.clock.chosen && !state.clock.uniform;
  if (!found) return nullptr;
  find_spans();
  impulses = state.impulses(state.giving, true);
  return &impulses;
}

// For how long does the energy of each particle act?  What an impulse before gave too much is taken
// back, but friction does not run backwards.

void BlockImpulses::find_spans()
{
  if (sleeping.enabled()) state.find_sleeping();
  state.select_giving();
  state.begin_giving();
  const double *p_over_rho2 = state.fluid->p_over_rho2_of_all();
  const BlockColumns &columns = state.columns;
  for (const int i : state.giving) {
    const double half = state.half_step(i), ahead = columns[Columns::AHEAD][i];
    state.span[i] = std::max(0.0, half - ahead);
    state.impulse[i] = ahead > 0.0 ? half * p_over_rho2[i] - columns[Columns::TAKEN_BACK][i]
                                   : state.span[i] * p_over_rho2[i];
  }
}

void BlockImpulses::apply()
{
  if (state.clock.uniform) return apply_uniform();
  forces.resize(3 * static_cast<std::size_t>(atom->nmax), 0.0);
  copy_forces(forces);
  apply_by_bin();
}

// All particles take the same step: forces are impulses, but for a step that differs from the last.

void BlockImpulses::apply_uniform()
{
  state.forget_inactive();
  state.fluid->push_boundaries();
  if (const double times = state.clock.uniform_span; times != 1.0) {
    for (int i = 0; i < atom->nlocal; i++)
      for (int d = 0; d < 3; d++) atom->f[i][d] *= times;
    state.fluid->prolong_walls(times);
  }
  if (state.clock.some_sleep) let_sleep();
}

// The forces on those that are awake are complete: neighbors that sleep have their last pressures.

void BlockImpulses::let_sleep()
{
  state.find_sleeping();
  state.measure_ranges();
  for (const int i : state.fluid->active_particles())
    if (state.was_asleep(i)) std::fill_n(atom->f[i], 3, 0.0);
  state.select_giving();
  tell_neighbors();
  wake_marked();
}

void BlockImpulses::apply_by_bin()
{
  if (!found) {
    find_spans();
    state.fluid->find_pair_forces(pair_forces);
    state.fluid->give_impulses(state.impulses(state.giving, false));
  }
  for (const int i : state.giving) push_walls(i);
  state.refresh_inactive();
  tell_neighbors();
  hand_out();
  wake_marked();
}

// for the time beyond one smallest step

void BlockImpulses::push_walls(int i)
{
  const double smallest = state.clock.smallest_ticks();
  const double span = state.span[i] / smallest, impulse = state.impulse[i] / smallest;
  const double p_over_rho2 = state.fluid->p_over_rho2_of_all()[i];
  if (span != 1.0 || impulse != p_over_rho2)
    state.fluid->push_walls_more(i, impulse - p_over_rho2, span - 1.0);
}

// Impulses take the place of the forces between particles.

void BlockImpulses::hand_out()
{
  const double per_step = 1.0 / state.clock.smallest_ticks();
  for (const int i : state.fluid->active_particles()) {
    const bool falls_asleep = state.was_asleep(i);
    for (int d = 0; d < 3; d++)
      atom->f[i][d] = falls_asleep ? 0.0 : atom->f[i][d] - pair_forces[3 * i + d];
  }
  state.for_touched([&](int i) {
    for (int d = 0; d < 3; d++) atom->f[i][d] += per_step * state.given_to(i)[d];
  });
  state.end_giving();
}

// what they get, and what wakes them

void BlockImpulses::tell_neighbors()
{
  state.clear_ghost_marks();
  state.marked.clear();
  for (const int i : state.giving) mark_beside(i);
  if (sleeping.enabled()) sleeping.mark_beside_moving_boundaries();
  state.reverse_given();
}

// Neighbors that sleep, and those whose steps are too long for the particle's: where all particles
// are synchronized no other one is inactive.

void BlockImpulses::mark_beside(int i)
{
  if (!state.options.waking) return;
  const int allowed = state.columns.bin(i) - state.options.max_bin_difference();
  const bool any_inactive = !state.clock.all_synchronized() && allowed > 0;
  if (!any_inactive && !state.any_asleep) return;
  const int finest_allowed = any_inactive ? allowed : 0;
  DualLists &lists = state.fluid->order();
  const int slot = lists.slot(i);
  for (const int t : lists.present_types())
    if (state.fluid->is_fluid(t) &&
        lists.any_below(finest_allowed, slot, t, state.bin.data(), state.ranges_known))
      mark_slow(i, t, finest_allowed);
}

void BlockImpulses::mark_slow(int i, int type, int finest_allowed)
{
  const NeighborSpan near = state.fluid->neighbors(i, type);
  for (int k = 0; k < near.n; k++) {
    const int j = near.of[k], bin = state.bin[j];
    if (bin >= finest_allowed || !state.fluid->inside_support(i, j)) continue;
    if (bin == Columns::ASLEEP)
      state.mark_atom(j, sleeping.is_slow(i) ? BlockState::DISTURBED : BlockState::WAKE);
    else if (bin < state.coarsest)
      state.mark_atom(j, BlockState::WAKE);
  }
}

void BlockImpulses::wake_marked()
{
  const double now = physical_time(update);
  for (const int i : state.marked) {
    const bool asleep = state.is_asleep(i);
    if (state.mark[i] & BlockState::WAKE || (asleep && sleeping.has_slept_long(i, now)))
      sleeping.wake(i);
    state.mark[i] = BlockState::NOT_MARKED;
  }
}

double BlockImpulses::bytes() const { return bytes_of(pair_forces, forces, total, pushed); }
