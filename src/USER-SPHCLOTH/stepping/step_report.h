// SPDX-License-Identifier: GPL-2.0-or-later
// What fix sph/integrate tells: counters, and the outputs f_ID[1] to f_ID[36].

#ifndef SPHCLOTH_STEPPING_STEP_REPORT_H
#define SPHCLOTH_STEPPING_STEP_REPORT_H

#include "pointers.h"

#include "core/timestep/step_limits.h"
#include "stepping/step_options.h"

#include <algorithm>
#include <array>
#include <string>

namespace LAMMPS_NS {

class AdaptiveSound;
class Stepper;
class StepControl;
struct UpdateRows;

class StepReport : protected Pointers {
 public:
  // index of compute_vector(); new outputs are added at the end
  enum Output {
    LIMIT_IN_FORCE,
    ACTIVE_FRACTION,
    PARTICLE_UPDATES,
    LARGEST_COMPRESSION,
    STEPS_AT_FLOOR,
    STEPS_BY_LIMIT,    // one for each limit
    PARTICLES_BY_LIMIT = STEPS_BY_LIMIT + sphcloth::N_LIMITS - 1,    // for each that they can have
    IS_OUTPUT_TIME = PARTICLES_BY_LIMIT + sphcloth::N_OF_PARTICLES,
    NEXT_THERMO_STEP,
    SLEEPING_PARTICLES,
    IDEAL_UPDATES,
    LONGEST_WAIT,
    MEAN_WAIT,
    SOUND_SPEED,
    SOUND_WORK,
    PAIR_EVALUATIONS,
    N_OUTPUTS
  };

  // of this rank: updates so far, and how many there would have been if each particle had taken
  // exactly the step that the limits allow
  double updates = 0.0, ideal_updates = 0.0;
  // of this rank: neighbors that the loops of the pair style have evaluated
  double pair_evaluations = 0.0;
  // of this rank, individual steps: times between two updates over the step that the particle asked
  // for at the first, their largest and their sum
  double longest_wait = 0.0, waits = 0.0;
  std::array<double, sphcloth::N_LIMITS> steps_by_limit{};

  StepReport(LAMMPS *lmp_, const StepOptions &options_, int groupbit_) :
      Pointers(lmp_), options(options_), groupbit(groupbit_)
  {
  }

  void count_step(sphcloth::Limit by) { steps_by_limit[static_cast<int>(by)]++; }
  void count_update(double wait)
  {
    updates++;
    waits += wait;
    longest_wait = std::max(longest_wait, wait);
  }
  // particles by their own limit at its last choice
  void forget_particles() { particles_by_limit.fill(0.0); }
  void count_particle(const sphcloth::StepLimit &limit)
  {
    using sphcloth::Limit;
    const Limit by = limit.dt < options.ceiling ? limit.by : Limit::CEILING;
    // with block steps floor and growth bound a particle as well: then none of its own limits does
    if (by <= Limit::CEILING) particles_by_limit[static_cast<int>(by)]++;
  }

  // collective
  double output(int n, Stepper &, StepControl &, const AdaptiveSound &, const UpdateRows &) const;
  std::string steps_in_words() const;
  std::string waits_in_words() const;    // collective

 private:
  const StepOptions &options;
  int groupbit;
  // of this rank; CEILING: no other limit is below it
  std::array<double, sphcloth::N_OF_PARTICLES + 1> particles_by_limit{};

  double active_fraction(const UpdateRows &) const;
  double mean_wait() const;
  double sum_of_ranks(double mine) const;
  double max_of_ranks(double mine) const;
};

}    // namespace LAMMPS_NS

#endif
