#include "check.h"
#include "core/timestep/step_limits.h"

#include <set>
#include <string>

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
  s = rest;
  s.approach = 4.0;
  CHECK(std::isinf(particle_limit(lambda, s).dt));    // off by default
  StepCoefficients relative;
  relative.relative = 0.3;
  CHECK_NEAR(particle_limit(relative, s).dt, 0.3 * 0.1 / 4.0, 1e-17);
  CHECK(particle_limit(relative, s).by == Limit::RELATIVE);
}

CASE("limits: the time to cross a gap")
{
  CHECK_NEAR(time_to_cross(2.0, 4.0, 0.0), 0.5, 1e-16);
  CHECK(std::isinf(time_to_cross(2.0, 0.0, 0.0)));
  CHECK(std::isinf(time_to_cross(2.0, -4.0, 0.0)));
  CHECK_NEAR(time_to_cross(8.0, 0.0, 4.0), 2.0, 1e-16);
  for (const double rate : {3.0, -3.0}) {
    const double t = time_to_cross(2.0, rate, 5.0);
    CHECK_NEAR(rate * t + 2.5 * t * t, 2.0, 1e-14);
  }
  CHECK(time_to_cross(-1.0, 3.0, 5.0) == 0.0);
  CHECK_NEAR(time_to_cross(1e-300, 1e-3, 1e-300), 1e-297, 1e-305);
  CHECK_NEAR(time_to_cross(0.0, -3.0, 6.0), 1.0, 1e-16);    // away, and back again
}

CASE("limits: of a vertex")
{
  StepCoefficients lambda;
  StepState s{0.1, 4.0, 0.0, 20.0, 0.0, 0.0, 0.0};
  CHECK_NEAR(vertex_limit(lambda, s, 0.01).dt, 0.5 * 0.05 / 20.0, 1e-17);
  CHECK(vertex_limit(lambda, s, 0.01).by == Limit::WETTED);
  lambda.wetted = 1.5;
  CHECK_NEAR(vertex_limit(lambda, s, 0.01).dt, 1.5 * 0.05 / 20.0, 1e-17);
  CHECK_NEAR(particle_limit(lambda, s).dt, 0.5 * 0.05 / 20.0, 1e-17);
  lambda.cloth = 0.2;
  CHECK_NEAR(vertex_limit(lambda, s, 0.01).dt, 0.2 * 0.01 / 2.0, 1e-17);
  CHECK(vertex_limit(lambda, s, 0.01).by == Limit::CLOTH);
}

CASE("limits: every one has a name of its own")
{
  std::set<std::string> names;
  for (int k = 0; k < N_LIMITS; k++) names.insert(limit_name(static_cast<Limit>(k)));
  CHECK(names.size() == N_LIMITS);
}

CASE("control by compression: paces, shocks, bounds")
{
  const FluctuationControl control{0.01, 0.002};
  CHECK(control.step(0.0, {0.0, 0.0}, 0.0) == 0.25 * 0.002);
  CHECK_NEAR(control.step(1e-3, {0.0099, 0.0049}, 0.02), 1.002e-3, 1e-17);
  CHECK_NEAR(control.step(1e-3, {0.0101, 0.0049}, 0.0), 0.998e-3, 1e-17);
  CHECK_NEAR(control.step(1e-3, {0.0099, 0.0051}, 0.0), 0.998e-3, 1e-17);
  CHECK(control.step(1e-3, {0.021, 0.001}, 0.019) == 0.5e-3);     // passes 2 eta
  CHECK_NEAR(control.step(1e-3, {0.039, 0.001}, 0.021), 0.998e-3, 1e-17);
  CHECK(control.step(1e-3, {0.041, 0.001}, 0.039) == 0.5e-3);     // passes 4 eta
  CHECK(control.step(1.1e-4, {0.5, 0.1}, 0.0) == 0.05 * 0.002);
}

CASE("output times: the last two steps are balanced, none is tiny, the end is exact")
{
  CHECK(step_towards(1.0, 0.3) == 0.3);
  CHECK(step_towards(0.5, 0.3) == 0.25);
  CHECK(step_towards(0.25, 0.3) == 0.25);
  CHECK(step_towards(0.3 * (1.0 + 1e-12), 0.3) == 0.3 * (1.0 + 1e-12));
  CHECK(step_towards(0.3, 0.3) == 0.3);
}

CASE("output times: never below their decimal number, and back to their number")
{
  for (const double interval : {0.1, 0.7, 1.0 / 30.0, 0.0013, 2.5}) {
    for (int n = 1; n < 3000; n++) {
      const double t = output_time(n, interval);
      CHECK(std::floor(t / interval) == n);
      CHECK_NEAR(t, n * interval, 1e-15 * n * interval);
      CHECK(output_times_until(t, interval, 0.0) == n);
      CHECK(output_times_until(t - 1e-9, interval, 1e-8) == n);
      CHECK(output_times_until(t - 1e-7, interval, 1e-8) == n - 1);
    }
  }
  CHECK(output_time(3, 0.7) >= 2.1);    // 3 * 0.7 is below
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

CASE("(15): whole steps, rounded down, at least one")
{
  CHECK(whole_steps(0.01, 0.003) == 3);
  CHECK(whole_steps(0.3, 0.1) == 3);    // 0.3/0.1 is below
  CHECK(whole_steps(0.001, 0.003) == 1);
  CHECK(whole_steps(0.0, 0.003) == 1);
  CHECK(whole_steps(1e300, 1e-300) > 1000000);
}

CASE("limits of many particles at once are those of each")
{
  StepCoefficients lambda, off{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, {}};
  lambda.relative = 0.3;
  constexpr int N = StepStates::MOST - 3;    // does not fill the last vector
  StepStates states;
  for (int k = 0; k < N; k++) {
    const double on = k % 5 ? 1.0 : 0.0;
    states.set(k,
               {0.1, 0.1 * k, on * k * k, k % 8 ? 0.1 : 20.0, 0.01 * (k % 7), 1000.0,
                on * (100.0 * k - 3000.0), on * 0.2 * k, k % 3 ? 0.0 : 0.004});
  }
  std::set<Limit> by;
  for (const StepCoefficients &of : {lambda, off}) {
    StepLimits limits;
    limits.dt[N] = -1.0;
    particle_limits(of, states, N, limits);
    for (int k = 0; k < N; k++) {
      const StepLimit one = particle_limit(of, states[k]);
      CHECK(limits[k].dt == one.dt);
      CHECK(limits[k].by == one.by);
      by.insert(one.by);
    }
    CHECK(limits.dt[N] == -1.0);
  }
  CHECK(by.size() >= 5);
}
