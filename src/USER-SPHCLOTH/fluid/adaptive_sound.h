// SPDX-License-Identifier: GPL-2.0-or-later
// Speeds of sound that follow the flow, 'pair_coeff ... c0 follow': measures what the fluids need,
// changes their stiffness, and keeps the pressure of every particle as it does.
//
// A particle keeps its pressure by another density.  That of a sum over neighbors is the sum times
// 1 + e, with e kept of each particle; e decays slowly, so that the density is that of the
// positions again.  The energy that this takes or gives is counted.

#ifndef SPHCLOTH_FLUID_ADAPTIVE_SOUND_H
#define SPHCLOTH_FLUID_ADAPTIVE_SOUND_H

#include "pointers.h"

#include "core/sph/sound_target.h"
#include "lammps_util/particle_columns.h"

#include <cstdint>
#include <vector>

namespace LAMMPS_NS {

class FluidState;

class AdaptiveSound : protected Pointers {
 public:
  ParticleColumns columns;    // e, per atom, for exchange and restart; none: nothing follows

  explicit AdaptiveSound(LAMMPS *lmp_) : Pointers(lmp_) {}

  bool on() const { return !columns.empty(); }
  void begin_run(FluidState *);
  // Before an evaluation of all particles, collective, where it is due: is any speed another now?
  bool update();

  double work = 0.0;    // given to the fluid of this rank by changes so far
  double elapsed = 0.0;    // since the last update

 private:
  FluidState *fluid = nullptr;

  std::vector<int> followers;    // types
  std::vector<sphcloth::SoundCounts> counts;    // of them
  std::vector<std::int64_t> counts_here, counts_of_ranks;
  std::vector<double> volumes_here, volumes;    // [ntypes + 1]

  double due() const;    // `elapsed` for which an update is worth its cost
  void measure();
  double size(int type) const;
  void restore_positions(int type, double left);
  void change(int type, double sound);
  void set_density(int i, double rho, double work_per_mass);
};

}    // namespace LAMMPS_NS

#endif
