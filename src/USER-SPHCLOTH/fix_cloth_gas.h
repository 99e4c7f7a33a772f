// SPDX-License-Identifier: GPL-2.0-or-later
// fix cloth/gas: pressure of a gas on the triangles of a mesh, constant or by the volume enclosed.

#ifdef FIX_CLASS
// clang-format off
FixStyle(cloth/gas,FixClothGas);
// clang-format on
#else

#ifndef LMP_FIX_CLOTH_GAS_H
#define LMP_FIX_CLOTH_GAS_H

#include "fix.h"

#include "cloth/gas_chambers.h"
#include "core/pbd/gas_law.h"
#include "lammps_util/number_or_variable.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class ContactMesh;

class FixClothGas : public Fix {
 public:
  FixClothGas(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_post_neighbor() override { post_neighbor(); }
  void pre_exchange() override { chambers.require_ghosts_in_run(); }
  void min_pre_exchange() override { pre_exchange(); }
  void post_neighbor() override;
  void min_post_neighbor() override { post_neighbor(); }
  void setup(int) override { evaluate(Phase::AGAIN); }
  void post_force(int) override { evaluate(Phase::STEP); }
  void min_setup(int) override { evaluate(Phase::MINIMIZE); }
  void min_post_force(int) override { evaluate(Phase::MINIMIZE); }
  void post_run() override;
  double compute_scalar() override;
  double compute_vector(int) override;
  double compute_array(int chamber, int column) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override { return chambers.bytes(); }

 private:
  // a step is done; the forces of the last one are found again; there are no steps
  enum class Phase { STEP, AGAIN, MINIMIZE };
  enum Flow { CLOSED, VENTING, BURST };

  struct Chamber {    // plain, for restart files
    double first_id, started, flow;
    GasChambers::Frame frame;
    double gas;    // the volume that it would fill at the pressure of the start
    double volume, before, earlier;    // now, and after the last two steps
    double rate;    // of the volume by the velocities at the end of the last run
    double dt, dt_before;    // of these steps
    double excess, excess_before;    // by the law, now and a step ago
    double applied, applied_before;    // in the coming step, and in the last one
    double energy, received;    // the latter with gas, or by a pressure that was changed
  };

  std::string label;
  sphcloth::GasLaw law;    // of no use where the pressure is constant
  bool has_law;
  NumberOrVariable constant, inflow;
  bool has_inflow = false;
  bool takes_steps = false;    // minimize and rerun take none
  double burst;
  GasChambers::Options options;
  GasChambers chambers;
  std::vector<Chamber> states;
  std::vector<const ContactMesh *> cloths;

  void read(class ArgReader &);
  void check(ArgReader &);
  void begin_chambers();
  double inverse_mass(int) const;
  void evaluate(Phase);
  void follow(Chamber &, const GasChambers::Volume &, Phase);
  void check_volume(const Chamber &, double volume) const;
  void begin(Chamber &, const GasChambers::Volume &) const;
  void record_rates();
  bool has_been_moved(const Chamber &, const GasChambers::Volume &) const;
  void begin_steps(Chamber &, const GasChambers::Volume &) const;
  void let_flow(Chamber &, Phase);
  void set_gas(Chamber &, double) const;
  double excess_of_step(const Chamber &, double mobility) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
