#include "check.h"
#include "core/criteria.h"

using namespace sphcloth;

CASE("limits: each formula on its own")
{
  const StepCoefficients lambda;
  const StepState rest{0.1, 0.0, 0.0, 0.0, 0.0, 1000.0, 0.0};
  CHECK(std::isinf(particle_limit(lambda, rest).dt));

  StepState s = rest;
  s.speed_sq = 4.0;
  CHECK_NEAR(particle_limit(lambda, s).dt, 0.1 * 0.1 / 2.0, 1e-17);    // (10)
  CHECK(particle_limit(lambda, s).by == Limit::VELOCITY);
  s = rest;
  s.accel_sq = 100.0;
  CHECK_NEAR(particle_limit(lambda, s).dt, 0.05 * std::sqrt(0.1 / 10.0), 1e-17);    // (11)
  CHECK(particle_limit(lambda, s).by == Limit::FORCE);
  s = rest;
  s.sound = 20.0;
  CHECK_NEAR(particle_limit(lambda, s).dt, 0.5 * 0.05 / 20.0, 1e-17);
  s = rest;
  s.nu = 0.5;
  CHECK_NEAR(particle_limit(lambda, s).dt, 0.2 * 0.0025 / 0.5, 1e-17);
  s = rest;
  s.drho = -5000.0;
  CHECK_NEAR(particle_limit(lambda, s).dt, 0.1 * 0.2, 1e-17);
}

CASE("limits: a coefficient of zero switches its limit off")
{
  StepCoefficients off;
  off.velocity = off.force = off.acoustic = off.viscous = off.density = 0.0;
  CHECK(std::isinf(particle_limit(off, {0.1, 9.0, 9.0, 9.0, 9.0, 1000.0, 9.0}).dt));
}

CASE("the step: ceiling at rest, growth, floor")
{
  StepLimit none;
  CHECK(bounded_step(none, 0.0, 2.0, 0.0, 0.01).dt == 0.01);
  CHECK(bounded_step(none, 0.0, 2.0, 0.0, 0.01).by == Limit::CEILING);
  CHECK(bounded_step(none, 0.002, 2.0, 0.0, 0.01).dt == 0.004);
  CHECK(bounded_step(none, 0.002, 2.0, 0.0, 0.01).by == Limit::GROWTH);
  StepLimit small{1e-6, Limit::FORCE};
  CHECK(bounded_step(small, 0.002, 2.0, 1e-5, 0.01).dt == 1e-5);
  CHECK(bounded_step(small, 0.002, 2.0, 1e-5, 0.01).by == Limit::FLOOR);
  CHECK(bounded_step(small, 0.002, 2.0, 0.0, 0.01).dt == 1e-6);
}
