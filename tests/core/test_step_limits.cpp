// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/timestep/step_limits.h"

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <set>
#include <string>

using namespace sphcloth;

namespace {

StepCoefficients by_sound()
{
  StepCoefficients lambda;
  lambda.stability = 0.0;
  lambda.acoustic = 0.5;
  lambda.viscous = 0.2;
  return lambda;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(step_limits)

BOOST_AUTO_TEST_CASE(each_formula_on_its_own)
{
  const StepCoefficients lambda = by_sound();
  const StepState rest{0.1, 0.0, 0.0, 0.0, 0.0, 1000.0, 0.0};
  BOOST_CHECK(std::isinf(particle_limit(lambda, rest).dt));

  StepState s = rest;
  s.speed_sq = 4.0;
  BOOST_CHECK_SMALL(particle_limit(lambda, s).dt - 0.15 * 0.1 / 2.0, 1e-17);    // (10)
  BOOST_CHECK(particle_limit(lambda, s).by == Limit::VELOCITY);
  s = rest;
  s.accel_sq = 100.0;
  BOOST_CHECK_SMALL(particle_limit(lambda, s).dt - 0.2 * std::sqrt(0.1 / 10.0), 1e-17);    // (11)
  BOOST_CHECK(particle_limit(lambda, s).by == Limit::FORCE);
  s = rest;
  s.sound = 20.0;
  BOOST_CHECK_SMALL(particle_limit(lambda, s).dt - 0.5 * 0.05 / 20.0, 1e-17);
  s = rest;
  s.nu = 0.5;
  BOOST_CHECK_SMALL(particle_limit(lambda, s).dt - 0.2 * 0.0025 / 0.5, 1e-17);
  s = rest;
  s.drho = -5000.0;
  BOOST_CHECK_SMALL(particle_limit(lambda, s).dt - 0.1 * 0.2, 1e-17);
  s = rest;
  s.approach = 4.0;
  BOOST_CHECK(std::isinf(particle_limit(lambda, s).dt));    // off by default
  StepCoefficients relative;
  relative.relative = 0.3;
  BOOST_CHECK_SMALL(particle_limit(relative, s).dt - 0.3 * 0.1 / 4.0, 1e-17);
  BOOST_CHECK(particle_limit(relative, s).by == Limit::RELATIVE);
}

BOOST_AUTO_TEST_CASE(stability_of_frequencies_and_friction)
{
  const StepCoefficients lambda;
  StepState s{0.1, 0.0, 0.0, 0.0, 0.0, 1000.0, 0.0};
  s.of_fluid_sq = 400.0;
  BOOST_CHECK_SMALL(particle_limit(lambda, s).dt - 0.95 * 2.0 / 20.0, 1e-16);
  BOOST_CHECK(particle_limit(lambda, s).by == Limit::ACOUSTIC);
  s.of_vertices_sq = 500.0;
  BOOST_CHECK_SMALL(particle_limit(lambda, s).dt - 0.95 * 2.0 / 30.0, 1e-16);
  BOOST_CHECK(particle_limit(lambda, s).by == Limit::WETTED);
  s.friction = 17.5;
  BOOST_CHECK_SMALL(particle_limit(lambda, s).dt - 0.95 * 2.0 / 40.0, 1e-16);
  BOOST_CHECK(particle_limit(lambda, s).by == Limit::WETTED);
  s.friction = 40.0;    // alone
  BOOST_CHECK_SMALL(particle_limit(lambda, s).dt - 0.95 / 40.0, 1e-16);
  BOOST_CHECK(particle_limit(lambda, s).by == Limit::VISCOUS);
  s.until_pressed = 1.0;    // friction limits free flight, too
  BOOST_CHECK_SMALL(particle_limit(lambda, s).dt - 0.95 / 40.0, 1e-16);
  BOOST_CHECK(std::isinf(stable_step(0.0, 0.0)));
  // x'' = -omega^2 x - r x', step by step: sharp
  const auto largest_after = [](double dt) {
    double x = 1.0, v = 0.0, largest = 0.0;
    for (int n = 0; n < 1000; n++) {
      v += dt * (-900.0 * x - 16.0 * v);
      x += dt * v;
      largest = std::max(largest, std::fabs(x));
    }
    return largest;
  };
  BOOST_CHECK(largest_after(0.999 * stable_step(900.0, 16.0)) < 3.0);
  BOOST_CHECK(largest_after(1.01 * stable_step(900.0, 16.0)) > 1e3);
}

BOOST_AUTO_TEST_CASE(limits_of_a_vertex)
{
  StepCoefficients lambda = by_sound();
  StepState s{0.1, 4.0, 0.0, 20.0, 0.0, 0.0, 0.0};
  BOOST_CHECK_SMALL(vertex_limit(lambda, s, 0.01).dt - 0.5 * 0.05 / 20.0, 1e-17);
  BOOST_CHECK(vertex_limit(lambda, s, 0.01).by == Limit::WETTED);
  lambda.wetted = 1.5;
  BOOST_CHECK_SMALL(vertex_limit(lambda, s, 0.01).dt - 1.5 * 0.05 / 20.0, 1e-17);
  BOOST_CHECK_SMALL(particle_limit(lambda, s).dt - 0.5 * 0.05 / 20.0, 1e-17);
  lambda.cloth = 0.2;
  BOOST_CHECK_SMALL(vertex_limit(lambda, s, 0.01).dt - 0.2 * 0.01 / 2.0, 1e-17);
  BOOST_CHECK(vertex_limit(lambda, s, 0.01).by == Limit::CLOTH);
}

BOOST_AUTO_TEST_CASE(each_limit_has_a_name_of_its_own)
{
  std::set<std::string> names;
  for (int k = 0; k < N_LIMITS; k++) names.insert(limit_name(static_cast<Limit>(k)));
  BOOST_CHECK(names.size() == N_LIMITS);
}

BOOST_AUTO_TEST_CASE(control_by_compression)
{
  const FluctuationControl control{0.01, 0.002};
  BOOST_CHECK(control.step(0.0, {0.0, 0.0}, 0.0) == 0.25 * 0.002);
  BOOST_CHECK_SMALL(control.step(1e-3, {0.0099, 0.0049}, 0.02) - 1.002e-3, 1e-17);
  BOOST_CHECK_SMALL(control.step(1e-3, {0.0101, 0.0049}, 0.0) - 0.998e-3, 1e-17);
  BOOST_CHECK_SMALL(control.step(1e-3, {0.0099, 0.0051}, 0.0) - 0.998e-3, 1e-17);
  BOOST_CHECK(control.step(1e-3, {0.021, 0.001}, 0.019) == 0.5e-3);    // passes 2 eta
  BOOST_CHECK_SMALL(control.step(1e-3, {0.039, 0.001}, 0.021) - 0.998e-3, 1e-17);
  BOOST_CHECK(control.step(1e-3, {0.041, 0.001}, 0.039) == 0.5e-3);    // passes 4 eta
  BOOST_CHECK(control.step(1.1e-4, {0.5, 0.1}, 0.0) == 0.05 * 0.002);
}

BOOST_AUTO_TEST_CASE(the_last_steps_before_an_output_time_are_equal)
{
  BOOST_CHECK(step_towards(5.0, 0.3) == 0.3);
  BOOST_CHECK(step_towards(1.0, 0.3) == 0.25);
  BOOST_CHECK(step_towards(0.5, 0.3) == 0.25);
  BOOST_CHECK(step_towards(0.25, 0.3) == 0.25);
  BOOST_CHECK(step_towards(0.3 * (1.0 + 1e-12), 0.3) == 0.3 * (1.0 + 1e-12));
  BOOST_CHECK(step_towards(0.3, 0.3) == 0.3);
  double remaining = 10.7, shortest = 1.0;
  for (int n = 0; remaining > 1e-12; n++) {
    const double step = step_towards(remaining, 1.0);
    shortest = std::min(shortest, step);
    remaining -= step;
    BOOST_TEST(n < 12);
  }
  BOOST_TEST(shortest == 10.7 / 11.0, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(output_times_are_never_below_their_decimal_number)
{
  for (const double interval : {0.1, 0.7, 1.0 / 30.0, 0.0013, 2.5}) {
    for (int n = 1; n < 3000; n++) {
      const double t = output_time(n, interval);
      BOOST_CHECK(std::floor(t / interval) == n);
      BOOST_CHECK_SMALL(t - n * interval, 1e-15 * n * interval);
      BOOST_CHECK(output_times_until(t, interval, 0.0) == n);
      BOOST_CHECK(output_times_until(t - 1e-9, interval, 1e-8) == n);
      BOOST_CHECK(output_times_until(t - 1e-7, interval, 1e-8) == n - 1);
    }
  }
  BOOST_CHECK(output_time(3, 0.7) >= 2.1);    // 3 * 0.7 is below
}

BOOST_AUTO_TEST_CASE(a_coefficient_of_zero_switches_its_limit_off)
{
  StepCoefficients off;
  off.stability = off.velocity = off.force = off.acoustic = off.viscous = off.density = 0.0;
  StepState all{0.1, 9.0, 9.0, 9.0, 9.0, 1000.0, 9.0};
  all.of_fluid_sq = all.of_vertices_sq = all.friction = 9.0;
  BOOST_CHECK(std::isinf(particle_limit(off, all).dt));
}

BOOST_AUTO_TEST_CASE(step_between_ceiling_growth_and_floor)
{
  StepLimit none;
  BOOST_CHECK(bounded_step(none, 0.0, 2.0, 0.0, 0.01).dt == 0.01);
  BOOST_CHECK(bounded_step(none, 0.0, 2.0, 0.0, 0.01).by == Limit::CEILING);
  BOOST_CHECK(bounded_step(none, 0.002, 2.0, 0.0, 0.01).dt == 0.004);
  BOOST_CHECK(bounded_step(none, 0.002, 2.0, 0.0, 0.01).by == Limit::GROWTH);
  StepLimit small{1e-6, Limit::FORCE};
  BOOST_CHECK(bounded_step(small, 0.002, 2.0, 1e-5, 0.01).dt == 1e-5);
  BOOST_CHECK(bounded_step(small, 0.002, 2.0, 1e-5, 0.01).by == Limit::FLOOR);
  BOOST_CHECK(bounded_step(small, 0.002, 2.0, 0.0, 0.01).dt == 1e-6);
  // behind a step that an output time has cut
  BOOST_CHECK(bounded_step(none, 1e-6, 2.0, 1e-5, 0.01).dt == 1e-5);
  BOOST_CHECK(bounded_step(none, 1e-6, 2.0, 1e-5, 0.01).by == Limit::GROWTH);
  BOOST_CHECK(bounded_step(small, 1e-6, 2.0, 1e-5, 0.01).by == Limit::FLOOR);
}

BOOST_AUTO_TEST_CASE(whole_steps_of_equation_15_are_rounded_down_at_least_one)
{
  BOOST_CHECK(whole_steps(0.01, 0.003) == 3);
  BOOST_CHECK(whole_steps(0.3, 0.1) == 3);    // 0.3/0.1 is below
  BOOST_CHECK(whole_steps(0.001, 0.003) == 1);
  BOOST_CHECK(whole_steps(0.0, 0.003) == 1);
  BOOST_CHECK(whole_steps(1e300, 1e-300) > 1000000);
}

BOOST_AUTO_TEST_CASE(limits_of_many_particles_at_once_are_those_of_each)
{
  StepCoefficients lambda = by_sound(), stable, off = by_sound(), motion;
  off.velocity = off.force = off.acoustic = off.viscous = off.density = 0.0;
  lambda.relative = 0.3;
  motion.stability = 0.0;
  constexpr int N = StepStates::MAX - 3;    // does not fill the last vector
  StepStates states;
  for (int k = 0; k < N; k++) {
    const double on = k % 5 ? 1.0 : 0.0;
    StepState s{0.1,
                0.1 * k,
                on * k * k,
                k % 8 ? 0.1 : 20.0,
                0.01 * (k % 7),
                1000.0,
                on * (100.0 * k - 3000.0),
                on * 0.2 * k,
                k % 3 ? 0.0 : 0.004};
    s.of_fluid_sq = 1e4 * (k % 4);
    s.of_vertices_sq = 1e4 * (k % 6);
    s.friction = 50.0 * (k % 9);
    states.support[k] = s.support;
    states.speed_sq[k] = s.speed_sq;
    states.accel_sq[k] = s.accel_sq;
    states.rho[k] = s.rho;
    states.drho[k] = s.drho;
    states.set_pressure(k, s);
  }
  std::set<Limit> by;
  for (const StepCoefficients &of : {lambda, stable, off, motion}) {
    BOOST_CHECK(of.motion_alone() == (of.stability == 0.0 && of.acoustic == 0.0));
    StepLimits limits;
    limits.dt[N] = -1.0;
    of.motion_alone() ? motion_limits(of, states, N, limits)
                      : particle_limits(of, states, N, limits);
    for (int k = 0; k < N; k++) {
      const StepLimit one = particle_limit(of, states[k]);
      BOOST_CHECK(limits[k].dt == one.dt);
      BOOST_CHECK(limits[k].by == one.by);
      by.insert(one.by);
    }
    BOOST_CHECK(limits.dt[N] == -1.0);
  }
  BOOST_CHECK(by.size() >= 5);
}

BOOST_AUTO_TEST_SUITE_END()
