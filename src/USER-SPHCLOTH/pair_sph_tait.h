// SPDX-License-Identifier: GPL-2.0-or-later
// pair_style sph/tait: weakly compressible SPH, equations (1) to (3), with boundary particles.

#ifdef PAIR_CLASS
// clang-format off
PairStyle(sph/tait,PairSPHTait);
// clang-format on
#else

#ifndef LMP_PAIR_SPH_TAIT_H
#define LMP_PAIR_SPH_TAIT_H

#include "pair.h"

#include "fluid/fluid_evaluation.h"

namespace LAMMPS_NS {

class PairSPHTait : public Pair, public GhostExchange {
 public:
  PairSPHTait(class LAMMPS *);
  ~PairSPHTait() override;

  void compute(int, int) override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_restart_settings(FILE *) override;
  void read_restart_settings(FILE *) override;
  void write_data(FILE *) override;
  void write_data_all(FILE *) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  void send_to_ghosts(GhostData) override;
  void add_from_ghosts(GhostData) override;
  double memory_usage() override;
  // what fixes, computes and commands ask, see FluidState::find()
  void *extract(const char *, int &) override;

 private:
  FluidEvaluation fluid;
  GhostData for_ghosts = GhostData::DENSITY;    // in the communication that is under way

  void allocate();
  void check_range();    // of single precision
  void choose_skin() const;
  bool excluded(int, int) const;
  void tally_virial();
  void tally_energy();
};

}    // namespace LAMMPS_NS

#endif
#endif
