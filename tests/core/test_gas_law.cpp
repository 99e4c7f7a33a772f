// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pbd/gas_law.h"

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <random>

using namespace sphcloth;

namespace {

GasLaw air(double exponent)
{
  GasLaw law;
  law.exponent = exponent;
  law.start = 1.1e5;
  law.ambient = 1e5;
  return law;
}

// A shell of one degree of freedom, V = 1 + y, pushed with the mobility c of a step of 1: largest
// |V - 1| over many steps; stiffness S of what else holds it, implicit.
double largest_swing(const GasLaw &law, double c, double stiffness, double start, int steps)
{
  double y = start, before = start, earlier = start, applied = 0.0, largest = 0.0;
  for (int n = 0; n < steps; n++) {
    const double expected = 1.0 + 3.0 * y - 3.0 * before + earlier;
    applied =
        implicit_excess(law, 1.0, {1.0 + y, law.excess(1.0, 1.0 + before), expected, applied, c});
    const double next = (2.0 * y - before + c * applied) / (1.0 + stiffness);
    earlier = before;
    before = y;
    y = next;
    largest = std::max(largest, std::abs(y));
  }
  return largest;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(gas_law)

BOOST_AUTO_TEST_CASE(the_excess_is_minus_the_derivative_of_the_energy)
{
  for (const double n : {1.0, 1.2, 1.4, 3.0}) {
    const GasLaw law = air(n);
    for (const double volume : {0.3, 1.0, 1.7}) {
      const double h = 1e-5;
      const double slope = (law.energy(0.9, volume + h) - law.energy(0.9, volume - h)) / (2.0 * h);
      BOOST_CHECK_SMALL((slope + law.excess(0.9, volume)) / law.start, 1e-6);
      const double steep =
          (law.pressure(0.9, volume + h) - law.pressure(0.9, volume - h)) / (2.0 * h);
      BOOST_CHECK_SMALL(steep / law.stiffness(0.9, volume) + 1.0, 1e-7);
    }
  }
}

BOOST_AUTO_TEST_CASE(gas_that_has_a_pressure_has_it)
{
  const GasLaw law = air(1.4);
  BOOST_CHECK_SMALL(law.excess(law.gas_at(2345.0, 0.7), 0.7) - 2345.0, 1e-8);
}

BOOST_AUTO_TEST_CASE(short_steps_see_the_law_and_a_valve_bounds_it)
{
  GasLaw law = air(1.4);
  BOOST_CHECK_SMALL(implicit_excess(law, 1.0, {1.0, 1e4, 1.0, 0.0, 1e-12}) - 1e4, 1e-2);
  BOOST_TEST(implicit_excess(law, 1.0, {1.0, 1e4, 1.0, 0.0, 0.0}) == law.excess(1.0, 1.0));
  law.limit = 5e3;
  BOOST_TEST(implicit_excess(law, 1.0, {1.0, 5e3, 1.0, 0.0, 1e-6}) <= 5e3);
}

BOOST_AUTO_TEST_CASE(the_pressure_is_that_of_the_volume_it_leads_to)
{
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  GasLaw law = air(1.4);
  law.limit = 1.003e4;
  for (int n = 0; n < 1000; n++) {
    ChamberMotion motion{
        1.0 + 0.05 * uniform(engine), 1e4 * (1.0 + 0.003 * uniform(engine)), 0.0, 0.0, 0.0,
        0.01 * uniform(engine)};
    motion.expected = motion.volume + 0.05 * uniform(engine);
    motion.last_excess = 1e4 * (1.0 + 0.003 * uniform(engine));
    motion.volume_by_excess = std::pow(10.0, 2.0 * uniform(engine)) / law.stiffness(1.0, 1.0);
    const double c = motion.volume_by_excess, found = implicit_excess(law, 1.0, motion);
    const double volume = motion.expected + c * (found - motion.last_excess);
    const PressureWeights weights(c * law.stiffness(1.0, motion.volume));
    const double led_to = std::min(weights.next * law.excess(1.0 + motion.inflow, volume) +
                                       weights.now * law.excess(1.0, motion.volume) +
                                       weights.before * motion.excess_before,
                                   law.limit);
    BOOST_CHECK_SMALL((found - led_to) / law.limit, 1e-6);
  }
}

BOOST_AUTO_TEST_CASE(walls_follow_what_flows_in)
{
  GasLaw law = air(1.4);
  law.ambient = law.start;
  const double inflow = 1e-3;
  for (const double omega_dt_sq : {1e2, 1e4}) {
    const double c = omega_dt_sq / law.stiffness(1.0, 1.0);
    double gas = 1.0, now = 1.0, before = 1.0, earlier = 1.0, excess_before = 0.0, applied = 0.0;
    for (int n = 0; n < 200; n++) {
      const double expected = 3.0 * now - 3.0 * before + earlier;
      const double excess = law.excess(gas, now);
      applied = implicit_excess(law, gas, {now, excess_before, expected, applied, c, inflow});
      const double next = 2.0 * now - before + c * applied;
      earlier = before;
      before = now;
      now = next;
      excess_before = excess;
      gas += inflow;
    }
    // by less than what flows in in one step
    BOOST_CHECK_SMALL(now - gas, 0.1 * inflow);
  }
}

BOOST_AUTO_TEST_CASE(at_rest_the_pressure_is_that_of_the_law_for_every_step)
{
  const GasLaw law = air(1.4);
  const double excess = law.excess(1.0, 1.01);
  for (const double c : {1e-9, 1e-6, 1e-3, 1.0, 1e3})
    BOOST_CHECK_SMALL(implicit_excess(law, 1.0, {1.01, excess, 1.01, excess, c}) / excess - 1.0,
                      1e-9);
}

BOOST_AUTO_TEST_CASE(steps_of_any_length_do_not_feed_the_breathing)
{
  GasLaw law = air(1.4);
  law.ambient = law.start;    // V = 1 is the equilibrium
  for (const double omega_dt_sq : {1e-2, 1.0, 3.9, 5.0, 1e2, 1e4, 1e6})
    for (const double stiffness : {0.0, 0.01, 1.0, 100.0}) {
      const double c = omega_dt_sq / law.stiffness(1.0, 1.0);
      BOOST_TEST(largest_swing(law, c, stiffness, 1e-3, 3000) < 1.6e-3);
    }
}

BOOST_AUTO_TEST_CASE(the_frequency_is_of_fourth_order)
{
  GasLaw law = air(1.0);
  law.ambient = law.start;
  const auto period_error = [&](double omega_dt) {    // of the motion after a quarter of a period
    const double c = omega_dt * omega_dt / law.stiffness(1.0, 1.0), start = 1e-7;
    const int steps = static_cast<int>(std::lround(0.5 * std::acos(-1.0) / omega_dt));
    double y = start * std::cos(0.0), before = start * std::cos(omega_dt);
    double earlier = start * std::cos(2.0 * omega_dt);
    double applied = -law.stiffness(1.0, 1.0) * before;
    for (int n = 0; n < steps; n++) {
      const double expected = 1.0 + 3.0 * y - 3.0 * before + earlier;
      applied =
          implicit_excess(law, 1.0, {1.0 + y, law.excess(1.0, 1.0 + before), expected, applied, c});
      const double next = 2.0 * y - before + c * applied;
      earlier = before;
      before = y;
      y = next;
    }
    return std::abs(y) / start;
  };
  const double quarter = 0.5 * std::acos(-1.0);
  const double coarse = period_error(quarter / 8), fine = period_error(quarter / 16);
  BOOST_TEST(std::log2(coarse / fine) > 3.5);
}

BOOST_AUTO_TEST_SUITE_END()
