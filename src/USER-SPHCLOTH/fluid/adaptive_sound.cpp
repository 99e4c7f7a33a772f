// SPDX-License-Identifier: GPL-2.0-or-later
// Speeds of sound that follow the flow.

#include "fluid/adaptive_sound.h"

#include "atom.h"
#include "domain.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "lammps_util/atom_tools.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

void AdaptiveSound::begin_run(FluidState *style)
{
  fluid = style;
  if (!on() && fluid->sound_follows()) {
    columns.create(1, atom->nmax);
    elapsed = 0.0;
  }
  if (!on()) return;
  fluid->lattices.set_expansion(&columns);
  const int n = atom->ntypes + 1;
  followers.clear();
  for (int t = 1; t < n; t++)
    if (fluid->type(t).sound.follows()) followers.push_back(t);
  volumes_here.assign(n, 0.0);
  volumes.assign(n, 0.0);
  counts_here.resize(followers.size() * SoundCounts::N);
  counts_of_ranks.resize(followers.size() * SoundCounts::N);
}

// What all but a few particles of each follower ask for, the same on all ranks, since numbers of
// particles are exact; and the volumes of all fluids.

void AdaptiveSound::measure()
{
  counts.clear();
  for (const int t : followers) {
    counts.emplace_back(fluid->type(t).sound);
    const Tait &eos = fluid->equation_of_state(t);
    for (int i = 0; i < atom->nlocal; i++) {
      if (atom->type[i] != t) continue;
      const double *v = atom->v[i];
      const double head = fluid->acting_pressure(eos, atom->rho[i]) / eos.rho0;
      counts.back().add(std::max(v[0] * v[0] + v[1] * v[1] + v[2] * v[2], head));
    }
    std::copy(counts.back().counts.begin(), counts.back().counts.end(),
              &counts_here[(counts.size() - 1) * SoundCounts::N]);
  }
  MPI_Allreduce(counts_here.data(), counts_of_ranks.data(), static_cast<int>(counts_here.size()),
                MPI_INT64_T, MPI_SUM, world);
  for (std::size_t k = 0; k < counts.size(); k++)
    std::copy_n(&counts_of_ranks[k * SoundCounts::N], SoundCounts::N, counts[k].counts.begin());

  std::fill(volumes_here.begin(), volumes_here.end(), 0.0);
  for (int i = 0; i < atom->nlocal; i++)
    if (const int t = atom->type[i]; fluid->is_fluid(t))
      volumes_here[t] += atom_mass(atom, i) / fluid->equation_of_state(t).rho0;
  MPI_Allreduce(volumes_here.data(), volumes.data(), atom->ntypes + 1, MPI_DOUBLE, MPI_SUM, world);
}

bool AdaptiveSound::update()
{
  if (!on() || elapsed < due()) return false;
  measure();
  for (int t = 1; t <= atom->ntypes; t++)
    if (volumes[t] > 0.0)
      restore_positions(
          t, expansion_left(fluid->equation_of_state(t).sound_speed(), elapsed, size(t)));
  bool any = false;
  for (std::size_t k = 0; k < followers.size(); k++) {
    const int t = followers[k];
    if (!(volumes[t] > 0.0)) continue;
    const Tait &eos = fluid->equation_of_state(t);
    const double now = eos.sound_speed(), lasted = fluid->type(t).sound_unchanged_for + elapsed;
    const double next =
        next_sound(now, counts[k].wanted(), lasted, 0.5 * fluid->support(t), size(t));
    if (next == now) {
      fluid->set_stiffness(t, eos.k, lasted);
      continue;
    }
    change(t, next);
    any = true;
  }
  elapsed = 0.0;
  return any;
}

// Often enough for the fastest rise: in times in which sound crosses a smoothing length.

double AdaptiveSound::due() const
{
  constexpr double EVERY = 2.0;
  double shortest = std::numeric_limits<double>::infinity();
  for (int t = 1; t <= atom->ntypes; t++)
    if (fluid->is_fluid(t))
      shortest = std::min(
          shortest, EVERY * 0.5 * fluid->support(t) / fluid->equation_of_state(t).sound_speed());
  return shortest;
}

// length of a cube, or side of a square, of its volume

double AdaptiveSound::size(int type) const
{
  return std::pow(volumes[type], 1.0 / domain->dimension);
}

// A density other than that of the positions returns to it.

void AdaptiveSound::restore_positions(int type, double left)
{
  const Tait &eos = fluid->equation_of_state(type);
  const double *e = columns[0];
  for (int i = 0; i < atom->nlocal; i++) {
    if (atom->type[i] != type || e[i] == 0.0) continue;
    const double rho = atom->rho[i], next = rho * (1.0 + left * e[i]) / (1.0 + e[i]);
    const double p = fluid->acting_pressure(eos, 0.5 * (rho + next));
    set_density(i, next, p * (next - rho) / (rho * next));
  }
}

// Without tension, what is thinner than at rest has no pressure that could change.

void AdaptiveSound::change(int type, double sound)
{
  const Tait before = fluid->equation_of_state(type);
  fluid->change_stiffness(type, sound * sound);
  const Tait &next = fluid->equation_of_state(type);
  for (int i = 0; i < atom->nlocal; i++) {
    if (atom->type[i] != type) continue;
    const double rho = atom->rho[i];
    if (rho <= before.rho0 && !fluid->options.tension) continue;
    const double same = density_of_same_pressure(before, next, rho);
    set_density(i, same, fluid->stored_energy(next, same) - fluid->stored_energy(before, rho));
  }
}

void AdaptiveSound::set_density(int i, double rho, double work_per_mass)
{
  work += atom_mass(atom, i) * work_per_mass * force->mvv2e;
  columns[0][i] = (1.0 + columns[0][i]) * rho / atom->rho[i] - 1.0;
  atom->rho[i] = rho;
}
