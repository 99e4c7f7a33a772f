// SPDX-License-Identifier: GPL-2.0-or-later
// Fixes that replace forces hold particles: what moves particles beside forces must let them be.

#ifndef SPHCLOTH_LAMMPS_UTIL_HELD_PARTICLES_H
#define SPHCLOTH_LAMMPS_UTIL_HELD_PARTICLES_H

#include <vector>

namespace LAMMPS_NS {

class HeldParticles {
 public:
  void begin_run(class Modify *);
  bool any() const { return !holders.empty(); }
  // The axes, a bit each, along which a fix has set this force to 0: of a particle of these groups
  // that was here then.
  int axes(int mask, const double *x, const double *f) const;

 private:
  struct Holder {
    int groupbit, axes;
    class Region *const *region;    // of the fix, which finds it anew for each run; null: none
  };
  std::vector<Holder> holders;
};

}    // namespace LAMMPS_NS

#endif
