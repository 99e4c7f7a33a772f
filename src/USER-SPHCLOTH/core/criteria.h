// Limits of the time step: equations (10) to (12), and the acoustic, viscous and density limits
// that stability asks for.
//
// (10) and (11) use the support radius H, the paper's h.  The acoustic and the viscous limit use
// the smoothing length h_s = H/2, as stability analysis does.

#ifndef SPHCLOTH_CORE_CRITERIA_H
#define SPHCLOTH_CORE_CRITERIA_H

#include <algorithm>
#include <cmath>
#include <limits>

namespace sphcloth {

enum class Limit { NONE, VELOCITY, FORCE, ACOUSTIC, VISCOUS, DENSITY, CEILING, FLOOR, GROWTH };
inline constexpr int N_LIMITS = 9;

inline const char *limit_name(Limit limit)
{
  switch (limit) {
    case Limit::NONE: return "none";
    case Limit::VELOCITY: return "velocity";
    case Limit::FORCE: return "force";
    case Limit::ACOUSTIC: return "acoustic";
    case Limit::VISCOUS: return "viscous";
    case Limit::DENSITY: return "density";
    case Limit::CEILING: return "max";
    case Limit::FLOOR: return "min";
    case Limit::GROWTH: return "growth";
  }
  return "none";
}

// coefficients; a coefficient of 0 switches its limit off

struct StepCoefficients {
  double velocity = 0.1;     // lambda_v of (10)
  double force = 0.05;       // lambda_f of (11)
  double acoustic = 0.5;     // of h_s/c; symplectic stepping is stable up to 1.6
  double viscous = 0.2;      // of h_s^2/nu; stable up to 0.3 in 3-D
  double density = 0.1;      // largest relative change of density in one step
};

// what one particle brings along

struct StepState {
  double support;     // H
  double speed_sq;    // |v|^2
  double accel_sq;    // |dv/dt|^2
  double sound;       // c, 0 for a particle without pressure
  double nu;          // kinematic viscosity, laminar and artificial together
  double rho;
  double drho;        // d rho / dt
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

// (13) of the paper, extended; infinite for a particle at rest without pressure

inline StepLimit particle_limit(const StepCoefficients &lambda, const StepState &s)
{
  StepLimit limit;
  const double smoothing = 0.5 * s.support;
  if (lambda.velocity > 0.0 && s.speed_sq > 0.0)
    limit.tighten(lambda.velocity * s.support / std::sqrt(s.speed_sq), Limit::VELOCITY);
  if (lambda.force > 0.0 && s.accel_sq > 0.0)
    limit.tighten(lambda.force * std::sqrt(s.support / std::sqrt(s.accel_sq)), Limit::FORCE);
  if (lambda.acoustic > 0.0 && s.sound > 0.0)
    limit.tighten(lambda.acoustic * smoothing / s.sound, Limit::ACOUSTIC);
  if (lambda.viscous > 0.0 && s.nu > 0.0)
    limit.tighten(lambda.viscous * smoothing * smoothing / s.nu, Limit::VISCOUS);
  if (lambda.density > 0.0 && s.drho != 0.0)
    limit.tighten(lambda.density * s.rho / std::fabs(s.drho), Limit::DENSITY);
  return limit;
}

// The step that is taken: the tightest particle's limit between floor and ceiling, growing at
// most by `growth` over the previous step (no limit if previous is 0: the first step).

inline StepLimit bounded_step(StepLimit wanted, double previous, double growth, double floor,
                              double ceiling)
{
  wanted.tighten(ceiling, Limit::CEILING);
  if (previous > 0.0) wanted.tighten(growth * previous, Limit::GROWTH);
  if (wanted.dt < floor) {
    wanted.dt = floor;
    wanted.by = Limit::FLOOR;
  }
  return wanted;
}

}    // namespace sphcloth

#endif
