// SPDX-License-Identifier: GPL-2.0-or-later
// Limits of the time step: equations (10) to (12), the limit that stability asks for, and those of
// sound, viscosity and density.
//
// (10) and (11) use the support radius H, the paper's h.  The acoustic and the viscous limit use
// the smoothing length h_s = H/2, as stability analysis does.
//
// Stability: semi-implicit Euler, x'' = -omega^2 x - r x' with the friction of the step before, is
// stable while omega^2 dt^2 + 2 r dt <= 4.  What friction stops alone changes its sign in no step
// while r dt <= 1.  The largest omega and r that a particle has a part in are those of
// core/sph/stiffness.h.
//
// The control by compression follows Ihmsen, Akinci, Gissler & Teschner, VRIPHYS 2010, 79.

#ifndef SPHCLOTH_CORE_TIMESTEP_STEP_LIMITS_H
#define SPHCLOTH_CORE_TIMESTEP_STEP_LIMITS_H

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/util/simd.h"

namespace sphcloth {

// those of a particle or a vertex, then those of the step

enum class Limit {
  NONE,
  VELOCITY,
  FORCE,
  ACOUSTIC,
  VISCOUS,
  DENSITY,
  RELATIVE,
  WETTED,
  CLOTH,
  CEILING,
  FLOOR,
  GROWTH,
  FLUCTUATION,
  OUTPUT
};
inline constexpr int N_LIMITS = 1 + static_cast<int>(Limit::OUTPUT);
// the limits that a particle can have for itself, the ceiling as the last
inline constexpr int N_OF_PARTICLES = static_cast<int>(Limit::CEILING);

// as it is kept in a column of numbers

inline Limit limit_of(double kept) { return static_cast<Limit>(static_cast<int>(kept)); }

inline const char *limit_name(Limit limit)
{
  switch (limit) {
    case Limit::NONE: return "none";
    case Limit::VELOCITY: return "velocity";
    case Limit::FORCE: return "force";
    case Limit::ACOUSTIC: return "acoustic";
    case Limit::VISCOUS: return "viscous";
    case Limit::DENSITY: return "density";
    case Limit::RELATIVE: return "relative";
    case Limit::WETTED: return "wetted";
    case Limit::CLOTH: return "cloth";
    case Limit::CEILING: return "max";
    case Limit::FLOOR: return "min";
    case Limit::GROWTH: return "growth";
    case Limit::FLUCTUATION: return "fluctuation";
    case Limit::OUTPUT: return "output";
  }
  return "none";
}

// coefficients; a coefficient of 0 switches its limit off

struct StepCoefficients {
  double stability = 0.95;    // of the longest stable step, in the place of the next two
  double velocity = 0.15;    // lambda_v of (10)
  double force = 0.2;    // lambda_f of (11)
  double acoustic = 0.0;    // of h_s/c; on a lattice stable up to 1.6
  double viscous = 0.0;    // of h_s^2/nu; stable up to 0.3 in 3-D
  double density = 0.1;    // largest relative change of density in one step
  double relative = 0.0;    // as velocity, of the speed at which a neighbor approaches
  double cloth = 0.0;    // displacement of a vertex over the shortest edge at it
  std::optional<double> wetted;    // as acoustic, of wet vertices; the same if it is not given

  // do velocity, force and rate of density alone bound particles?
  bool motion_alone() const
  {
    return stability == 0.0 && acoustic == 0.0 && viscous == 0.0 && relative == 0.0;
  }

  // With which kinetic energy is off by less than this share: it is that of velocities half a step
  // old, and its error is of first order in the step.  The defaults are those of USUAL; stability
  // allows no more than they do.
  static constexpr double USUAL = 0.01;
  void set_accuracy(double error)
  {
    const StepCoefficients usual;
    const double times = error / USUAL;
    velocity = usual.velocity * times;
    force = usual.force * times;
    density = usual.density * times;
    stability = usual.stability * std::min(1.0, times);
  }

  // with the limits of sound and viscosity; those of the paper
  static constexpr double ACOUSTIC = 0.5, VISCOUS = 0.2, VELOCITY = 0.1, FORCE = 0.05;
};

// state of one particle

struct StepState {
  double support;    // H
  double speed_sq;    // |v|^2
  double accel_sq;    // |dv/dt|^2
  double sound;    // c
  double nu;    // kinematic viscosity, laminar and artificial together
  double rho;
  double drho;    // d rho / dt
  double approach = 0.0;    // largest speed at which a neighbor approaches
  double until_pressed = 0.0;    // time to the end of free flight; 0: there is pressure
  // squares of the largest frequencies with the fluid around, and with vertices; rate of friction
  double of_fluid_sq = 0.0, of_vertices_sq = 0.0, friction = 0.0;
};

struct StepLimit {
  double dt = std::numeric_limits<double>::infinity();
  Limit by = Limit::NONE;

  void tighten(double candidate, Limit reason)
  {
    if (candidate < dt) {
      dt = candidate;
      by = reason;
    }
  }
};

// The longest stable step of a motion

SPHCLOTH_INLINE double stable_step(double omega_sq, double friction)
{
  const double half = 0.5 * friction, sum = half + std::sqrt(half * half + omega_sq);
  return sum > 0.0 ? 2.0 / sum : std::numeric_limits<double>::infinity();
}

// (13) of the paper, extended; infinite for a particle at rest without pressure.  Without branches,
// so that a loop over particles vectorizes.  Of motion alone what is of pressure is not looked at.

template <bool MOTION_ALONE = false>
SPHCLOTH_INLINE StepLimit particle_limit(const StepCoefficients &lambda, const StepState &s)
{
  constexpr double NEVER = std::numeric_limits<double>::infinity();
  const auto ratio = [](double a, double b) { return b > 0.0 ? a / b : NEVER; };
  const auto with = [](double coefficient, double dt) { return coefficient > 0.0 ? dt : NEVER; };
  const double smoothing = 0.5 * s.support;
  StepLimit limit;
  limit.tighten(with(lambda.velocity, ratio(lambda.velocity * s.support, std::sqrt(s.speed_sq))),
                Limit::VELOCITY);
  limit.tighten(
      with(lambda.force, lambda.force * std::sqrt(ratio(s.support, std::sqrt(s.accel_sq)))),
      Limit::FORCE);
  if constexpr (!MOTION_ALONE) {
    // in free flight there is no sound, until the particle is compressed; half of the way to there
    // leaves time for what the flight does not know
    limit.tighten(
        with(lambda.acoustic,
             std::max(ratio(lambda.acoustic * smoothing, s.sound), 0.5 * s.until_pressed)),
        Limit::ACOUSTIC);
    const double omega_sq = s.of_fluid_sq + s.of_vertices_sq;
    limit.tighten(
        with(lambda.stability,
             std::max(lambda.stability * stable_step(omega_sq, s.friction), 0.5 * s.until_pressed)),
        s.friction * s.friction > omega_sq     ? Limit::VISCOUS
            : s.of_vertices_sq > s.of_fluid_sq ? Limit::WETTED
                                               : Limit::ACOUSTIC);
    limit.tighten(with(lambda.stability, ratio(lambda.stability, s.friction)), Limit::VISCOUS);
    limit.tighten(with(lambda.viscous, ratio(lambda.viscous * smoothing * smoothing, s.nu)),
                  Limit::VISCOUS);
  }
  limit.tighten(with(lambda.density, ratio(lambda.density * s.rho, std::fabs(s.drho))),
                Limit::DENSITY);
  if constexpr (!MOTION_ALONE)
    limit.tighten(with(lambda.relative, ratio(lambda.relative * s.support, s.approach)),
                  Limit::RELATIVE);
  return limit;
}

// The same of many particles at once

struct StepStates {
  static constexpr int MAX = 64;
  alignas(64) double support[MAX], speed_sq[MAX], accel_sq[MAX], sound[MAX], nu[MAX], rho[MAX],
      drho[MAX], approach[MAX], until_pressed[MAX], of_fluid_sq[MAX],
      of_vertices_sq[MAX], friction[MAX];

  // what is of pressure
  SPHCLOTH_INLINE void set_pressure(int k, const StepState &s)
  {
    sound[k] = s.sound;
    nu[k] = s.nu;
    approach[k] = s.approach;
    until_pressed[k] = s.until_pressed;
    of_fluid_sq[k] = s.of_fluid_sq;
    of_vertices_sq[k] = s.of_vertices_sq;
    friction[k] = s.friction;
  }
  SPHCLOTH_INLINE StepState motion(int k) const
  {
    return {support[k], speed_sq[k], accel_sq[k], 0.0, 0.0, rho[k], drho[k]};
  }
  SPHCLOTH_INLINE StepState operator[](int k) const
  {
    StepState s{support[k], speed_sq[k], accel_sq[k], sound[k],        nu[k],
                rho[k],     drho[k],     approach[k], until_pressed[k]};
    s.of_fluid_sq = of_fluid_sq[k];
    s.of_vertices_sq = of_vertices_sq[k];
    s.friction = friction[k];
    return s;
  }
};

struct StepLimits {
  alignas(64) double dt[StepStates::MAX], by[StepStates::MAX];
  StepLimit operator[](int k) const { return {dt[k], limit_of(by[k])}; }
};

SPHCLOTH_MULTIVERSION inline void
particle_limits(const StepCoefficients &lambda, const StepStates &states, int n, StepLimits &limits)
{
#pragma omp simd
  for (int k = 0; k < n; k++) {
    const StepLimit limit = particle_limit(lambda, states[k]);
    limits.dt[k] = limit.dt;
    limits.by[k] = static_cast<double>(limit.by);
  }
}

// where lambda.motion_alone(), of states of which the motion is set

SPHCLOTH_MULTIVERSION inline void motion_limits(const StepCoefficients &lambda,
                                                const StepStates &states, int n, StepLimits &limits)
{
#pragma omp simd
  for (int k = 0; k < n; k++) {
    const StepLimit limit = particle_limit<true>(lambda, states.motion(k));
    limits.dt[k] = limit.dt;
    limits.by[k] = static_cast<double>(limit.by);
  }
}

// of a vertex of a cloth, whose sound is that of the fluid that wets it

inline StepLimit vertex_limit(const StepCoefficients &lambda, const StepState &s, double edge)
{
  StepCoefficients of_vertex = lambda;
  of_vertex.acoustic = lambda.wetted.value_or(lambda.acoustic);
  StepLimit limit = particle_limit(of_vertex, s);
  if (limit.by == Limit::ACOUSTIC) limit.by = Limit::WETTED;
  if (lambda.cloth > 0.0 && s.speed_sq > 0.0)
    limit.tighten(lambda.cloth * edge / std::sqrt(s.speed_sq), Limit::CLOTH);
  return limit;
}

// how far densities are above the rest density, relative to it

struct Compression {
  double largest = 0.0, mean = 0.0;
};

// The step of the controller: small factors, and half a step at once for a shock, whenever the
// largest compression passes eta times 2, 4, 8 and so on.  It starts at FIRST h_s/c0, and below
// SHORTEST h_s/c0 a shorter step compresses no less.  Water at rest, of a depth that compresses it
// by eta at the ground, has a mean compression of eta/2.

struct FluctuationControl {
  static constexpr double CHANGE = 0.002, MEAN_SHARE = 0.5, FIRST = 0.25, SHORTEST = 0.05;
  double eta = 0.0;    // 0: off
  double sound_time = 0.0;    // h_s/c0

  double step(double previous, const Compression &now, double largest_before) const
  {
    if (previous == 0.0) return FIRST * sound_time;
    return std::max(SHORTEST * sound_time, factor(now, largest_before) * previous);
  }
  double factor(const Compression &now, double largest_before) const
  {
    if (doublings(now.largest) > doublings(largest_before)) return 0.5;
    return now.largest < eta && now.mean < MEAN_SHARE * eta ? 1.0 + CHANGE : 1.0 - CHANGE;
  }
  double doublings(double largest) const
  {
    return std::floor(std::log2(std::max(1.0, largest / eta)));
  }
};

// The step that is taken: the tightest particle's limit between floor and ceiling, growing at
// most by `growth` over the previous step (no limit if previous is 0: the first step), and up to
// the floor at once: a step ends below it where an output time cuts it.

inline StepLimit bounded_step(StepLimit wanted, double previous, double growth, double floor,
                              double ceiling)
{
  wanted.tighten(ceiling, Limit::CEILING);
  if (previous > 0.0) wanted.tighten(std::max(growth * previous, floor), Limit::GROWTH);
  if (wanted.dt < floor) {
    wanted.dt = floor;
    wanted.by = Limit::FLOOR;
  }
  return wanted;
}

/* ----------------------------------------------------------------------
   output times: the multiples of an interval
------------------------------------------------------------------------- */

// Some roundings above n times the interval, so that a test `time >= n T` in decimals is true and
// time over interval rounds down to n, also where the time at the end of a step is rounded.

inline double output_time(double n, double interval)
{
  return n * interval * (1.0 + 2.0 * std::numeric_limits<double>::epsilon());
}

// The number of the last output time up to now; what is nearer than `slack` counts as reached.

inline double output_times_until(double now, double interval, double slack)
{
  return std::floor((now + slack) / interval);
}

// The step towards something that is `remaining` away.  It arrives exactly, and the last steps are
// equal: near the limit of stability a shorter one after every few feeds what swings between them.

inline double step_towards(double remaining, double dt)
{
  constexpr double ROUNDING = 1e-9, EQUAL_STEPS = 16.0;
  const double steps = std::ceil((1.0 - ROUNDING) * remaining / dt);
  return steps > EQUAL_STEPS ? dt : remaining / std::max(1.0, steps);
}

// (15): a particle's own step in whole steps of now, rounded down, at least one

inline long long whole_steps(double wanted, double dt)
{
  constexpr double MAX_STEPS = 1e15, ROUNDING = 1e-12;
  return static_cast<long long>(std::clamp((1.0 + ROUNDING) * wanted / dt, 1.0, MAX_STEPS));
}

}    // namespace sphcloth

#endif
