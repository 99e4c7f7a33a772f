// SPDX-License-Identifier: GPL-2.0-or-later
// Counters and outputs of fix sph/integrate.

#include "stepping/step_report.h"

#include "atom.h"
#include "fluid/adaptive_sound.h"
#include "stepping/block_state.h"
#include "stepping/stepper.h"

using namespace LAMMPS_NS;
using namespace sphcloth;

double StepReport::output(int n, Stepper &stepper, StepControl &control, const AdaptiveSound &sound,
                          const UpdateRows &rows) const
{
  const bool has_bins = stepper.clock() && stepper.clock()->begun();
  switch (n) {
    case LIMIT_IN_FORCE: return static_cast<double>(control.limited_by());
    case ACTIVE_FRACTION: return active_fraction(rows);
    case PARTICLE_UPDATES: return sum_of_ranks(updates);
    case LARGEST_COMPRESSION: return max_of_ranks(control.largest_compression());
    case STEPS_AT_FLOOR: return steps_by_limit[static_cast<int>(Limit::FLOOR)];
    case IS_OUTPUT_TIME: return control.times.is_now();
    case NEXT_THERMO_STEP: return static_cast<double>(control.times.next_thermo());
    case SLEEPING_PARTICLES: return has_bins ? sum_of_ranks(stepper.count_sleeping()) : 0.0;
    case IDEAL_UPDATES: return has_bins ? sum_of_ranks(ideal_updates) : 0.0;
    case LONGEST_WAIT: return max_of_ranks(longest_wait);
    case MEAN_WAIT: return mean_wait();
    case SOUND_SPEED: return control.fastest_sound();
    case SOUND_WORK: return sum_of_ranks(sound.work);
    case PAIR_EVALUATIONS: return sum_of_ranks(pair_evaluations);
    default: break;
  }
  if (n < PARTICLES_BY_LIMIT) return steps_by_limit[n - STEPS_BY_LIMIT + 1];
  stepper.count_limits();
  return sum_of_ranks(particles_by_limit[n - PARTICLES_BY_LIMIT + 1]);
}

double StepReport::active_fraction(const UpdateRows &rows) const
{
  double mine[2] = {0.0, 0.0}, all[2];
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) {
      mine[0] += rows[i][UpdateRows::ACTIVE];
      mine[1] += 1.0;
    }
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, world);
  return all[1] > 0.0 ? all[0] / all[1] : 0.0;
}

double StepReport::mean_wait() const
{
  const double n_updates = sum_of_ranks(updates);
  return n_updates > 0.0 ? sum_of_ranks(waits) / n_updates : 0.0;
}

std::string StepReport::waits_in_words() const
{
  return fmt::format(
      ": updates after {:.3g} of the particle's own step on average, {:.3g} at most\n", mean_wait(),
      max_of_ranks(longest_wait));
}

std::string StepReport::steps_in_words() const
{
  std::string words;
  for (int k = 1; k < N_LIMITS; k++)
    if (steps_by_limit[k] > 0.0)
      words += fmt::format(" {} {:.0f}", limit_name(static_cast<Limit>(k)), steps_by_limit[k]);
  return words;
}

double StepReport::sum_of_ranks(double mine) const
{
  double all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

double StepReport::max_of_ranks(double mine) const
{
  double all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all;
}
