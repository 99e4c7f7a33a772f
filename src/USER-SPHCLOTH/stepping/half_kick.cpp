// SPDX-License-Identifier: GPL-2.0-or-later
// Half-kick correction at output times.

#include "stepping/half_kick.h"

#include "atom.h"
#include "core/neighbor/dual_lists.h"
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
  find_spans();
  state.forward_impulses();
  const std::size_t n = 3 * static_cast<std::size_t>(atom->nlocal);
  forces.resize(n);
  if (n > 0) {
    std::copy_n(atom->f[0], n, forces.begin());
    std::fill_n(atom->f[0], n, 0.0);
  }
  sum_impulses();
  kick();
  if (n > 0) std::copy_n(forces.begin(), n, atom->f[0]);
  state.forward_kicks();
  return true;
}

// the time from the end of a particle's impulses to that of particles with the smallest step

void HalfKick::find_spans()
{
  const double smallest = state.clock.smallest_ticks();
  const double until = static_cast<double>(state.clock.line.now) - 0.5 * smallest;
  double *reach = state.columns[Columns::REACH];
  state.select_impelled();
  for (const int i : state.fluid->active_particles()) {
    const bool integrated = atom->mask[i] & state.fix->groupbit;
    const bool is_new = state.columns[Columns::EVENT][i] == Columns::NEW;
    const double behind = integrated && !is_new ? until - reach[i] : 0.0;
    state.span[i] = std::max(0.0, behind) / smallest;
    state.impulse[i] = state.span[i] * state.fluid->p_over_rho2_of_all()[i];
    if (behind > 0.0) reach[i] = until;
  }
}

void HalfKick::sum_impulses()
{
  FluidState *fluid = state.fluid;
  slots.clear();
  for (const int i : fluid->active_particles()) {
    if (state.span[i] > 0.0) fluid->push_walls_more(i, state.impulse[i], state.span[i]);
    slots.push_back(fluid->order().slot(i));
  }
  for (const int i : state.boundaries)
    if (fluid->is_boundary(atom->type[i])) slots.push_back(fluid->order().slot(i));
  fluid->give_impulses(slots, state.impulse.data(), state.span.data());
}

void HalfKick::kick()
{
  const double step = state.clock.smallest_step();
  std::vector<double> &kicks = state.kicks;
  std::fill_n(kicks.begin(), 3 * atom->nlocal, 0.0);
  for (const int i : state.fluid->active_particles()) {
    if (!(atom->mask[i] & state.fix->groupbit)) continue;
    for (int d = 0; d < 3; d++) {
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

double HalfKick::bytes() const { return bytes_of(forces) + bytes_of(slots); }
