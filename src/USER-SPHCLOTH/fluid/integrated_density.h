// SPDX-License-Identifier: GPL-2.0-or-later
// Density by continuity: integrated from update to update of each particle.

#ifndef SPHCLOTH_FLUID_INTEGRATED_DENSITY_H
#define SPHCLOTH_FLUID_INTEGRATED_DENSITY_H

#include "pointers.h"

#include "core/sph/fluid.h"
#include "fluid/fluid_boundary.h"
#include "fluid/ghost_exchange.h"
#include "fluid/step_hooks.h"

#include <vector>

namespace LAMMPS_NS {

class SPHMaterials;

class IntegratedDensity : protected Pointers {
 public:
  IntegratedDensity(class LAMMPS *lmp_, const SPHMaterials &materials_, GhostExchange &ghosts_) :
      Pointers(lmp_), materials(materials_), ghosts(ghosts_)
  {
  }

  void begin_lists(StepHooks *);
  // time that has passed since the last evaluation
  void advance(double dt) { elapsed += dt; }
  // Of the active particles, collective; new_lists: atoms may have entered.  Hooks: null where all
  // take the same step.
  void integrate(sphcloth::Fluid &, const sphcloth::Particles &,
                 const std::vector<FluidBoundary *> &, StepHooks *, bool new_lists);

  double *pack(GhostData, int i, double *buf) const;
  const double *unpack(GhostData, int i, const double *buf);
  void add(int i, double change) { kept.change[i] += change; }
  double bytes() const;

 private:
  const SPHMaterials &materials;
  GhostExchange &ghosts;
  double elapsed = 0.0;
  std::vector<double> rate;
  std::vector<double> gradient;    // of the density, [n][3], empty unless it diffuses
  // with steps of individual particles
  KeptDensity kept{};
  std::vector<double> sum;    // (1)
  std::vector<double> since;    // of Diffusion

  void check(const sphcloth::Particles &) const;
  void find_gradients(sphcloth::Fluid &, const sphcloth::Particles &);
  void follow_rates(sphcloth::Fluid &, const sphcloth::Particles &,
                    const std::vector<FluidBoundary *> &);
  void follow_sums(sphcloth::Fluid &, const sphcloth::Particles &,
                   const std::vector<FluidBoundary *> &, StepHooks &, bool new_lists);
  void find_sums(sphcloth::Fluid &, sphcloth::Particles, const std::vector<FluidBoundary *> &);
  void leave_out_entered(sphcloth::Fluid &, const sphcloth::Particles &);
  void diffuse(sphcloth::Fluid &, const sphcloth::Particles &, const StepHooks &);
};

}    // namespace LAMMPS_NS

#endif
