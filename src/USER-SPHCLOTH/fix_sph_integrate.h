// SPDX-License-Identifier: GPL-2.0-or-later
// fix sph/integrate: integrates fluid, and limits the time step.  The schemes, the limits of
// particles, the choice of the step and the outputs are in stepping/; this is their adapter to
// LAMMPS.

#ifdef FIX_CLASS
// clang-format off
FixStyle(sph/integrate,FixSPHIntegrate);
// clang-format on
#else

#ifndef LMP_FIX_SPH_INTEGRATE_H
#define LMP_FIX_SPH_INTEGRATE_H

#include "fix.h"

#include "fluid/adaptive_sound.h"
#include "modify.h"
#include "stepping/particle_limits.h"
#include "stepping/step_control.h"
#include "stepping/step_options.h"
#include "stepping/step_report.h"
#include "stepping/stepper.h"
#include "stepping/stepping_scheme.h"

#include <memory>
#include <string>

namespace LAMMPS_NS {

class FixSPHIntegrate : public Fix, public HasSteppingScheme {
 public:
  FixSPHIntegrate(class LAMMPS *, int, char **);
  ~FixSPHIntegrate() override;
  int setmask() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;
  void end_of_step() override;
  void post_run() override;
  double compute_scalar() override;
  double compute_vector(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;
  double memory_usage() override;

  int pack_forward_comm(int n, int *list, double *buf, int, int *) override
  {
    return stepper->pack_forward(n, list, buf);
  }
  void unpack_forward_comm(int n, int first, double *buf) override
  {
    stepper->unpack_forward(n, first, buf);
  }
  int pack_reverse_comm(int n, int first, double *buf) override
  {
    return stepper->pack_reverse(n, first, buf);
  }
  void unpack_reverse_comm(int n, int *list, double *buf) override
  {
    stepper->unpack_reverse(n, list, buf);
  }

  // the step that this particle allows, whatever the others need
  double own_step(int i) const;
  // the one that there is, null if there is none
  static FixSPHIntegrate *find(Modify *modify)
  {
    const auto fixes = modify->get_fix_by_style("^sph/integrate$");
    return fixes.empty() ? nullptr : dynamic_cast<FixSPHIntegrate *>(fixes[0]);
  }
  bool is_active(int i) const { return rows[i][UpdateRows::ACTIVE] != 0.0; }
  bool is_asleep(int i) const { return stepper && stepper->is_asleep(i); }
  bool lets_sleep() const { return stepper && stepper->lets_sleep(); }
  double sleeping_speed() const { return stepper->sleeping_speed(); }
  void disturb(int i) { stepper->disturb(i); }
  void wake_beside(const std::vector<std::array<double, 3>> &removed)
  {
    stepper->wake_beside(removed);
  }
  SteppingScheme stepping_scheme() const override { return scheme; }

  // chooses the first step, when all forces are set up
  void begin_steps();
  // ends a step: counts it and, unless the step is constant, chooses the next one
  void finish_step();

 private:
  struct Record;    // in restart files

  std::string label;
  FluidState *fluid;
  StepOptions options;
  UpdateRows rows;
  FirstKick first_kick;
  ParticleLimits limits;
  StepControl control;
  StepReport report;
  AdaptiveSound sound;
  ParticleColumns springs;    // of mass scaling (fluid/scaled_mass.h), in the last step
  SteppingScheme scheme;    // in force, of this fix or of the run style
  std::unique_ptr<Stepper> stepper;
  bool run_style_drives;
  bool has_moved;    // since the setup
  double restored_step;    // the next one when a restart file was written; 0: none, or in force

  // particles that are due, and not all in each evaluation?
  bool updates_some() const
  {
    return scheme == SteppingScheme::INDIVIDUAL || scheme == SteppingScheme::BLOCK;
  }
  int n_always_kept() const
  {
    return first_kick.columns.count() + sound.columns.count() + springs.count();
  }
  int n_exchanged() const
  {
    return n_always_kept() + UpdateRows::N_COLUMNS + stepper->columns().count();
  }
  void check_group();
  double *pack_always_kept(int i, double *) const;
  double *unpack_always_kept(int i, double *);
  void take_up_restored_step();
  void use_scheme(SteppingScheme, const BlockClock &);
};

}    // namespace LAMMPS_NS

#endif
#endif
