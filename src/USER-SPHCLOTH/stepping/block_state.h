// SPDX-License-Identifier: GPL-2.0-or-later
// What the parts of block steps share: where time is in the base step, what each particle carries,
// and the copies of that on ghosts.

#ifndef SPHCLOTH_STEPPING_BLOCK_STATE_H
#define SPHCLOTH_STEPPING_BLOCK_STATE_H

#include "pointers.h"

#include "atom.h"
#include "core/sph/fluid.h"
#include "core/timestep/step_limits.h"
#include "core/timestep/time_bins.h"
#include "fix.h"
#include "lammps_util/held_particles.h"
#include "lammps_util/particle_columns.h"
#include "stepping/step_options.h"

#include <cstdint>
#include <vector>

namespace LAMMPS_NS {

class FluidState;

// Where time is; plain, as it stands in restart files

struct BlockClock {
  sphcloth::TimeBins line;
  int deepest = 0;    // time bin of the smallest step
  sphcloth::Limit limit = sphcloth::Limit::NONE;    // that asks for it
  bool uniform = true;    // all particles take that step, and took the same before
  double uniform_span = 1.0;    // for which impulses then act, over that step
  bool some_sleep = false;    // where steps are uniform: particles of any rank
  bool chosen = false;    // steps, at this time, by this evaluation or the same one before
  bool reaches_output = false;    // the base step ends at an output time
  bool defers = false;    // vertices get deferred impulses in the coming step
  double output_time = 0.0;
  // what the controller of compression allows in this base step, 0: it is off; the longest step
  // that a particle has been allowed, and the compression when that was
  double controlled = 0.0, longest = 0.0, largest_compression = 0.0;
  std::uint64_t fixes = 0;    // that may hold water, in this run

  bool begun() const { return line.base > 0.0; }
  bool all_synchronized() const { return line.now == 0; }    // but for sleeping particles
  bool ends_base_step() const
  {
    return line.now + sphcloth::TimeBins::ticks(deepest) == sphcloth::TimeBins::ticks(0);
  }
  double smallest_step() const { return line.step(deepest); }
  double smallest_ticks() const { return static_cast<double>(sphcloth::TimeBins::ticks(deepest)); }
};

// What an atom carries, in the order of restart files

class BlockColumns : public ParticleColumns {
 public:
  enum Column {
    BIN,             // time bin, or ASLEEP
    REACH,           // time up to which its impulses act, in ticks
    P_OVER_RHO2,     // its pressure in the last of them
    AHEAD,           // how far the impulse before reached beyond now, in ticks
    TAKEN_BACK,      // pressure times ticks of that
    FORCE,           // three: see below
    BY = FORCE + 3,  // the limit of its step
    EVENT,           // why its step ends now
    SLOW_SINCE,      // when it was fast for the last time, or fell asleep
    ACCEL_SQ,        // square of its acceleration, and rate of its density, in its last update
    DENSITY_RATE,
    FLUID_SQ,        // of its Frequencies, when they were found last
    FRICTION,
    INTERVAL,        // in updates, from then until they are found again; 0: never found
    WAIT,            // what is left of it
    SUM,             // of KeptDensity
    GRADIENT,        // three
    CHANGE = GRADIENT + 3,
    HELD,    // bits of the axes along which a fix set its last force to 0
    N_COLUMNS
  };
  static constexpr int ASLEEP = -1;
  enum Event { NONE, WOKEN, NEW };

  // Of fluid: the force of other styles.  Of vertices: the impulse that is deferred to the coming
  // step.  They share three columns, since no atom has both.
  double *external_force(int d) { return (*this)[FORCE + d]; }
  double *deferred_impulse(int d) { return (*this)[FORCE + d]; }

  int bin(int i) const { return static_cast<int>((*this)[BIN][i]); }
  bool is_asleep(int i) const { return (*this)[BIN][i] == ASLEEP; }
};

class BlockState : protected Pointers {
 public:
  Fix *const fix;    // whose group is integrated, and which communicates
  const BlockOptions &options;
  FluidState *fluid;
  BlockColumns columns;
  BlockClock clock;
  int coarsest;    // time bin of the longest step that may begin now

  // By atom, owned and ghost.  Time bins of owned atoms that are not updated stay as they are while
  // the order of the atoms does.
  std::vector<int> bin, mark;
  // are the ranges of bins of whole blocks of space known, before some of them were raised?
  bool ranges_known = false;
  // With sleeping water only, 1 or 0: in the last evaluation, which may have woken it since
  std::vector<int> asleep;
  bool any_asleep = false;    // here, ghosts too
  HeldParticles held;
  int n_at_rest = 0;    // owned particles that sleep, or will from this step on
  std::vector<double> given;    // impulses by source, see Impulses, force times ticks
  std::vector<double> kicks;    // changes of velocities [n][3]
  // owned active fluid that is not asleep; of it, by atom, in ticks: for how long it gives
  // impulses, and p/rho^2 times time
  std::vector<int> giving;
  std::vector<double> span, impulse;
  std::vector<int> boundaries;    // owned
  std::vector<int> marked;    // owned

  // what active particles tell inactive ones, across ranks
  enum Mark { NOT_MARKED = 0, DISTURBED = 1, WAKE = 2 };

  BlockState(LAMMPS *, Fix *, const BlockOptions &);

  void init(FluidState *);
  bool is_asleep(int i) const { return columns.is_asleep(i); }
  double half_step(int i) const;    // in ticks
  bool is_new(int i) const { return columns[BlockColumns::EVENT][i] == BlockColumns::NEW; }
  bool is_held(int i, int d) const
  {
    return held.any() && static_cast<int>(columns[BlockColumns::HELD][i]) >> d & 1;
  }
  // how far the last impulse reaches beyond now, in ticks, for the step that begins
  double ahead(int i) const;

  // enters time bins with the smallest step, until it chooses its own
  void add_particle(int i);
  void begin_own_step(int i);
  void forget_frequencies(int i);

  bool was_asleep(int i) const { return any_asleep && asleep[i]; }
  void make_room();
  void forget_inactive() { inactive_known = false; }
  // arrays of atoms that are not updated, if they are not known any more
  void refresh_inactive();
  void select_giving();
  // Between these two `given` counts; else it is 0.  act(i) for owned atoms that may have got some
  void begin_giving();
  template <class Act> void for_touched(Act act) const
  {
    if (all_touched)
      for (int i = 0; i < atom->nlocal; i++) act(i);
    else
      for (const int i : touched) act(i);
  }
  void end_giving();
  // the impulses of those that give
  sphcloth::Impulses impulses(const std::vector<int> &of, bool with_forces);
  const double *given_to(int i) const { return &given[sphcloth::Impulses::STRIDE * i]; }
  void mark_atom(int i, int how);
  void clear_ghost_marks();

  void forward_bins();
  void measure_ranges();    // of bins, where many will ask
  void find_sleeping();    // of all atoms, from the bins of owned ones
  void forward_kicks();    // adds them to the velocities of ghosts
  void reverse_given();    // and marks
  int pack_forward(int n, const int *list, double *buf) const;
  void unpack_forward(int n, int first, const double *buf);
  int pack_reverse(int n, int first, double *buf) const;
  void unpack_reverse(int n, const int *list, const double *buf);
  double bytes() const;

 private:
  enum Stage { BINS, KICKS };

  Stage stage;
  bool inactive_known;
  bool all_touched = true;
  std::vector<int> touched, touched_ghosts;    // otherwise
  std::vector<std::uint8_t> is_touched;

  void touch(int i);
};

}    // namespace LAMMPS_NS

#endif
