// fix sph/integrate: who is integrated, by which limits of the time step, and their state.

#ifdef FIX_CLASS
// clang-format off
FixStyle(sph/integrate,FixSPHIntegrate);
// clang-format on
#else

#ifndef LMP_FIX_SPH_INTEGRATE_H
#define LMP_FIX_SPH_INTEGRATE_H

#include "fix.h"

#include "core/sph/tait.h"
#include "core/timestep/step_limits.h"
#include "lammps_util/particle_columns.h"
#include "stepping/output_times.h"

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;
class BlockSteps;
class FixPBDCloth;
class PairSPHTait;

enum class SteppingScheme : int { CONSTANT, GLOBAL, INDIVIDUAL, BLOCK };

class FixSPHIntegrate : public Fix {
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
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;
  double memory_usage() override;

  // the step that this particle allows, whatever the others need
  double own_step(int i) const;
  bool is_active(int i) const { return state[i][ACTIVE] != 0.0; }

  // ends a step: counts it and, unless the step is constant, chooses the next one
  void finish_step();

  // What BlockSteps asks.  The steps that particles allow, between floor and ceiling, under forces that have these
  // beside f (three columns), with or without a look at whose neighbours are under pressure, and by which limits:
  // dt has the steps before (0: none), and then theirs; the tightest of them.  What one is given; the ceiling; when
  // output is due next; the same for vertices of cloth, 0 for what is none.
  bool wants_force() const { return lambda.force > 0.0; }
  sphcloth::StepLimit find_steps(const std::vector<int> &of, const double *const *external,
                                 bool looks_around, double *dt, double *by);
  void set_own_step(int i, double dt, double now)
  {
    state[i][OWN_STEP] = dt;
    state[i][LAST_UPDATE] = now;
  }
  // that sound needs across the support; by a force
  double sound_time(int i) const;
  double acceleration(int i, double by) const;
  double longest_step() const { return ceiling; }
  double next_output_time(double dt) const { return times.next(dt); }
  void limit_vertices();    // finds what tightest_vertex() and vertex_step() tell
  const sphcloth::StepLimit &tightest_vertex() { return vertices().tightest; }
  int count_vertices() { return vertices().n; }
  double vertex_step(int i) const;

 private:
  struct Record;    // in restart files
  enum Column { OWN_STEP, LAST_UPDATE, ACTIVE, N_COLUMNS };

  std::string label;
  PairSPHTait *pair;
  std::vector<FixPBDCloth *> cloths;
  SteppingScheme said, scheme;    // of this fix; in force, after the run style was asked
  bool run_style_drives;
  sphcloth::StepCoefficients lambda;
  sphcloth::FluctuationControl control;
  double floor, ceiling, growth;
  OutputTimes times;
  bool ceiling_given, clamp_at_floor;

  // per particle: its own allowed step, time of its last update, 1 if it takes part in this step
  double **state;
  std::vector<int> asked;    // for their limits
  bool flies_alone;    // who has no pressure, whatever neighbours have
  struct FluidType {    // the support of all types, the rest of fluids
    double support = 0.0, viscosity = 0.0, sound = 0.0;
    sphcloth::Tait eos;
  };
  std::vector<FluidType> fluids;    // by type
  void settle_types();
  struct Vertices {    // of this rank when their limits were found
    int n = -1;    // not known
    sphcloth::StepLimit tightest{0.0, sphcloth::Limit::NONE};
  } moving;
  const Vertices &vertices();

  // per particle with steps of its own, empty otherwise: BlockSteps::Column, or, of the last update of
  // individual steps, dv/dt, d rho/dt, its own limit
  enum Rate { ACCEL, DENSITY = 3, BY, N_RATES };
  ParticleColumns rows;
  std::unique_ptr<BlockSteps> blocks;

  double previous;      // the last step, before an output time cut it; 0 before the first
  double largest_before;    // compression when that step was chosen
  sphcloth::Compression compression;    // when the step that comes next was chosen
  sphcloth::Limit limited_by;
  double updates;       // particle updates of this rank
  std::array<double, sphcloth::N_LIMITS> steps_limited;
  // of this rank, by their own limit at the last choice; CEILING: no other limit is below it
  std::array<double, sphcloth::N_OF_PARTICLES + 1> particles_limited;

  void read_options(ArgReader &);
  void check_scheme();
  void want_rows(int columns);
  void set_row(int i);
  void forget_rows();
  void move_active();
  template <class Rests> std::pair<int, int> move_but(Rests rests);
  void move_individually();
  void select_active();
  void select_due();
  void hold(int i, const sphcloth::StepLimit &own);
  void choose_step();
  bool is_too_short(const sphcloth::StepLimit &step) const;
  std::string too_short(const sphcloth::StepLimit &wanted, const std::string &whom) const;
  void take_block_step();
  sphcloth::StepLimit tightest_anywhere();
  sphcloth::StepLimit tightest_particle();
  template <class Force, class Take>
  void for_limits(const std::vector<int> &of, Force force_on, Take take) const;
  void count(const sphcloth::StepLimit &own);
  void count_blocks();
  template <class Do> void for_vertices(Do something) const;
  sphcloth::StepLimit limit_of_vertex(int i, const FixPBDCloth &) const;
  double speed_and_force(int, const double *force, sphcloth::StepState &) const;
  sphcloth::StepState particle_state(int, const double *force) const;
  double until_pressed(int, double gap, double sound) const;
  sphcloth::StepState vertex_state(int) const;
  void apply(double);
  void reschedule_dumps();
  double largest_compression() const;
  sphcloth::Compression overall_compression() const;
  double sum_over_ranks(double mine) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
