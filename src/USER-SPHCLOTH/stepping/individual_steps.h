// SPDX-License-Identifier: GPL-2.0-or-later
// Scheme individual, (13) to (15): all particles drift in each step of the run, and a particle is
// updated every time that its own step, in whole steps of the run, has passed.

#ifndef SPHCLOTH_STEPPING_INDIVIDUAL_STEPS_H
#define SPHCLOTH_STEPPING_INDIVIDUAL_STEPS_H

#include "stepping/stepper.h"

#include <vector>

namespace LAMMPS_NS {

// of the last update, what acts until the next

class IndividualColumns : public ParticleColumns {
 public:
  enum Column { ACCELERATION, DENSITY_RATE = ACCELERATION + 3, LIMITED_BY, N_COLUMNS };
};

class IndividualSteps : public Stepper {
 public:
  IndividualSteps(LAMMPS *, const SteppingParts &);

  void move() override;
  void choose_step() override;
  ParticleColumns &columns() override { return kept; }
  double bytes() const override;

 protected:
  bool interpolates_density() const override { return true; }

 private:
  IndividualColumns kept;
  std::vector<int> updated;
  tagint limited = 0;    // the particle or vertex with the tightest limit

  void drift();
  void select_active();
  sphcloth::StepLimit tightest_limit();
  void keep(int i, const sphcloth::StepLimit &limit, double now);
};

}    // namespace LAMMPS_NS

#endif
