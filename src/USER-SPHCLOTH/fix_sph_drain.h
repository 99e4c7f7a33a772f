// SPDX-License-Identifier: GPL-2.0-or-later
// fix sph/drain: takes fluid particles out that leave the scene.

#ifdef FIX_CLASS
// clang-format off
FixStyle(sph/drain,FixSPHDrain);
// clang-format on
#else

#ifndef LMP_FIX_SPH_DRAIN_H
#define LMP_FIX_SPH_DRAIN_H

#include "fix.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixSPHDrain : public Fix {
 public:
  FixSPHDrain(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_pre_exchange() override { pre_exchange(); }
  void pre_exchange() override;
  double compute_scalar() override { return static_cast<double>(drained); }
  double compute_vector(int n) override { return taken[n]; }
  void write_restart(FILE *) override;
  void restart(char *) override;

 private:
  struct Record;    // in restart files
  using Position = std::array<double, 3>;

  std::string label, region_name;
  class Region *region;
  bigint drained;
  double taken[4];    // mass, momentum

  void check_group();
  bool leaves(int) const;
  std::vector<Position> remove();
};

}    // namespace LAMMPS_NS

#endif
#endif
