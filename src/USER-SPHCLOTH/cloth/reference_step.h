// SPDX-License-Identifier: GPL-2.0-or-later
// The step for which a stiffness k below 1 holds.  A k that acts once in each step is that of a
// spring, which is stiffer in a shorter step: where steps vary that would feed what is stretched or
// bent.

#ifndef SPHCLOTH_CLOTH_REFERENCE_STEP_H
#define SPHCLOTH_CLOTH_REFERENCE_STEP_H

#include "cloth/cloth_constraints.h"
#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

class ReferenceStep : protected Pointers {
 public:
  // given: by the user, 0 if it is not
  ReferenceStep(LAMMPS *lmp_, std::string owner_, const double &given_,
                ClothConstraints &constraints_) :
      Pointers(lmp_), owner(std::move(owner_)), given(given_), constraints(constraints_)
  {
  }

  void set_steps_vary(bool vary) { steps_vary = vary; }

  // before a step: sees to it that k is the same spring as in the reference step
  void rescale(int usual_substeps, double substep_dt);

  // of the restart file: 0 if no step has been taken for it
  double first_step() const { return first; }
  void set_first_step(double step) { first = step; }

 private:
  std::string owner;
  const double &given;
  ClothConstraints &constraints;
  bool steps_vary = false;
  double first = 0.0;    // where they do

  void take_first_step();
};

}    // namespace LAMMPS_NS

#endif
