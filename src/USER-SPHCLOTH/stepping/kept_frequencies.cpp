// SPDX-License-Identifier: GPL-2.0-or-later
// When frequencies are due.

#include "stepping/kept_frequencies.h"

#include "atom.h"
#include "fluid/fluid_state.h"

#include <algorithm>

using namespace LAMMPS_NS;

using Columns = BlockColumns;

static constexpr double LONGEST_INTERVAL = 8.0;    // updates
// A square of a frequency that has grown by more is found again in the next update: the stable step
// has become 5 % shorter.
static constexpr double SMALL_GROWTH = 0.1;

void KeptFrequencies::note()
{
  double *fluid_sq = state.columns[Columns::FLUID_SQ], *friction = state.columns[Columns::FRICTION];
  double *interval = state.columns[Columns::INTERVAL], *wait = state.columns[Columns::WAIT];
  for (const int i : state.fluid->active_particles()) {
    if (wait[i] > 0.0) {
      state.fluid->set_frequencies(i, {fluid_sq[i], 0.0, friction[i]});
      if (!state.clock.chosen) wait[i]--;
    } else if (!state.clock.chosen) {
      const Frequencies &its = state.fluid->frequencies(i);
      const bool grows = its.fluid_sq > (1.0 + SMALL_GROWTH) * fluid_sq[i];
      const bool begins = interval[i] == 0.0 || grows || !may_wait(i);
      interval[i] = begins ? 1.0 : std::min(2.0 * interval[i], LONGEST_INTERVAL);
      wait[i] = interval[i] - 1.0;
      fluid_sq[i] = its.fluid_sq;
      friction[i] = its.friction;
    }
  }
}

// Neighbors of a particle in free flight may be others in the next step, and so may the vertices
// beside one that has come near.

bool KeptFrequencies::may_wait(int i) const
{
  if (state.fluid->is_in_flight(i)) return false;
  const ScaledMass &scaled = state.fluid->scaled_mass();
  if (scaled.on() && scaled.is_beside_vertices(i)) return true;
  return !state.fluid->is_near_vertices(i);
}

void KeptFrequencies::forget()
{
  for (int i = 0; i < atom->nlocal; i++) state.forget_frequencies(i);
}
