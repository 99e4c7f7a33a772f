// The loops over neighbours, for one kernel and one precision.
//
// Particles are read as records of four numbers, position with density and velocity with pressure,
// which become columns of the neighbours of one particle; the terms are then plain SIMD loops.
// Every loop writes one accumulator per particle and evaluates terms that are antisymmetric in the
// two partners to the last bit, so the two halves of a pair cancel without a half list or a reverse
// communication, in single precision too.

#ifndef SPHCLOTH_CORE_SPH_FLUID_LOOPS_H
#define SPHCLOTH_CORE_SPH_FLUID_LOOPS_H

#include "core/sph/fluid.h"
#include "core/sph/gradient.h"

#include <array>
#include <limits>

namespace sphcloth {

struct DoublePrecision {
  using Real = double;
  using Coordinate = double;
  static constexpr bool COUNTED = false;
  static Real difference(Coordinate a, Coordinate b, Real) { return a - b; }
};

// Coordinates are counted in a quantum: their differences are exact however far from the origin.

struct MixedPrecision {
  using Real = float;
  using Coordinate = std::int32_t;
  static constexpr bool COUNTED = true;
  static Real difference(Coordinate a, Coordinate b, Real quantum)
  {
    return quantum * static_cast<Real>(a - b);
  }
};

template <class K, class P> class FluidLoops : public Fluid {
 public:
  using Real = typename P::Real;
  using Coordinate = typename P::Coordinate;
  static constexpr int LANES = GROUP<Real>;

  void place(const Particles &, const Box &) override;
  void volumes(const Particles &, int type, double *amount) override;
  void gather(const Particles &, bool sum) override;
  void density_gradients(const Particles &p, double *gradient) override
  {
    all_density_gradients(p, gradient);
  }
  void density_rates(const Particles &, const double *gradient, double back, double *rate) override;
  void smooth_densities(const Particles &, double *smooth) override;
  void boundary_pressures(const Particles &, int type, double *pressure) override;
  void record(const Particles &p) override { record_all(p); }
  void forces(const Particles &, Target) override;
  void record_impulses(const Particles &, const double *pressure_time, const double *span) override;
  void impulses(const Particles &, const std::vector<int> &slots) override;
  void virials(const Particles &, Receiver, void *context) override;
  double bytes() const override;

 private:
  struct Site {
    Coordinate x, y, z;
    Real own;    // fluid: density; boundary: volume
  };
  struct Motion {
    Real u, v, w, pressure;
  };
  struct Gradient {
    Real x, y, z, none;
  };
  // one group of neighbours
  struct Columns {
    alignas(64) Coordinate x[LANES], y[LANES], z[LANES];
    alignas(64) Real own[LANES], u[LANES], v[LANES], w[LANES], pressure[LANES];
    alignas(64) Real span[LANES];    // of impulses
  };
  // of all neighbours of one particle: one column for all groups, step 0, if they are equal
  struct Masses {
    const double *of;
    int step;
    const double *group(int from) const { return of + from * step; }
  };

  template <Outputs ALSO, bool VIRIAL> struct Sums {
    LaneSum<LANES> x, y, z, drho, virial[VIRIAL ? 6 : 0];
    alignas(64) Real approach_sq[LANES] = {};
    Acceleration total() const
    {
      Acceleration a{x.total(), y.total(), z.total(), drho.total(), 0.0, {}};
      if (ALSO == Outputs::RATE_AND_APPROACH)
        a.approach = std::sqrt(*std::max_element(approach_sq, approach_sq + LANES));
      if (VIRIAL)
        for (int m = 0; m < 6; m++) a.virial[m] = 0.5 * virial[m].total();
      return a;
    }
  };

  struct DifferenceSums {
    LaneSum<LANES> xx, yy, zz, xy, xz, yz, x, y, z;
    Differences total() const
    {
      return {xx.total(), yy.total(), zz.total(), xy.total(), xz.total(),
              yz.total(), x.total(),  y.total(),  z.total()};
    }
  };

  // PairTerms in the precision of the loops
  struct Terms {
    Real inv_support, support_sq, f, nu, monaghan, soft, rho0, stiffness, diffusion;
    Coordinate far;    // a distance along x outside the support
    Terms(const PairTerms &t, Real quantum) :
        inv_support(Real(t.kernel.inv_support)), support_sq(Real(t.kernel.support_sq)),
        f(Real(t.kernel.f)), nu(Real(t.nu)), monaghan(Real(t.monaghan)), soft(Real(t.soft)),
        rho0(Real(t.rho0)), stiffness(Real(t.stiffness)), diffusion(Real(t.diffusion)),
        far(inv_support > 0 ? static_cast<Coordinate>(Real(2) / (inv_support * quantum)) : 0)
    {
    }
  };

  std::array<Real, 3> quantum{1, 1, 1};
  std::vector<Terms> terms;    // as the model's, for this evaluation
  AlignedVector<double> equal_mass;    // [n_types + 1][LANES]
  AlignedVector<double> unequal_mass;    // of the neighbours of one particle
  AlignedVector<Site> sites;
  AlignedVector<Motion> motions;
  AlignedVector<Gradient> gradients;    // of the density, empty unless it diffuses
  std::vector<Real> spans;    // of impulses, empty without them
  std::vector<int> acts;    // 1: has one, or a pressure

  bool is_fluid(int t) const { return model.role[t] == Role::FLUID; }

  // virtual functions cannot be multiversioned, so these do their work
  void place_all(const Particles &, const std::array<double, 3> &origin,
                 const std::array<double, 3> &per_quantum);
  void record_all(const Particles &);
  void all_density_gradients(const Particles &, double *gradient);
  template <bool DIFFUSION> void all_density_rates(const Particles &, double back, double *rate);

  static double weight(const Particles &, int i, int j, const KernelScale &);
  void settle();
  const Terms &pair(int t, int other) const { return terms[t * (model.n_types + 1) + other]; }
  template <bool WEIGHTED>
  double shape_sum(int i, const NeighborSpan &, const Terms &, Masses, Columns &) const;
  void sum_up(const Particles &, bool sum);
  void fill_sites(Columns &, const NeighborSpan &, int from, Coordinate far) const;
  void fill(Columns &, const NeighborSpan &, int from, Coordinate far) const;
  static void fill_up(Columns &, int n, Coordinate far);
  Masses masses(const Particles &, const NeighborSpan &, int type);
  void fill_spans(Columns &, const int *near) const;

  template <Outputs ALSO, bool VIRIAL>
  static void add(Sums<ALSO, VIRIAL> &, int lane, double amount, Real fx, Real fy, Real fz,
                  Real rate, Real dx, Real dy, Real dz);
  template <Outputs ALSO, bool VIRIAL>
  static void meet(Sums<ALSO, VIRIAL> &, int lane, Real v_dot_r, Real r_sq, Real support_sq);
  void apply(const Particles &, int i, bool fluid, const Acceleration &) const;
  template <Friction F, Outputs ALSO, bool VIRIAL>
  void all_forces(const Particles &, Target, Receiver, void *);
  template <Outputs ALSO> void forces_and(const Particles &, Target);
  template <Friction F> void all_impulses(const Particles &, const std::vector<int> &slots);
  template <Friction F, Outputs ALSO, bool VIRIAL, bool IMPULSE>
  void all_on(const Particles &, int slot, int t, Columns &, Receiver, void *);
  template <Friction F, Outputs ALSO, bool VIRIAL, bool IMPULSE>
  void fluid_on_fluid(int i, const NeighborSpan &, const Terms &, Masses, Columns &,
                      Sums<ALSO, VIRIAL> &) const;
  template <Friction F, Outputs ALSO, bool VIRIAL, bool IMPULSE, bool ON_BOUNDARY>
  void across_boundary(int i, const NeighborSpan &, const Terms &, Masses, Columns &,
                       Sums<ALSO, VIRIAL> &) const;
  Differences density_differences(int i, const NeighborSpan &, const Terms &, Masses,
                                  Columns &) const;
  template <bool FROM_BOUNDARY, bool DIFFUSION>
  double density_rate(int i, const NeighborSpan &, const Terms &, Masses, double back,
                      Columns &) const;
};

/* ----------------------------------------------------------------------
   records
------------------------------------------------------------------------- */

template <class K, class P> void FluidLoops<K, P>::place(const Particles &p, const Box &box)
{
  sites.resize(p.n_all + LANES);
  motions.resize(p.n_all + LANES);
  std::array<double, 3> origin{0.0, 0.0, 0.0}, per_quantum{1.0, 1.0, 1.0};
  if (P::COUNTED) {
    const double longest = *std::max_element(box.length, box.length + 3) + 2.0 * box.margin;
    for (int d = 0; d < 3; d++) {
      origin[d] = box.lo[d] - box.margin;
      per_quantum[d] = std::ceil(box.length[d] / longest * 0x1p30) / box.length[d];
      quantum[d] = static_cast<Real>(1.0 / per_quantum[d]);
    }
  }
  place_all(p, origin, per_quantum);
}

template <class K, class P>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::place_all(const Particles &p,
                                                       const std::array<double, 3> &origin,
                                                       const std::array<double, 3> &per_quantum)
{
  const double ox = origin[0], oy = origin[1], oz = origin[2];
  const double qx = per_quantum[0], qy = per_quantum[1], qz = per_quantum[2];
  for (int i = 0; i < p.n_all; i++) {
    sites[i].x = static_cast<Coordinate>((p.x[3 * i] - ox) * qx);
    sites[i].y = static_cast<Coordinate>((p.x[3 * i + 1] - oy) * qy);
    sites[i].z = static_cast<Coordinate>((p.x[3 * i + 2] - oz) * qz);
  }
}

template <class K, class P>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::record_all(const Particles &p)
{
  for (int i = 0; i < p.n_all; i++) {
    const bool fluid = is_fluid(p.type[i]);
    sites[i].own = static_cast<Real>(fluid ? p.rho[i] : p.mass_or_volume[i]);
    motions[i] = {static_cast<Real>(p.v[3 * i]), static_cast<Real>(p.v[3 * i + 1]),
                  static_cast<Real>(p.v[3 * i + 2]), static_cast<Real>(p.pressure[i])};
  }
}

// Once per evaluation: what the loops read of the model, in their precision

template <class K, class P> void FluidLoops<K, P>::settle()
{
  terms.clear();
  for (const PairTerms &of_pair : model.terms) terms.emplace_back(of_pair, quantum[0]);
  equal_mass.resize(model.mass.size() * LANES);
  for (std::size_t t = 0; t < model.mass.size(); t++)
    std::fill_n(&equal_mass[t * LANES], LANES, model.mass[t]);
  unequal_mass.resize(whole_groups(lists.longest()));
}

template <class K, class P>
SPHCLOTH_INLINE void FluidLoops<K, P>::fill_sites(Columns &c, const NeighborSpan &near, int from,
                                                  Coordinate far) const
{
  columns(&sites[0].x, near.of + from, c.x, c.y, c.z, c.own);
  fill_up(c, near.n - from, far);
}

// What fills up the last group, of n, lies outside the support.

template <class K, class P>
SPHCLOTH_INLINE void FluidLoops<K, P>::fill_up(Columns &c, int n, Coordinate far)
{
  if (P::COUNTED) {    // a blend is the faster way with integers, a branch with doubles
#pragma omp simd
    for (int m = 0; m < LANES; m++) c.x[m] = m < n ? c.x[m] : far;
  } else if (n < LANES) {
#pragma GCC unroll 1
    for (int m = LANES - 1; m >= n; m--) c.x[m] = far;
  }
}

template <class K, class P>
SPHCLOTH_INLINE void FluidLoops<K, P>::fill(Columns &c, const NeighborSpan &near, int from,
                                            Coordinate far) const
{
  columns(&motions[0].u, near.of + from, c.u, c.v, c.w, c.pressure);
  fill_sites(c, near, from, far);
}

template <class K, class P>
SPHCLOTH_INLINE typename FluidLoops<K, P>::Masses
FluidLoops<K, P>::masses(const Particles &p, const NeighborSpan &near, int type)
{
  if (model.mass[type] > 0.0) return {&equal_mass[type * LANES], 0};
  for (int k = 0; k < near.n; k++) unequal_mass[k] = p.mass_or_volume[near.of[k]];
  return {unequal_mass.data(), 1};
}

template <class K, class P>
SPHCLOTH_INLINE void FluidLoops<K, P>::fill_spans(Columns &c, const int *near) const
{
  for (int m = 0; m < LANES; m++) c.span[m] = spans[near[m]];
}

/* ----------------------------------------------------------------------
   neighbours and density (1)
------------------------------------------------------------------------- */

// sum of the kernel's shape over neighbours, of their amounts times it if WEIGHTED

template <class K, class P>
template <bool WEIGHTED>
SPHCLOTH_INLINE double FluidLoops<K, P>::shape_sum(int i, const NeighborSpan &near, const Terms &t,
                                                   Masses masses, Columns &c) const
{
  const Site self = sites[i];
  const Coordinate far = self.x + t.far;
  const Real qx = quantum[0], qy = quantum[1], qz = quantum[2];
  LaneSum<LANES> sum;
  for (int from = 0; from < near.n; from += LANES) {
    columns(&sites[0].x, near.of + from, c.x, c.y, c.z, static_cast<Real *>(nullptr));
    fill_up(c, near.n - from, far);
    const double *mass = WEIGHTED ? masses.group(from) : nullptr;
#pragma omp simd
    for (int k = 0; k < LANES; k++) {
      const Real dx = P::difference(self.x, c.x[k], qx), dy = P::difference(self.y, c.y[k], qy),
                 dz = P::difference(self.z, c.z[k], qz);
      const Real w = K::shape(std::sqrt(dx * dx + dy * dy + dz * dz) * t.inv_support);
      sum.of[k] += WEIGHTED ? mass[k] * w : w;
    }
  }
  return sum.total();
}

// Not a template of the caller's question but one function: `sum` is asked once per particle.

template <class K, class P>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::sum_up(const Particles &p, bool sum)
{
  Columns c;
  const int n_types = model.n_types;
  for (int t = 1; t <= n_types; t++) {
    const bool fluid = is_fluid(t);
    const double at_self = model.pair(t, t).kernel.w * K::shape(0.0);
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      lists.refresh(slot);
      if (!sum || !fluid) continue;
      double rho = p.mass_or_volume[i] * at_self;
      for (int other = 1; other <= n_types; other++) {
        const NeighborSpan near = lists(slot, other);
        if (near.n == 0) continue;
        const PairTerms &whole = model.pair(t, other);
        const double equal = model.mass[other], each = is_fluid(other) ? 1.0 : whole.rho0;
        const Masses amounts = masses(p, near, other);
        rho += whole.kernel.w *
            (equal > 0.0 ? equal * shape_sum<false>(i, near, pair(t, other), amounts, c)
                         : each * shape_sum<true>(i, near, pair(t, other), amounts, c));
      }
      p.rho[i] = rho;
    }
  }
}

template <class K, class P> void FluidLoops<K, P>::gather(const Particles &p, bool sum)
{
  settle();
  sum_up(p, sum);
}

// The wall's or the sheet's share of space

template <class K, class P>
void FluidLoops<K, P>::volumes(const Particles &, int type, double *amount)
{
  const PairTerms &whole = model.pair(type, type);
  const Terms among_each_other(whole, quantum[0]);
  Columns c;
  for (int slot = lists.begin(type); slot < lists.begin(type + 1); slot++) {
    const int i = lists.at(slot);
    lists.refresh(slot);
    const double sum = shape_sum<false>(i, lists(slot, type), among_each_other, {}, c);
    amount[i] = 1.0 / (whole.kernel.w * (K::shape(0.0) + sum));
  }
}

/* ----------------------------------------------------------------------
   momentum (2)
------------------------------------------------------------------------- */

// one pair: its force and rate per the amount of the neighbour, in lane m

template <class K, class P>
template <Outputs ALSO, bool VIRIAL>
SPHCLOTH_INLINE void FluidLoops<K, P>::add(Sums<ALSO, VIRIAL> &s, int m, double amount, Real fx,
                                           Real fy, Real fz, Real rate, Real dx, Real dy, Real dz)
{
  const double x = amount * fx, y = amount * fy, z = amount * fz;
  s.x.of[m] += x;
  s.y.of[m] += y;
  s.z.of[m] += z;
  if (ALSO != Outputs::NOTHING) s.drho.of[m] += amount * rate;
  if (VIRIAL) {
    s.virial[0].of[m] += dx * x;
    s.virial[1].of[m] += dy * y;
    s.virial[2].of[m] += dz * z;
    s.virial[3].of[m] += dx * y;
    s.virial[4].of[m] += dx * z;
    s.virial[5].of[m] += dy * z;
  }
}

// The square of the largest speed at which a neighbour inside the support comes near

template <class K, class P>
template <Outputs ALSO, bool VIRIAL>
SPHCLOTH_INLINE void FluidLoops<K, P>::meet(Sums<ALSO, VIRIAL> &s, int m, Real v_dot_r, Real r_sq,
                                            Real support_sq)
{
  if (ALSO != Outputs::RATE_AND_APPROACH) return;
  const Real closing = std::min(v_dot_r, Real(0));
  const Real speed_sq = closing * closing / std::max(r_sq, std::numeric_limits<Real>::min());
  s.approach_sq[m] = std::max(s.approach_sq[m], r_sq < support_sq ? speed_sq : Real(0));
}

// Laminar viscosity: Morris, Fox & Zhu, J. Comput. Phys. 136 (1997) 214.
// Artificial viscosity: Monaghan, Annu. Rev. Astron. Astrophys. 30 (1992) 543; it adds to the
// pressure terms, p_i/rho_i^2 + p_j/rho_j^2, along the line of the particles.

template <class K, class P>
template <Friction F, Outputs ALSO, bool VIRIAL, bool IMPULSE>
SPHCLOTH_INLINE void FluidLoops<K, P>::fluid_on_fluid(int i, const NeighborSpan &near,
                                                      const Terms &t, Masses masses, Columns &c,
                                                      Sums<ALSO, VIRIAL> &sums) const
{
  const Site site = sites[i];
  const Motion motion = motions[i];
  const Coordinate far = site.x + t.far;
  const Real qx = quantum[0], qy = quantum[1], qz = quantum[2];
  const Real span = IMPULSE ? spans[i] : Real(1);

  for (int from = 0; from < near.n; from += LANES) {
    fill(c, near, from, far);
    const double *mass = masses.group(from);
    if (IMPULSE) fill_spans(c, near.of + from);
#pragma omp simd
    for (int k = 0; k < LANES; k++) {
      const Real dx = P::difference(site.x, c.x[k], qx), dy = P::difference(site.y, c.y[k], qy),
                 dz = P::difference(site.z, c.z[k], qz);
      const Real du = motion.u - c.u[k], dv = motion.v - c.v[k], dw = motion.w - c.w[k];
      const Real r_sq = dx * dx + dy * dy + dz * dz;
      const Real slope = t.f * K::slope_over_q(std::sqrt(r_sq) * t.inv_support);
      const Real v_dot_r = du * dx + dv * dy + dw * dz;

      const bool asleep = IMPULSE && c.span[k] < Real(0);
      const Real mean = IMPULSE ? (asleep ? span : Real(0.5) * (span + c.span[k])) : Real(1);
      Real along = motion.pressure + (asleep ? span : Real(1)) * c.pressure[k];
      if (F != Friction::NONE) {
        const Real both = site.own + c.own[k];
        along -=
            mean * Real(2) * t.monaghan * std::min(v_dot_r, Real(0)) / ((r_sq + t.soft) * both);
      }
      const Real push = -slope * along;
      Real fx = push * dx, fy = push * dy, fz = push * dz;
      if (F == Friction::ANY) {
        const Real friction = mean * slope * t.nu * (site.own + c.own[k]) / (site.own * c.own[k]);
        fx += friction * du;
        fy += friction * dv;
        fz += friction * dw;
      }
      meet(sums, k, v_dot_r, r_sq, t.support_sq);
      add<ALSO, VIRIAL>(sums, k, mass[k], fx, fy, fz, slope * v_dot_r, dx, dy, dz);
    }
  }
}

// One fluid particle f and one boundary particle b: the force between them over m_f V_b.
// The pressure of the boundary particle is 0 unless it was given one.  Without it the term is the
// gradient of the fluid's energy with the density sum that the boundary takes part in.
// ON_BOUNDARY = false: i is fluid, the result is an acceleration.  ON_BOUNDARY = true: i is
// boundary, its neighbours are fluid, the result is a force per volume.

template <class K, class P>
template <Friction F, Outputs ALSO, bool VIRIAL, bool IMPULSE, bool ON_BOUNDARY>
SPHCLOTH_INLINE void FluidLoops<K, P>::across_boundary(int i, const NeighborSpan &near,
                                                       const Terms &t, Masses masses, Columns &c,
                                                       Sums<ALSO, VIRIAL> &sums) const
{
  const Site site = sites[i];
  const Motion motion = motions[i];
  const Coordinate far = site.x + t.far;
  const Real qx = quantum[0], qy = quantum[1], qz = quantum[2];
  const Real own_span = IMPULSE && !ON_BOUNDARY ? spans[i] : Real(1);

  for (int from = 0; from < near.n; from += LANES) {
    fill(c, near, from, far);
    const double *mass = ON_BOUNDARY ? masses.group(from) : nullptr;
    if (IMPULSE && ON_BOUNDARY) fill_spans(c, near.of + from);
#pragma omp simd
    for (int k = 0; k < LANES; k++) {
      const Real dx = P::difference(site.x, c.x[k], qx), dy = P::difference(site.y, c.y[k], qy),
                 dz = P::difference(site.z, c.z[k], qz);
      const Real du = motion.u - c.u[k], dv = motion.v - c.v[k], dw = motion.w - c.w[k];
      const Real r_sq = dx * dx + dy * dy + dz * dz;
      const Real slope = t.rho0 * t.f * K::slope_over_q(std::sqrt(r_sq) * t.inv_support);
      const Real v_dot_r = du * dx + dv * dy + dw * dz;
      const Real rho = ON_BOUNDARY ? c.own[k] : site.own;

      // the time of the fluid, whose pressure comes with it; that of the boundary does not
      const Real span = !IMPULSE ? Real(1)
          : !ON_BOUNDARY         ? own_span
          : c.span[k] < Real(0)  ? Real(1)
                                 : c.span[k];
      Real along = t.stiffness *
          (ON_BOUNDARY ? span * motion.pressure + c.pressure[k]
                       : motion.pressure + span * c.pressure[k]);
      if (F != Friction::NONE)
        along -= span * t.monaghan * std::min(v_dot_r, Real(0)) / ((r_sq + t.soft) * rho);
      const Real push = -slope * along;
      Real fx = push * dx, fy = push * dy, fz = push * dz;
      if (F == Friction::ANY) {
        const Real friction = span * slope * t.nu * Real(2) / rho;
        fx += friction * du;
        fy += friction * dv;
        fz += friction * dw;
      }
      if (!ON_BOUNDARY) meet(sums, k, v_dot_r, r_sq, t.support_sq);
      const double amount = ON_BOUNDARY ? mass[k] : static_cast<double>(c.own[k]);
      add<ALSO, VIRIAL>(sums, k, amount, fx, fy, fz, slope * v_dot_r, dx, dy, dz);
    }
  }
}

// everything that one particle feels

template <class K, class P>
template <Friction F, Outputs ALSO, bool VIRIAL, bool IMPULSE>
SPHCLOTH_INLINE void FluidLoops<K, P>::all_on(const Particles &p, int slot, int t, Columns &c,
                                              Receiver receive, void *context)
{
  const int i = lists.at(slot);
  const bool fluid = is_fluid(t);
  // who has no impulse of its own feels those of others alone
  const bool gives = !IMPULSE || (fluid && acts[i]);
  lists.refresh(slot);
  Sums<ALSO, VIRIAL> sums;
  int met = 0;
  for (int other = 1; other <= model.n_types; other++) {
    const NeighborSpan found = gives ? lists(slot, other)
                                     : lists.others(0, slot, other, acts.data());
    if (found.n == 0 || !(fluid || is_fluid(other))) continue;
    met += found.n;
    const Terms &of_pair = pair(t, other);
    if (fluid && is_fluid(other))
      fluid_on_fluid<F, ALSO, VIRIAL, IMPULSE>(i, found, of_pair, masses(p, found, other), c, sums);
    else if (fluid)
      across_boundary<F, ALSO, VIRIAL, IMPULSE, false>(i, found, of_pair, {}, c, sums);
    else
      across_boundary<F, ALSO, VIRIAL, IMPULSE, true>(i, found, of_pair, masses(p, found, other), c,
                                                      sums);
  }
  const Acceleration a = sums.total();
  if (ALSO == Outputs::RATE_AND_APPROACH && fluid) p.approach[i] = a.approach;
  if (!met) return;
  if (VIRIAL)
    receive(context, i, a);
  else
    apply(p, i, fluid, a);
}

template <class K, class P>
template <Friction F, Outputs ALSO, bool VIRIAL>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_forces(const Particles &p, Target whom,
                                                        Receiver receive, void *context)
{
  Columns c;
  for (int t = 1; t <= model.n_types; t++) {
    if (whom == (is_fluid(t) ? Target::BOUNDARIES : Target::FLUID)) continue;
    for (const int slot : selection.of(t))
      all_on<F, ALSO, VIRIAL, false>(p, slot, t, c, receive, context);
  }
}

template <class K, class P>
template <Friction F>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_impulses(const Particles &p,
                                                          const std::vector<int> &slots)
{
  Columns c;
  for (const int slot : slots)
    all_on<F, Outputs::NOTHING, false, true>(p, slot, p.type[lists.at(slot)], c, nullptr, nullptr);
}

template <class K, class P>
void FluidLoops<K, P>::impulses(const Particles &p, const std::vector<int> &slots)
{
  switch (model.friction) {
    case Friction::NONE: return all_impulses<Friction::NONE>(p, slots);
    case Friction::ARTIFICIAL: return all_impulses<Friction::ARTIFICIAL>(p, slots);
    case Friction::ANY: return all_impulses<Friction::ANY>(p, slots);
  }
}

template <class K, class P>
void FluidLoops<K, P>::record_impulses(const Particles &p, const double *pressure_time,
                                       const double *span)
{
  spans.resize(p.n_all);
  acts.resize(p.n_all);
  for (int i = 0; i < p.n_all; i++) {
    motions[i].pressure = static_cast<Real>(pressure_time[i]);
    spans[i] = static_cast<Real>(span[i]);
    acts[i] = span[i] != 0.0 || pressure_time[i] != 0.0;
  }
}

template <class K, class P>
SPHCLOTH_INLINE void FluidLoops<K, P>::apply(const Particles &p, int i, bool fluid,
                                             const Acceleration &a) const
{
  // the volume that the fluid has seen, to the last bit
  const double amount = fluid ? p.mass_or_volume[i] : static_cast<double>(sites[i].own);
  const double scale = amount * p.force_unit;
  p.f[3 * i] += scale * a.x;
  p.f[3 * i + 1] += scale * a.y;
  p.f[3 * i + 2] += scale * a.z;
  if (fluid) p.drho[i] += a.drho;
}

template <class K, class P> void FluidLoops<K, P>::forces(const Particles &p, Target whom)
{
  switch (model.outputs) {
    case Outputs::NOTHING: return forces_and<Outputs::NOTHING>(p, whom);
    case Outputs::RATE: return forces_and<Outputs::RATE>(p, whom);
    case Outputs::RATE_AND_APPROACH: return forces_and<Outputs::RATE_AND_APPROACH>(p, whom);
  }
}

template <class K, class P>
template <Outputs ALSO>
void FluidLoops<K, P>::forces_and(const Particles &p, Target whom)
{
  switch (model.friction) {
    case Friction::NONE: return all_forces<Friction::NONE, ALSO, false>(p, whom, nullptr, nullptr);
    case Friction::ARTIFICIAL:
      return all_forces<Friction::ARTIFICIAL, ALSO, false>(p, whom, nullptr, nullptr);
    case Friction::ANY: return all_forces<Friction::ANY, ALSO, false>(p, whom, nullptr, nullptr);
  }
}

// Beside the forces and only when asked: what is printed must not change, not even in the last
// bit, what is computed.

template <class K, class P>
void FluidLoops<K, P>::virials(const Particles &p, Receiver receive, void *context)
{
  all_forces<Friction::ANY, Outputs::NOTHING, true>(p, Target::ALL, receive, context);
}

/* ----------------------------------------------------------------------
   density by continuity: d rho_i/dt = sum_j m_j v_ij . grad W_ij and, between fluid particles of one
   type, diffusion, with <grad rho> of core/sph/gradient.h and r_ji = x_j - x_i,
     2 delta c0 h_s sum_j m_j/rho_j psi_ij r_ji . grad W_ij / r^2
     psi_ij = rho_j - rho_i - (<grad rho>_i + <grad rho>_j) . r_ji / 2
   Antuono, Colagrossi, Marrone & Molteni, Comput. Phys. Commun. 181 (2010) 532.
------------------------------------------------------------------------- */

// Only fluid of its own type takes part: a boundary has no density, and the gradient is exact for
// a linear field on one side, too.

template <class K, class P>
SPHCLOTH_INLINE Differences FluidLoops<K, P>::density_differences(int i, const NeighborSpan &near,
                                                                  const Terms &t, Masses masses,
                                                                  Columns &c) const
{
  const Site site = sites[i];
  const Coordinate far = site.x + t.far;
  const Real qx = quantum[0], qy = quantum[1], qz = quantum[2];
  DifferenceSums sums;
  for (int from = 0; from < near.n; from += LANES) {
    fill_sites(c, near, from, far);
    const double *mass = masses.group(from);
#pragma omp simd
    for (int k = 0; k < LANES; k++) {
      const Real dx = P::difference(site.x, c.x[k], qx), dy = P::difference(site.y, c.y[k], qy),
                 dz = P::difference(site.z, c.z[k], qz);
      const Real r = std::sqrt(dx * dx + dy * dy + dz * dz);
      const double weight = mass[k] * (t.f * K::slope_over_q(r * t.inv_support) / c.own[k]);
      const double wx = weight * dx, wy = weight * dy, wz = weight * dz;
      sums.xx.of[k] -= wx * dx;
      sums.yy.of[k] -= wy * dy;
      sums.zz.of[k] -= wz * dz;
      sums.xy.of[k] -= wx * dy;
      sums.xz.of[k] -= wx * dz;
      sums.yz.of[k] -= wy * dz;
      const Real more = c.own[k] - site.own;
      sums.x.of[k] += wx * more;
      sums.y.of[k] += wy * more;
      sums.z.of[k] += wz * more;
    }
  }
  return sums.total();
}

template <class K, class P>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_density_gradients(const Particles &p,
                                                                   double *gradient)
{
  Columns c;
  for (int t = 1; t <= model.n_types; t++) {
    if (!is_fluid(t)) continue;
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      const NeighborSpan found = lists(slot, t);
      const std::array<double, 3> of_i =
          density_differences(i, found, pair(t, t), masses(p, found, t), c)
              .gradient(model.dimension);
      std::copy(of_i.begin(), of_i.end(), gradient + 3 * i);
    }
  }
}

template <class K, class P>
template <bool FROM_BOUNDARY, bool DIFFUSION>
SPHCLOTH_INLINE double FluidLoops<K, P>::density_rate(int i, const NeighborSpan &near,
                                                      const Terms &t, Masses masses, double back,
                                                      Columns &c) const
{
  const Site site = sites[i];
  const Motion motion = motions[i];
  const Coordinate far = site.x + t.far;
  const Real qx = quantum[0], qy = quantum[1], qz = quantum[2], ago = static_cast<Real>(back);
  const Gradient gradient = DIFFUSION ? gradients[i] : Gradient();
  alignas(64) Real gx[LANES], gy[LANES], gz[LANES];
  LaneSum<LANES> rate;
  for (int from = 0; from < near.n; from += LANES) {
    fill(c, near, from, far);
    if (DIFFUSION)
      columns(&gradients[0].x, near.of + from, gx, gy, gz, static_cast<Real *>(nullptr));
    const double *mass = FROM_BOUNDARY ? nullptr : masses.group(from);
#pragma omp simd
    for (int k = 0; k < LANES; k++) {
      const Real dx = P::difference(site.x, c.x[k], qx), dy = P::difference(site.y, c.y[k], qy),
                 dz = P::difference(site.z, c.z[k], qz);
      const Real du = motion.u - c.u[k], dv = motion.v - c.v[k], dw = motion.w - c.w[k];
      const Real ax = dx - ago * du, ay = dy - ago * dv, az = dz - ago * dw;
      // those outside the support now take no part: some of them are in the list, others are not
      const Real q_now_sq = (dx * dx + dy * dy + dz * dz) * t.inv_support * t.inv_support;
      const Real q = std::sqrt(ax * ax + ay * ay + az * az) * t.inv_support;
      const Real slope = t.f * K::slope_over_q(q_now_sq < Real(1) ? q : Real(1));
      const Real v_dot_r = du * ax + dv * ay + dw * az;
      const double amount = FROM_BOUNDARY ? static_cast<double>(c.own[k]) : mass[k];
      Real flow = FROM_BOUNDARY ? t.rho0 * v_dot_r : v_dot_r;
      if (DIFFUSION) {
        const Real linear =
            (gradient.x + gx[k]) * dx + (gradient.y + gy[k]) * dy + (gradient.z + gz[k]) * dz;
        flow += t.diffusion * (site.own - c.own[k] - Real(0.5) * linear) / c.own[k];
      }
      rate.of[k] += amount * (slope * flow);
    }
  }
  return rate.total();
}

template <class K, class P>
void FluidLoops<K, P>::density_rates(const Particles &p, const double *gradient, double back,
                                     double *rate)
{
  if (!gradient) return all_density_rates<false>(p, back, rate);
  gradients.resize(p.n_all + LANES);
  for (int i = 0; i < p.n_all; i++)
    gradients[i] = {static_cast<Real>(gradient[3 * i]), static_cast<Real>(gradient[3 * i + 1]),
                    static_cast<Real>(gradient[3 * i + 2]), Real(0)};
  all_density_rates<true>(p, back, rate);
}

template <class K, class P>
template <bool DIFFUSION>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_density_rates(const Particles &p, double back,
                                                               double *rate)
{
  Columns c;
  for (int t = 1; t <= model.n_types; t++) {
    if (!is_fluid(t)) continue;
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      double sum = 0.0;
      for (int other = 1; other <= model.n_types; other++) {
        const NeighborSpan found = lists(slot, other);
        if (found.n == 0) continue;
        const Terms &of_pair = pair(t, other);
        if (!is_fluid(other))
          sum += density_rate<true, false>(i, found, of_pair, {}, back, c);
        else if (DIFFUSION && other == t)
          sum += density_rate<false, true>(i, found, of_pair, masses(p, found, other), back, c);
        else
          sum += density_rate<false, false>(i, found, of_pair, masses(p, found, other), back, c);
      }
      rate[i] = sum;
    }
  }
}

// Shepard interpolation: constant densities stay, also at a free surface.  Boundary particles take
// part with the rest density.

template <class K, class P>
void FluidLoops<K, P>::smooth_densities(const Particles &p, double *smooth)
{
  for (int t = 1; t <= model.n_types; t++) {
    if (!is_fluid(t)) continue;
    for (const int slot : selection.of(t)) {
      const int i = lists.at(slot);
      const double at_self = model.pair(t, t).kernel.w * K::shape(0.0);
      double mass = p.mass_or_volume[i] * at_self, volume = mass / p.rho[i];
      for (int other = 1; other <= model.n_types; other++) {
        const NeighborSpan found = lists(slot, other);
        const PairTerms &of_pair = model.pair(t, other);
        for (int k = 0; k < found.n; k++) {
          const int j = found.of[k];
          const double w = p.mass_or_volume[j] * weight(p, i, j, of_pair.kernel);
          mass += is_fluid(other) ? w : of_pair.rho0 * w;
          volume += is_fluid(other) ? w / p.rho[j] : w;
        }
      }
      smooth[i] = mass / volume;
    }
  }
}

// Adami, Hu & Adams, J. Comput. Phys. 231 (2012) 7057, without the weight of the fluid between.

template <class K, class P>
void FluidLoops<K, P>::boundary_pressures(const Particles &p, int type, double *pressure)
{
  for (int slot = lists.begin(type); slot < lists.begin(type + 1); slot++) {
    const int i = lists.at(slot);
    double sum = 0.0, weights = 0.0;
    for (int other = 1; other <= model.n_types; other++) {
      if (!is_fluid(other)) continue;
      const NeighborSpan found = lists(slot, other);
      for (int k = 0; k < found.n; k++) {
        const double w = weight(p, i, found.of[k], model.pair(type, other).kernel);
        sum += w * p.pressure[found.of[k]];
        weights += w;
      }
    }
    pressure[i] = weights > 0.0 ? sum / weights : 0.0;
  }
}

// W of a pair, for what is not evaluated at every step or for every particle

template <class K, class P>
double FluidLoops<K, P>::weight(const Particles &p, int i, int j, const KernelScale &s)
{
  const double dx = p.x[3 * i] - p.x[3 * j], dy = p.x[3 * i + 1] - p.x[3 * j + 1],
               dz = p.x[3 * i + 2] - p.x[3 * j + 2];
  return s.w * K::shape(std::sqrt(dx * dx + dy * dy + dz * dz) * s.inv_support);
}

/* ---------------------------------------------------------------------- */

template <class K, class P> double FluidLoops<K, P>::bytes() const
{
  return lists.bytes() + bytes_of(selection.slots, sites, motions, gradients, spans, acts);
}

template <class K> std::unique_ptr<Fluid> fluid_of_kernel(Precision precision)
{
  if (precision == Precision::MIXED) return std::make_unique<FluidLoops<K, MixedPrecision>>();
  return std::make_unique<FluidLoops<K, DoublePrecision>>();
}

}    // namespace sphcloth

#endif
