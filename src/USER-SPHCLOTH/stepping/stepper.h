// SPDX-License-Identifier: GPL-2.0-or-later
// A stepping scheme: which particles move and which are updated, and how long the next step is.
// Fix sph/integrate has one of three, UniformSteps (constant and global), IndividualSteps and
// BlockSteps, and the parts that they share: the limit of each particle (ParticleLimits), the step
// of the run (StepControl) and the counters (StepReport).

#ifndef SPHCLOTH_STEPPING_STEPPER_H
#define SPHCLOTH_STEPPING_STEPPER_H

#include "fix.h"
#include "pointers.h"

#include "lammps_util/particle_columns.h"
#include "stepping/first_kick.h"
#include "stepping/particle_limits.h"
#include "stepping/step_control.h"
#include "stepping/step_options.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

struct BlockClock;
class FluidState;
class StepReport;

// What every scheme keeps of each atom, a row each: the per-atom array of the fix

struct UpdateRows {
  // The step that a particle allows, the time of its last update, 1 if it is updated in this step;
  // the step that stability allows, and the limit of that, when it was found last
  enum Column { OWN_STEP, LAST_UPDATE, ACTIVE, STABLE_STEP, STABLE_BY, N_COLUMNS };
  double **row = nullptr;
  double *operator[](int i) const { return row[i]; }
};

struct SteppingParts {
  Fix *fix;    // whose group is integrated, and which communicates
  const StepOptions &options;
  UpdateRows &rows;
  FirstKick &first_kick;
  ParticleLimits &limits;
  StepControl &control;
  StepReport &report;
};

class Stepper : protected Pointers {
 public:
  Stepper(LAMMPS *lmp_, const SteppingParts &parts_) : Pointers(lmp_), parts(parts_), fluid(nullptr)
  {
  }

  // Before each run.  Have particles been changed since the last one?  The same on all ranks.
  virtual void init(FluidState *, Change);
  // are all particles updated at the end of the step that comes next?
  virtual bool updates_all_next() const { return true; }
  // lines 30 to 33 of Algorithm 1, then tells the pair style which particles are updated
  virtual void move() = 0;
  // forces are known, of all styles
  virtual void end_step() {}
  virtual void choose_step() = 0;
  virtual void add_particle(int) {}    // owned; its columns are zero
  // what stability allows has changed by more than the motion
  virtual void forget_stability() { parts.control.watch.demand(); }
  // the physical time has been reset, to one that is later by this: the times that are kept of
  // particles follow
  virtual void shift_times(double by);
  void grow(int nmax);    // after the rows

  // what the scheme keeps of each atom beside its row, in the order of restart files
  virtual ParticleColumns &columns() { return none; }

  // for outputs and restart files; null: there are no time bins
  virtual const BlockClock *clock() const { return nullptr; }
  virtual int count_sleeping() const { return 0; }
  virtual void count_limits() const {}    // of particles, for the report
  virtual bool is_asleep(int) const { return false; }
  virtual bool lets_sleep() const { return false; }
  virtual double sleeping_speed() const { return 0.0; }    // below which particles sleep
  // What holds an owned particle moves: if it sleeps, it wakes in the next step.
  virtual void disturb(int) {}
  // Particles have been taken away from here: those that sleep beside them wake in the next step.
  virtual void wake_beside(const std::vector<std::array<double, 3>> &) {}

  virtual int pack_forward(int, const int *, double *) const { return 0; }
  virtual void unpack_forward(int, int, const double *) {}
  virtual int pack_reverse(int, int, double *) const { return 0; }
  virtual void unpack_reverse(int, const int *, const double *) {}
  virtual double bytes() const { return 0.0; }

 protected:
  const SteppingParts parts;
  FluidState *fluid;

  // densities of inactive particles, and so their pressures, change between updates
  virtual bool interpolates_density() const { return false; }
  // are all particles active?  Then the pair style need not ask.
  void tell_active(bool all);

 private:
  ParticleColumns none;
};

}    // namespace LAMMPS_NS

#endif
