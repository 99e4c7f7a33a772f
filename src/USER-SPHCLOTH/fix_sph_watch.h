// SPDX-License-Identifier: GPL-2.0-or-later
// fix sph/watch: ends a run that leaves its limits, with a restart file of a state within them.

#ifdef FIX_CLASS
// clang-format off
FixStyle(sph/watch,FixSPHWatch);
// clang-format on
#else

#ifndef LMP_FIX_SPH_WATCH_H
#define LMP_FIX_SPH_WATCH_H

#include "fix.h"

#include <Eigen/Core>

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;
class FixPBDCloth;
class FixSPHDrain;
class FixSPHEmit;
class FixSPHIntegrate;
class FluidState;

class FixSPHWatch : public Fix {
 public:
  FixSPHWatch(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void end_of_step() override;
  double compute_scalar() override { return checks; }
  double compute_vector(int n) override { return seen[1 + n]; }
  void write_restart(FILE *) override;
  void restart(char *) override;

 private:
  enum Limit { FINITE, DENSITY, SPEED, MASS, MOMENTUM, ENERGY, N_LIMITS };
  using Values = std::array<double, N_LIMITS>;

  // of the group, with what came in and left taken off: it stays, but for the energy that falls
  struct Balance {
    double mass = 0.0, energy = 0.0;
    Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
    double present = 0.0, flow = 0.0;    // mass that is there, and the sum of m |v|
  };

  // an atom that may be to blame
  struct Suspect {
    double value;
    tagint tag;
    double x[3];
  };

  struct Record;    // in restart files

  std::string label;
  int interval;
  Values allowed;    // negative: the limit is off
  int keep;          // steps between restart files
  std::string file;
  FluidState *fluid;
  std::vector<FixSPHEmit *> sources;
  std::vector<FixSPHDrain *> sinks;
  std::vector<FixPBDCloth *> cloths;
  std::vector<FixSPHIntegrate *> integrators;

  bool begun;    // is the balance of the begin known?
  Balance begin;
  struct {
    double mass, flow;
  } scale;    // largest so far
  double checks;
  Values seen;    // in the last check
  std::string saved;    // the last restart file and when it was written, in words

  void read_options(ArgReader &);
  bool is_on(Limit limit) const { return allowed[limit] >= 0.0; }
  bool balances() const { return is_on(MASS) || is_on(MOMENTUM) || is_on(ENERGY); }
  void need_fluid();
  void find_partners();
  bool covers(const Fix *) const;
  void check();
  void look_at_particles();
  void look_at_balance();
  Balance balance() const;
  void take_off_exchanged(Balance &) const;
  int wrong(int i) const;
  double speed(int i) const;
  double deviation(int i) const;
  [[noreturn]] void end_run(Limit);
  std::string breach(Limit) const;
  std::vector<Suspect> suspects(Limit) const;
  static void keep_worst(std::vector<Suspect> &);
  std::string describe(const Suspect &, Limit) const;
  void keep_files();
  void remember_file(bool one_of_two);
};

}    // namespace LAMMPS_NS

#endif
#endif
