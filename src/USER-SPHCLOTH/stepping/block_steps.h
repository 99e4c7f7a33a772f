// SPDX-License-Identifier: GPL-2.0-or-later
// Scheme block: steps of individual particles in powers of two.
//
// A particle's energy, compressed as it is, acts for its own step: density and pressure are found
// when the step begins, and the impulse of its pressure over that whole step goes to it and to all
// of its neighbors at once.  A pair so exchanges the impulses of two energies, each with its own
// step, and both partners get the same of either: momentum is conserved.  This splits the
// Hamiltonian by particles,
//   H = sum_i m_i v_i^2 / 2 + sum_i m_i e(rho_i),
// with kicks of m_i e(rho_i) every dt_i, which is the impulse method of Tuckerman, Berne & Martyna,
// J. Chem. Phys. 97 (1992) 1990, with semi-implicit Euler in place of Verlet.  With equal steps
// it is the scheme of (2) and lines 30 to 33.  Forces of other styles act in every smallest step.

#ifndef SPHCLOTH_STEPPING_BLOCK_STEPS_H
#define SPHCLOTH_STEPPING_BLOCK_STEPS_H

#include "fluid/step_hooks.h"
#include "stepping/bin_choice.h"
#include "stepping/block_impulses.h"
#include "stepping/block_state.h"
#include "stepping/half_kick.h"
#include "stepping/kept_frequencies.h"
#include "stepping/sleeping_water.h"
#include "stepping/stepper.h"

#include <vector>

namespace LAMMPS_NS {

class BlockSteps : public Stepper, public StepHooks {
 public:
  BlockSteps(LAMMPS *, const SteppingParts &, const BlockClock &);

  // what fix sph/integrate calls
  void init(FluidState *, Change) override;
  bool updates_all_next() const override;
  void move() override;
  void end_step() override;
  void choose_step() override;
  void add_particle(int i) override
  {
    state.add_particle(i);
    all_selected = false;
  }
  void forget_stability() override;
  void shift_times(double by) override;
  ParticleColumns &columns() override { return state.columns; }
  const BlockClock *clock() const override { return &state.clock; }
  int count_sleeping() const override;
  void count_limits() const override;
  bool is_asleep(int i) const override { return state.is_asleep(i); }
  bool lets_sleep() const override { return sleeping.enabled(); }
  double sleeping_speed() const override { return state.options.sleep; }
  void disturb(int i) override { sleeping.disturb(i); }
  void wake_beside(const std::vector<std::array<double, 3>> &removed) override
  {
    sleeping.wake_beside(removed);
  }

  // what the pair style calls
  void find_intervals(std::vector<double> &of_type) const override;
  bool correct_velocities() override;
  void find_times_since_update(double *since) const override;
  KeptDensity kept_density() override;
  const double *frequency_waits() const override { return frequencies.waits(); }
  void note_frequencies() override { frequencies.note(); }
  const sphcloth::Impulses *begin_impulses() override;
  void note_pair_forces() override { impulses.note_pair_forces(); }
  void apply_impulses() override;

  // ghosts
  int pack_forward(int n, const int *list, double *buf) const override;
  void unpack_forward(int n, int first, const double *buf) override;
  int pack_reverse(int n, int first, double *buf) const override;
  void unpack_reverse(int n, const int *list, const double *buf) override;
  double bytes() const override;

 private:
  BlockState state;
  BinChoice bins;
  SleepingWater sleeping;
  BlockImpulses impulses;
  HalfKick half_kick;
  KeptFrequencies frequencies;
  bool all_selected = false;    // where all particles take the same step

  void start_over(bool other_scene);
  void advance_clock();
  void choose_bins();
  void select_active();
  void count_flight();
};

}    // namespace LAMMPS_NS

#endif
