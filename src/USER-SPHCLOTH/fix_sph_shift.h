// SPDX-License-Identifier: GPL-2.0-or-later
// fix sph/shift: moves fluid particles from where they are crowded to where they are sparse.

#ifdef FIX_CLASS
// clang-format off
FixStyle(sph/shift,FixSPHShift);
// clang-format on
#else

#ifndef LMP_FIX_SPH_SHIFT_H
#define LMP_FIX_SPH_SHIFT_H

#include "fix.h"

#include "core/sph/shifting.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;
class FixSPHIntegrate;
class FixWallSPH;
class FluidState;

class FixSPHShift : public Fix {
 public:
  FixSPHShift(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int vflag) override { post_force(vflag); }
  void post_force(int) override;
  void initial_integrate(int) override;
  double compute_scalar() override;
  double compute_vector(int) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

 private:
  enum class Speed { LARGEST, OWN };
  enum Count { MOVED, SHIFTED, LEFT, CUT, N_COUNTS };

  std::string label;
  FluidState *fluid;
  FixWallSPH *walls;    // null without plane walls
  FixSPHIntegrate *steps = nullptr;    // by which sleeping water is known; null without
  sphcloth::ShiftCoefficients coefficients;
  Speed speed;
  bool correct_velocity;
  int cloth_bits;    // groups of cloth vertices

  // between the evaluation and the next step, during which no particle changes its place in memory
  std::vector<sphcloth::ConcentrationGradient> concentration;
  sphcloth::ShiftSites sites;    // owned and ghost
  std::vector<double> open;    // owned and ghost: 1 at a free surface
  std::vector<char> left;
  std::vector<double> own_speed;
  double reference;    // largest speed of the group

  double largest;    // shift of the last step over the spacing, this rank
  std::array<double, N_COUNTS> counts{};    // this rank

  void read_options(ArgReader &);
  template <class K>
  SPHCLOTH_MULTIVERSION void measure(int i, const std::vector<sphcloth::KernelScale> &);
  void record_sites();
  bool near_surface_or_cloth(int i) const;
  void shift(int i);
};

}    // namespace LAMMPS_NS

#endif
#endif
