// Steps of individual particles in powers of two: run_style sph/adaptive block.
//
// A particle's energy, compressed as it is, acts for its own step: density and pressure are found when
// the step begins, and the impulse of its pressure over that whole step goes to it and to all of its
// neighbours at once.  A pair so exchanges the impulses of two energies, each at its own pace, and both
// partners get the same of either: momentum stays.  This splits the Hamiltonian by particles,
//   H = sum_i m_i v_i^2 / 2 + sum_i m_i e(rho_i),
// with kicks of m_i e(rho_i) every dt_i, which is the impulse method of Tuckerman, Berne & Martyna,
// J. Chem. Phys. 97 (1992) 1990, with semi-implicit Euler in place of Verlet.  With equal steps it is
// the scheme of (2) and lines 30 to 33.  Forces of others act in every step of the scene.
//
// A velocity so is that of the middle of a particle's last step, with one step for all that of half a
// step ago.  Where output is due everybody's is brought to the latter.

#ifndef SPHCLOTH_STEPPING_BLOCK_STEPS_H
#define SPHCLOTH_STEPPING_BLOCK_STEPS_H

#include "pointers.h"

#include "atom.h"
#include "core/neighbor/dual_lists.h"
#include "core/timestep/step_limits.h"
#include "core/timestep/time_bins.h"
#include "lammps_util/particle_columns.h"
#include "stepping/step_hooks.h"

#include <utility>
#include <vector>

namespace LAMMPS_NS {

class FixSPHIntegrate;
class PairSPHTait;

class BlockSteps : public StepHooks, protected Pointers {
 public:
  // What a particle carries along.  LEVEL: of its step; BEFORE: of the one before; UNTIL: how far
  // its impulses reach, in ticks; TERM: its pressure in the last of them; AHEAD: how far the one
  // before reached beyond now, and TAKEN_BACK: pressure times ticks of that; EXTERNAL: force of
  // others than the fluid; BY: the limit of its step; CALL: why its step ends now; SINCE: when it was
  // fast for the last time, or fell asleep.  Of a vertex: OWED, an impulse that it gets in the
  // coming step.
  enum Column {
    LEVEL,
    BEFORE,
    UNTIL,
    TERM,
    AHEAD,
    TAKEN_BACK,
    EXTERNAL,
    OWED = EXTERNAL,
    BY = EXTERNAL + 3,
    CALL,
    SINCE,
    N_COLUMNS
  };

  // of the user: how many times a neighbour's step somebody's may be, 2 or 4; how many times fewer updates
  // unequal steps have to need; may one end early; the speed below which water sleeps, 0: never
  struct Options {
    int ratio = 4;
    double gain = 2.0;
    bool waking = true;
    double sleep = 0.0;
  } options;

  // rows: what particles carry along, of the fix
  BlockSteps(LAMMPS *, FixSPHIntegrate *, ParticleColumns &rows);

  void init(PairSPHTait *);
  void forget() { at = Place(); }
  bool begun() const { return at.line.root > 0.0; }
  void set_new(int i);    // a particle that comes in

  // Time goes on.  Who is updated now?  1 in a column of theirs, 0 for others; returns how many are, and
  // how many are not.  Those who sleep stay where they are.
  void begin_step();
  std::pair<int, int> mark_due(double **of, int column) const;
  bool sleeps(int i) const { return rows[LEVEL][i] == ASLEEP; }
  void wake_moved();    // by others than the fluid

  // At an output time velocities are brought to those of half a step of the scene ago; what sheets
  // are pushed by that comes in the next step.  Steps are chosen when all forces are known; then f
  // is what acts until the next step of the scene begins.
  bool correct_velocities() override;
  void note_pair_forces() override;
  void apply_impulses() override;
  // what others have added to that in the meantime
  void note_external_forces();

  // of the scene, the limit that asks for it, and whether it ends at an output time
  double next_step() const;
  sphcloth::Limit limited_by() const { return at.limit; }
  bool arrives() const { return at.reaches_output && ends_root(); }

  // in steps of the scene, of those of a type who do not sleep
  void find_intervals(std::vector<double> &of_type) const override;

  // of this rank: who sleeps, and how many updates it would have been so far, had everybody taken
  // exactly the step that the limits allow
  int sleepers() const;
  double ideal_updates() const { return ideal; }
  void set_ideal_updates(double n) { ideal = n; }

  // ghosts
  int pack_forward(int n, const int *list, double *buf) const;
  void unpack_forward(int n, int first, const double *buf);
  int pack_reverse(int n, int first, double *buf) const;
  void unpack_reverse(int n, const int *list, const double *buf);

  // where time is, plain for the restart file
  struct Place {
    sphcloth::TimeBins line;
    int deepest = 0;    // level of the step of the scene
    sphcloth::Limit limit = sphcloth::Limit::NONE;
    bool alike = true;    // everybody takes that step, and took the same before
    double span_of_all = 1.0;    // for which impulses then act, over that step
    bool chosen = false;    // steps, at this time, by this evaluation or the same one before
    bool reaches_output = false;    // does the root step end there?
    bool owes = false;    // vertices, an impulse
    double output_time = 0.0;
  };
  const Place &place() const { return at; }
  void go_to(const Place &place) { at = place; }

  double bytes() const;

 private:
  enum Stage { LEVELS, IMPULSES, KICKS };

  // Level and what came before: particles of the same pace begin the same step and have impulses for
  // the same time.  Of the others, none has another's pace.
  struct Pace {
    static constexpr int BEFORES = 64, SLEEPER = 60, FIRST = 61, BROKEN = 62, INACTIVE = 63;
    static constexpr int BOUNDARY = -1;
    static int of(int level, int before) { return BEFORES * level + before; }
    static int level(int pace) { return pace / BEFORES; }
    static int before(int pace) { return pace % BEFORES; }
  };
  enum Mark { UNTOUCHED = 0, TOUCHED = 1, WAKE = 2 };
  enum Call { NONE, WOKEN, NEW };
  static constexpr int ASLEEP = -1;    // as a level

  FixSPHIntegrate *fix;
  PairSPHTait *pair;
  ParticleColumns &rows;
  Place at;
  int apart;    // levels that neighbours may be apart
  std::vector<int> apart_of;    // the same of a pair of types, [(ntypes+1)^2]
  int coarsest;    // level of a step that may begin now
  int finest_vertex;    // level of the shortest step of a vertex
  double ideal;

  // by particle, owned and ghost; of owned particles that are not updated it stays as it is while
  // the order of the atoms does
  Stage stage;
  bool known;
  std::vector<int> level, pace, mark;
  std::vector<double> span, impulse;    // in steps of the scene: time, and pressure times time
  std::vector<double> from_particles, handed, kicks;    // forces, changes of velocities [n][3]
  std::vector<double> wanted;
  std::vector<int> marked;    // owned
  std::vector<int> slots;    // of those who need impulses
  std::vector<int> boundaries, impelled;    // owned, the latter in the last evaluation

  int find_apart(int type, int neighbor_type) const;
  int levels_apart(int type, int neighbor_type) const
  {
    return apart_of[type * (atom->ntypes + 1) + neighbor_type];
  }
  void make_room();
  void know_all();
  bool ends_root() const;
  bool everyone_begins() const { return at.line.now == 0; }    // a step, but for who sleeps

  void choose();
  sphcloth::StepLimit want_steps(const std::vector<int> &of, bool looks_around);
  void begin_root();
  struct Root {
    double step, remaining, output_time;
    sphcloth::Limit by;    // of the tightest
    bool one_for_all;
  };
  Root find_root(sphcloth::StepLimit tightest) const;
  bool may_gain(double least, double gain) const;
  void find_step_of_scene();
  void respect_neighbors();
  int vertex_level(int i) const;
  bool is_too_coarse(int i);
  int level_beside(int i);
  void fall_asleep();
  bool rests_among_others(int i);
  bool is_slow(int i) const;
  bool gains_speed(int i, double force_sq) const;
  void book();
  void begin_own_step(int i);
  double half_step(int i) const;

  void measure_arrears();
  void kick();
  void pay();

  void keep_forces(std::vector<double> &in) const;
  bool needs_external() const;
  void measure_impulses();
  void impel_active();
  void rest(int i);
  void share_impulses();
  void share_equally();
  void prolong(int i, double times);
  bool look_around(int i);
  bool look_at(int i, int type, const sphcloth::NeighborSpan &others);
  void disturb(int i, int j);
  void touch(int j, int mark_of_it);
  void wake_marked();
  void wake(int i);
  void wake_beside_moving_boundaries();
  template <class Do> void for_neighbors(int i, Do something);
};

}    // namespace LAMMPS_NS

#endif
