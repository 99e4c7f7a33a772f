// SPDX-License-Identifier: GPL-2.0-or-later
// Half-kick correction at output times.

#include "stepping/half_kick.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "fluid/fluid_state.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

using Columns = BlockColumns;

bool HalfKick::correct_velocities()
{
  const BlockClock &clock = state.clock;
  if (clock.chosen || !clock.reaches_output || !clock.line.ended() || clock.uniform) return false;
  state.make_room();
  state.refresh_inactive();
  if (state.options.sleep > 0.0) state.find_sleeping();
  state.select_giving();
  state.begin_giving();
  find_spans();
  const std::size_t n = 3 * static_cast<std::size_t>(atom->nlocal);
  forces.resize(n);
  if (n > 0) {
    std::copy_n(atom->f[0], n, forces.begin());
    std::fill_n(atom->f[0], n, 0.0);
  }
  give_impulses();
  kick();
  if (n > 0) std::copy_n(forces.begin(), n, atom->f[0]);
  state.forward_kicks();
  return true;
}

// the time from the end of a particle's impulses to that of particles with the smallest step

void HalfKick::find_spans()
{
  const double until =
      static_cast<double>(state.clock.line.now) - 0.5 * state.clock.smallest_ticks();
  double *reach = state.columns[Columns::REACH];
  for (const int i : state.giving) {
    const bool integrated = atom->mask[i] & state.fix->groupbit;
    const double behind = integrated && !state.is_new(i) ? until - reach[i] : 0.0;
    state.span[i] = std::max(0.0, behind);
    state.impulse[i] = state.span[i] * state.fluid->p_over_rho2_of_all()[i];
    if (behind > 0.0) reach[i] = until;
  }
}

// as forces for one smallest step

void HalfKick::give_impulses()
{
  const double per_step = 1.0 / state.clock.smallest_ticks();
  late.clear();
  for (const int i : state.giving) {
    if (!(state.span[i] > 0.0)) continue;
    late.push_back(i);
    state.fluid->push_walls_more(i, per_step * state.impulse[i], per_step * state.span[i]);
  }
  state.fluid->give_impulses(state.impulses(late, false));
  state.clear_ghost_marks();
  state.reverse_given();
  state.for_touched([&](int i) {
    for (int d = 0; d < 3; d++) atom->f[i][d] += per_step * state.given_to(i)[d];
  });
  state.end_giving();
}

void HalfKick::kick()
{
  const double step = state.clock.smallest_step();
  std::vector<double> &kicks = state.kicks;
  std::fill_n(kicks.begin(), 3 * atom->nlocal, 0.0);
  for (const int i : state.fluid->active_particles()) {
    if (!(atom->mask[i] & state.fix->groupbit)) continue;
    for (int d = 0; d < 3; d++) {
      if (state.is_held(i, d)) continue;
      kicks[3 * i + d] = step * limits.acceleration(i, atom->f[i][d]);
      atom->v[i][d] += kicks[3 * i + d];
    }
  }
  state.clock.defers = true;
  BlockColumns &columns = state.columns;
  for (const int i : state.boundaries)
    for (int d = 0; d < 3; d++) columns.deferred_impulse(d)[i] = step * atom->f[i][d];
  state.fluid->hand_over_pushes([&](int i, const Eigen::Vector3d &push) {
    for (int d = 0; d < 3; d++) columns.deferred_impulse(d)[i] += step * push[d];
  });
}

void HalfKick::apply_deferred_impulses()
{
  if (!state.clock.defers) return;
  state.refresh_inactive();
  const double step = state.clock.smallest_step();
  for (const int i : state.boundaries)
    for (int d = 0; d < 3; d++) atom->f[i][d] += state.columns.deferred_impulse(d)[i] / step;
}

double HalfKick::bytes() const { return bytes_of(forces) + bytes_of(late); }
