// SPDX-License-Identifier: GPL-2.0-or-later
// run_style sph/adaptive: the time loop of Algorithm 1.

#ifdef INTEGRATE_CLASS
// clang-format off
IntegrateStyle(sph/adaptive,SPHAdaptive);
// clang-format on
#else

#ifndef LMP_SPH_ADAPTIVE_H
#define LMP_SPH_ADAPTIVE_H

#include "stepping/stepping_scheme.h"
#include "verlet.h"

namespace LAMMPS_NS {

class SPHAdaptive : public Verlet, public HasSteppingScheme {
 public:
  SPHAdaptive(class LAMMPS *, int, char **);
  void init() override;
  void setup(int) override;
  void setup_minimal(int) override;
  void run(int) override;

  SteppingScheme stepping_scheme() const override { return stepping; }

 private:
  SteppingScheme stepping;
  class FixSPHIntegrate *particles;
  bool fluid_alone;    // pair_style sph/tait without others

  void set_up_atoms();
  void fill_dynamic_group();
  void set_up_forces();
  void move();
  void communicate();
  void evaluate();
  void compute_bonded();
  bool ghosts_have_forces() const;
  void finish();
};

}    // namespace LAMMPS_NS

#endif
#endif
