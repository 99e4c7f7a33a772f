// SPDX-License-Identifier: GPL-2.0-or-later
// Schemes constant and global: all particles take the same step.

#ifndef SPHCLOTH_STEPPING_UNIFORM_STEPS_H
#define SPHCLOTH_STEPPING_UNIFORM_STEPS_H

#include "stepping/stepper.h"

#include <vector>

namespace LAMMPS_NS {

class UniformSteps : public Stepper {
 public:
  UniformSteps(LAMMPS *lmp_, const SteppingParts &parts_, bool constant_) :
      Stepper(lmp_, parts_), constant(constant_)
  {
  }

  void init(FluidState *, Change) override;
  void move() override;
  void choose_step() override;
  double bytes() const override;

 private:
  bool constant;    // the step is the user's
  std::vector<int> integrated;
  tagint limited = 0;    // the particle or vertex with the tightest limit

  sphcloth::StepLimit tightest_limit();
  void find_stable_step();
};

}    // namespace LAMMPS_NS

#endif
