// SPDX-License-Identifier: GPL-2.0-or-later
// Forces become impulses.

#include "stepping/block_impulses.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "fluid/fluid_state.h"
#include "lammps_util/atom_tools.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

using Columns = BlockColumns;

void BlockImpulses::note_pair_forces()
{
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

void BlockImpulses::note_external_forces()
{
  double *external[3];
  for (int d = 0; d < 3; d++) external[d] = state.columns.external_force(d);
  for (const int i : state.fluid->active_particles())
    for (int d = 0; d < 3; d++) external[d][i] = atom->f[i][d] - total[3 * i + d];
}

void BlockImpulses::apply()
{
  if (state.clock.uniform)
    apply_uniform();
  else
    apply_by_bin();
}

// All particles take the same step: forces are impulses, but for a step that differs from the last.

void BlockImpulses::apply_uniform()
{
  state.forget_inactive();
  state.fluid->push_boundaries();
  const double times = state.clock.uniform_span;
  if (times == 1.0) return;
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) atom->f[i][d] *= times;
  state.fluid->prolong_walls(times);
}

// A particle whose neighbors all take its step, and took the same before, has the force itself for
// all of its time.  For others it is summed anew, pair by pair.

void BlockImpulses::apply_by_bin()
{
  find_spans();
  state.forward_impulses();
  if (state.clock.all_synchronized()) state.fluid->order().measure_block_ranges(state.key.data());
  state.clear_ghost_marks();
  state.marked.clear();
  slots.clear();
  for (const int i : state.fluid->active_particles()) {
    if (state.is_asleep(i))    // since now
      std::fill_n(atom->f[i], 3, 0.0);
    else if (neighbors_share_step(i))
      add_pair_force(i, state.span[i] - 1.0);
    else {
      add_pair_force(i, -1.0);
      slots.push_back(state.fluid->order().slot(i));
    }
  }
  if (sleeping.enabled()) sleeping.mark_beside_moving_boundaries();
  state.reverse_marks();
  wake_marked();
  state.fluid->give_impulses(slots, state.impulse.data(), state.span.data());
}

// For how long does the energy of each particle act?  What an impulse before gave too much is taken
// back, but friction does not run backwards.

void BlockImpulses::find_spans()
{
  const double smallest = state.clock.smallest_ticks();
  const double *p_over_rho2 = state.fluid->p_over_rho2_of_all();
  const BlockColumns &columns = state.columns;
  state.select_impelled();
  for (const int i : state.fluid->active_particles()) {
    if (state.is_asleep(i)) {
      state.set_inactive(i);
      continue;
    }
    const double half = state.half_step(i), ahead = columns[Columns::AHEAD][i];
    state.span[i] = std::max(0.0, half - ahead) / smallest;
    state.impulse[i] = ahead > 0.0
        ? (half * p_over_rho2[i] - columns[Columns::TAKEN_BACK][i]) / smallest
        : state.span[i] * p_over_rho2[i];
    state.key[i] = StepKey::of(columns.bin(i), static_cast<int>(columns[Columns::BIN_BEFORE][i]));
  }
}

// adds `times` the force of other particles, and walls for the time beyond one smallest step

void BlockImpulses::add_pair_force(int i, double times)
{
  if (times != 0.0)
    for (int d = 0; d < 3; d++) atom->f[i][d] += times * pair_forces[3 * i + d];
  const double p_over_rho2 = state.fluid->p_over_rho2_of_all()[i];
  if (state.span[i] != 1.0 || state.impulse[i] != p_over_rho2)
    state.fluid->push_walls_more(i, state.impulse[i] - p_over_rho2, state.span[i] - 1.0);
}

// Do the particle and its neighbors have impulses for the same time?  Neighbors that have none are
// marked, since they feel one.

bool BlockImpulses::neighbors_share_step(int i)
{
  DualLists &lists = state.fluid->order();
  const int slot = lists.slot(i), key_i = state.key[i];
  bool share = StepKey::before(key_i) != StepKey::BROKEN;
  for (const int t : lists.present_types()) {
    const NeighborSpan others =
        lists.others(key_i, slot, t, state.key.data(), state.clock.all_synchronized());
    if (others.n > 0) share = examine(i, t, others) && share;
  }
  return share;
}

// Neighbors of one type that have another key.  Where all particles are synchronized no particle is
// inactive.

bool BlockImpulses::examine(int i, int type, const NeighborSpan &others)
{
  const std::vector<int> &key = state.key;
  if (state.clock.all_synchronized() && !sleeping.enabled() && state.fluid->is_fluid(type))
    return false;
  const int allowed = state.options.max_bin_difference();
  bool share = true;
  for (int k = 0; k < others.n; k++) {
    const int j = others.of[k];
    if (key[j] == StepKey::BOUNDARY) {
      state.mark_atom(j, BlockState::FEELS_IMPULSE);
      continue;
    }
    if (StepKey::before(key[j]) == StepKey::SLEEPING) {
      disturb_sleeping(i, j);
      continue;
    }
    share = false;
    if (StepKey::before(key[j]) != StepKey::INACTIVE) continue;
    const bool slow = StepKey::bin(key[i]) - StepKey::bin(key[j]) > allowed;
    const bool wakes = state.options.waking && slow && state.fluid->inside_support(i, j);
    state.mark_atom(j, BlockState::FEELS_IMPULSE | (wakes ? BlockState::WAKE : 0));
  }
  return share;
}

void BlockImpulses::disturb_sleeping(int i, int j)
{
  if (!state.options.waking || !state.fluid->inside_support(i, j)) return;
  state.mark_atom(j, sleeping.is_slow(i) ? BlockState::FEELS_IMPULSE : BlockState::WAKE);
}

void BlockImpulses::wake_marked()
{
  const double now = physical_time(update);
  for (const int i : state.marked) {
    const bool asleep = StepKey::before(state.key[i]) == StepKey::SLEEPING;
    if (!asleep) slots.push_back(state.fluid->order().slot(i));
    if (state.mark[i] & BlockState::WAKE || (asleep && sleeping.has_slept_long(i, now)))
      sleeping.wake(i);
    state.mark[i] = BlockState::NOT_MARKED;
  }
}

double BlockImpulses::bytes() const { return bytes_of(pair_forces, total, slots); }
