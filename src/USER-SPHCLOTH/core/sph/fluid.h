// SPDX-License-Identifier: GPL-2.0-or-later
// The fluid of one rank: neighbors, density (1), momentum (2), boundary particles.
//
// A fluid particle sums over fluid neighbors (its mass m_j) and over boundary neighbors, walls
// and cloth, which count with the mass rho0_i V_b that water in their volume V_b would have.
// Akinci et al., ACM Trans. Graph. 31 (2012) 62.  A neighbor of another fluid counts likewise, with
// the mass m_j rho0_i/rho0_j: a density has no step where two fluids meet.
//
// This is what the pair style sees; the loops, one set per kernel and precision, are in
// core/sph/fluid_loops.h, their sums in density_loops.h, force_loops.h,
// rate_loops.h, stiffness_loops.h, surface_loops.h and viscosity_loops.h.

#ifndef SPHCLOTH_CORE_SPH_FLUID_H
#define SPHCLOTH_CORE_SPH_FLUID_H

#include <cmath>
#include <memory>
#include <vector>

#include "core/neighbor/dual_lists.h"
#include "core/sph/kernel.h"
#include "core/sph/stiffness.h"
#include "core/sph/vertex_pairs.h"

namespace sphcloth {

enum class Role : int { NONE, FLUID, BOUNDARY };

// MIXED: pair terms in single precision from integer coordinates, sums in double

enum class Precision : int { DOUBLE, MIXED };

// SWITCHED: any, and particles take a share of their own in the artificial one

enum class Friction : int { NONE, ARTIFICIAL, ANY, SWITCHED };

// particles on which forces are found
enum class Target { ALL, FLUID, BOUNDARIES };

// outputs beside the forces: d rho/dt, the maximum approach speed of a neighbor
enum class Outputs : int { NOTHING, RATE, RATE_AND_APPROACH };

// one pair of types

struct PairTerms {
  KernelScale kernel;
  double nu = 0.0;    // kinematic viscosity
  double monaghan = 0.0;    // alpha c0 h_s of the artificial viscosity
  double soft = 0.0;    // 0.01 h_s^2, keeps its mu finite
  double rho0 = 0.0;    // rest density of the fluid partner of a boundary
  double rho0_ratio = 1.0;    // of two fluids: rest density of the first over that of the second
  double stiffness = 1.0;    // what the recorded pressures count, see pressure_scale
  double diffusion = 0.0;    // 2 delta c0 h_s of the density, two fluids of one type only
  // how much a boundary presses over the gradient of the fluid's energy, as a root: what it adds to
  // stiffness()
  double response = 1.0;

  // Rate of a particle over (mass times slope)/rho.  Artificial viscosity acts along the line of
  // two particles while they approach each other: of all directions not more than half is in one,
  // and that half of the time.
  double friction_rate() const { return 2.0 * nu + 0.25 * monaghan; }
};

// Of a fluid, see core/sph/viscosity_loops.h

struct ViscositySwitch {
  static constexpr double NOISE = 1e-4;    // of c0/h_s
  double floor = 1.0;    // 1: there is none
  double noise = 0.0;    // a rate

  double share(double divergence, double curl) const
  {
    const double sum = divergence + curl + noise;
    return floor + (1.0 - floor) * (sum > 0.0 ? divergence / sum : 0.0);
  }
};

struct FluidModel {
  int dimension = 3, n_types = 0;
  Friction friction = Friction::NONE;
  Outputs outputs = Outputs::NOTHING;
  std::vector<Role> role;    // [n_types + 1]
  std::vector<double> mass;    // [n_types + 1], of every fluid particle of a type; 0: unequal
  // [n_types + 1], with which p/rho^2 is recorded: (rho0/R)^2 of a fluid, 1 of a boundary, whose
  // pressure is the mean of what is recorded around it.  R is one density for all; a pair of fluids
  // has the stiffness R^2/(rho0_i rho0_j), a fluid and a boundary (R/rho0_i)^2 times the user's.
  std::vector<double> pressure_scale;
  std::vector<ViscositySwitch> viscosity_switch;    // [n_types + 1]
  std::vector<PairTerms> terms;    // [(n_types + 1)^2]
  const PairTerms &pair(int i, int j) const { return terms[i * (n_types + 1) + j]; }
};

// per-particle arrays, owned particles first; x, v and f are [n][3]

struct Particles {
  int n_owned = 0, n_all = 0;
  const int *type = nullptr;
  const double *x = nullptr, *v = nullptr;
  // Fluid: mass m; boundary: volume V_b.  One array, since ghosts get it as one number and the type
  // of a particle says which it is.
  const double *mass_or_volume = nullptr;
  const double *p_over_rho2 = nullptr;
  double *rho = nullptr;
  double *f = nullptr, *drho = nullptr;    // what forces() adds to
  double *approach = nullptr;    // of the fluid, what it finds if asked
  double force_unit = 1.0;    // of mass times acceleration
  const Sides *sides = nullptr;    // for new lists; null: there are no sheets
  Parting *layers = nullptr;    // null: sides are enough
  double *const *active = nullptr;    // per particle a row, 0 in active_column: leave it alone
  int active_column = 0;

  bool is_active(int i) const { return !active || active[i][active_column] != 0.0; }
};

// W of a pair, for loops that do not run at every step or over every particle

template <class K> double weight(const Particles &p, int i, int j, const KernelScale &s)
{
  const double dx = p.x[3 * i] - p.x[3 * j], dy = p.x[3 * i + 1] - p.x[3 * j + 1],
               dz = p.x[3 * i + 2] - p.x[3 * j + 2];
  return s.w * K::shape(std::sqrt(dx * dx + dy * dy + dz * dz) * s.inv_support);
}

// Impulses by source, of fluid particles that take steps of their own: of the terms of a pair each
// partner gives that of its own pressure, and half of the friction, to both, with opposite signs.
// What both get is one number in double precision: momentum is exact.  A neighbor that is asleep
// gets nothing; its pressure, and the whole friction, act for the time of its partner.

struct Impulses {
  static constexpr int STRIDE = 4;
  const std::vector<int> *of;    // owned active fluid
  const double *pressure_time;    // p/rho^2 times the time for which it acts
  const double *span;    // that time
  const int *sleeping;    // of all particles, 1: it is asleep; null: none is
  double *given;    // added to, [n_all][STRIDE], force times time
  bool with_forces;    // beside them the forces on these particles, as of Fluid::forces()
};

// Diffusion of the density between particles that take steps of their own: what it has moved
// between two of them since the last update of either is found in the next update of either.

struct Diffusion {
  const double *gradient;    // of the density, of all, [n][3]
  const double *since;    // of all, the time since the last update; negative: none comes now
  double *change;    // of the densities of all, added to
};

// what the neighbors do to one particle, per mass of fluid or per volume of a boundary

struct Acceleration {
  double x = 0.0, y = 0.0, z = 0.0;
  double drho = 0.0;    // d rho / dt
  double approach = 0.0;    // the largest speed of a neighbor inside the support, 0 if all recede
  double virial[6] = {};    // half of sum r_ij f_ij: xx, yy, zz, xy, xz, yz
};

// Slots of the lists, in their order, and where those of a type begin

struct Selection {
  std::vector<int> slots;
  std::vector<std::size_t> first;    // [n_types + 2]

  struct Range {
    const int *from, *to;
    const int *begin() const { return from; }
    const int *end() const { return to; }
  };
  Range of(int t) const { return {slots.data() + first[t], slots.data() + first[t + 1]}; }
};

class Fluid {
 public:
  static std::unique_ptr<Fluid> create(KernelName, Precision);
  virtual ~Fluid() = default;

  FluidModel model;

  // new neighbor lists, see DualLists
  void list(const Particles &, const double *support, double skin, const Motion &);
  // in every other evaluation, first
  void follow(const Particles &p) { lists.follow(points(p)); }

  // Once per evaluation: the active fluid particles, and all others, in the order of the lists.
  // False if nothing has changed.
  bool select(const Particles &);
  const Selection &active() const { return selection; }
  // act(i, type) for the active fluid particles, in that order
  template <class Act> void for_active_fluid(Act act) const { for_fluid(selection, act); }
  template <class Act> void for_fluid(const Selection &of, Act act) const
  {
    for (int t = 1; t <= model.n_types; t++)
      if (model.role[t] == Role::FLUID)
        for (const int slot : of.of(t)) act(lists.at(slot), t);
  }
  // of the active fluid particles those for which is_one(i)
  template <class Is> void select_fluid(Is is_one, Selection &some) const
  {
    some.slots.clear();
    some.first.assign(model.n_types + 2, 0);
    for (int t = 1; t <= model.n_types; t++) {
      some.first[t] = some.slots.size();
      if (model.role[t] != Role::FLUID) continue;
      for (const int slot : selection.of(t))
        if (is_one(lists.at(slot))) some.slots.push_back(slot);
    }
    some.first[model.n_types + 1] = some.slots.size();
  }

  // Records the positions of all particles that are read.  Mixed precision counts from the corner
  // lo - reach - tilt in parts of the box lengths, so that periodic images are exact.
  struct Box {
    double lo[3], length[3];
    double reach;    // neighbors are not farther away
    double tilt = 0.0;    // how far the edges of a tilted box lean
  };
  virtual void record_positions(const Particles &, const Box &) = 0;

  // volume = 1 / sum_k W_bk over the boundary particles of the same type, with itself
  virtual void volumes(const Particles &, int type, double *volume) = 0;

  // Refreshes the neighbors of every active fluid particle and every boundary particle, and sums
  // the density (1) if asked.
  virtual void gather(const Particles &, bool sum) = 0;

  // Gradient [n][3] of the density of every active fluid particle, from the fluid of its type
  virtual void density_gradients(const Particles &, double *gradient) = 0;

  // d rho/dt by continuity, from the density and velocity of all, where they were a time `back`
  // ago; with diffusion if the gradients of all, ghosts too, are given
  virtual void density_rates(const Particles &, const double *gradient, double back,
                             double *rate) = 0;

  // What active particles exchange with all
  virtual void diffuse(const Particles &, const Diffusion &) = 0;

  // Density by kernel interpolation of the densities of all: sum m W / sum (m/rho) W
  virtual void smooth_densities(const Particles &, double *smooth) = 0;

  // of the boundary particles of a type: the mean of the fluid around each, weighted with W
  virtual void boundary_pressures(const Particles &, int type, double *p_over_rho2) = 0;

  // Records density, volume, velocity and pressure of all that are read.
  virtual void record(const Particles &) = 0;

  // With Friction::SWITCHED, behind record(): the share of each active fluid particle in the
  // artificial viscosity; and records those of all that are read
  virtual void viscosity_shares(const Particles &, double *share) = 0;
  virtual void record_viscosity_shares(const Particles &, const double *share) = 0;

  // Of a density that is completed at free surfaces: the gradient of the sum of every active fluid
  // particle; and, from T of all, [n_all][3], of core/sph/surface_loops.h, what it adds to the
  // forces on all, and their virials
  using Receiver = void (*)(void *context, int i, const Acceleration &);
  virtual void sum_gradients(const Particles &, double *gradient) = 0;
  virtual void record_turns(const Particles &, const double *turn) = 0;
  virtual void turn_forces(const Particles &) = 0;
  virtual void turn_virials(const Particles &, Receiver, void *context) = 0;

  // (2): adds force and, if wanted, d rho/dt of all active owned particles, and finds `approach`
  virtual void forces(const Particles &, Target) = 0;

  // What active fluid particles give to their neighbors, and to themselves
  virtual void impulses(const Particles &, const Impulses &) = 0;
  // The selection and its neighbors, which the loops read and to which impulses go: null if they
  // are most particles, which are then read in the order in which they lie
  const std::vector<int> *touched() const { return few_touched ? &touched_particles : nullptr; }

  // For the limit of stability, of active fluid particles, also without pressure.  Of all, or
  // null: 1 if it is under pressure, 0 in free flight, or a share.  Vertices
  // are all boundary particles of some types, is_vertex [n_types + 1]: sums over fluid with these
  // weights, of all; then the rows, of vertices whose stiffness is complete, ghosts too; of
  // scaled ones friction alone
  virtual void stiffness(const Particles &, const Selection &of, const double *share,
                         Stiffness *) = 0;
  virtual void vertex_stiffness(const Particles &, const int *is_vertex, const double *weight,
                                VertexStiffness *) = 0;
  virtual void vertex_rows(const Particles &, const int *is_vertex, const VertexStiffness *,
                           bool scaled, VertexRow *) = 0;
  // For mass scaling: of every active fluid particle the sums of |d rho/d x_j| e e^T and
  // |d rho/d x_j| e over vertices j, e from it to the particle; and the fluid beside each owned
  // vertex that has a strength above 0, with the stiffness strength |d rho/d x_j|, and its motion
  // along e and across a surface with these normals, [n_all][3]
  virtual void vertex_gradients(const Particles &, const int *is_vertex, VertexGradients *) = 0;
  virtual void vertex_pairs(const Particles &, const int *is_vertex, const double *strength,
                            const double *normals, VertexPairs &) = 0;

  // the virials of the same forces: receive(context, i, ...)
  virtual void virials(const Particles &, Receiver, void *context) = 0;

  // how often a loop has evaluated a neighbor of a particle since it was asked last
  virtual double take_pair_evaluations() = 0;
  virtual double bytes() const = 0;

  const DualLists &order() const { return lists; }
  DualLists &order() { return lists; }
  // neighbors of one type inside the support, and some a little outside it
  NeighborSpan neighbors(int owned, int type)
  {
    lists.refresh(lists.slot(owned));
    return lists(lists.slot(owned), type);
  }
  // how many are inside the support; counts up to `max`
  int count_inside(const Particles &, int owned, int type, int max) const;

 protected:
  Points points(const Particles &p) const
  {
    return {p.x, p.type, p.n_owned, p.n_all, model.n_types, p.sides, p.layers};
  }

  void find_touched(const Particles &);

  DualLists lists;
  Selection selection;
  bool all_selected = false;    // is selected, of these lists
  std::vector<int> touched_particles;
  std::vector<std::uint8_t> is_touched;    // of all, 1: it stands in touched_particles
  bool few_touched = false;
};

}    // namespace sphcloth

#endif
