// SPDX-License-Identifier: GPL-2.0-or-later
// What the pair style calls during an evaluation for a scheme in which particles have time steps of
// their own: the scheme turns the forces of the pair style into impulses.  Each is called once in
// an evaluation and loops over particles itself.

#ifndef SPHCLOTH_FLUID_STEP_HOOKS_H
#define SPHCLOTH_FLUID_STEP_HOOKS_H

#include <vector>

namespace sphcloth {
struct Impulses;
}

namespace LAMMPS_NS {

// Of a density that is integrated, by atom: its sum (1) and its gradient in the last update, and
// what other particles have added since

struct KeptDensity {
  // for a sum: there has been no update; its sum now would be another
  static constexpr double NONE = 0.0, UNKNOWN = -1.0;
  double *sum;
  double *gradient[3];
  double *change;
};

class StepHooks {
 public:
  // The mean time between updates of a particle of each type, in smallest steps; at least 1, and
  // left as it is where no particle of the type is updated.
  virtual void find_intervals(std::vector<double> &of_type) const = 0;

  // For a density that is integrated: the time since the last update of each owned particle before
  // this one, negative where none comes now
  virtual void find_times_since_update(double *since) const = 0;
  virtual KeptDensity kept_density() = 0;

  // Densities and pressures are known.  This is where velocities are brought to an output time
  // (half-kick correction), and where water that has come to rest stops; true on all ranks if any
  // velocity has changed.
  virtual bool correct_velocities() = 0;

  // For how many updates each particle goes on with the frequencies of before, by atom; then they
  // are found for the others.
  virtual const double *frequency_waits() const = 0;
  virtual void note_frequencies() = 0;

  // Forces between particles come next.  Where steps are unequal the next ones are chosen now, and
  // these impulses are to be found with the forces; null if all particles take the same step.
  virtual const sphcloth::Impulses *begin_impulses() = 0;

  // atom->f holds the forces between particles on the active fluid.
  virtual void note_pair_forces() = 0;

  // atom->f holds the forces of walls as well: impulses take their place.
  virtual void apply_impulses() = 0;

 protected:
  ~StepHooks() = default;    // the styles of LAMMPS own the schemes
};

}    // namespace LAMMPS_NS

#endif
