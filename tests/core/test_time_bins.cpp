// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/timestep/time_bins.h"

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <vector>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(time_bins)

BOOST_AUTO_TEST_CASE(steps_begin_at_multiples_of_their_length)
{
  TimeBins line{1.0, 0};
  BOOST_CHECK(line.coarsest() == 0);
  line.now = TimeBins::ticks(3);
  BOOST_CHECK(line.coarsest() == 3);
  BOOST_CHECK(line.begins(3) && line.begins(4) && !line.begins(2));
  line.now += TimeBins::ticks(3);
  BOOST_CHECK(line.coarsest() == 2);
  line.now = TimeBins::ticks(0);
  BOOST_CHECK(line.ended() && line.coarsest() == 0);
}

BOOST_AUTO_TEST_CASE(longest_step_that_is_not_above_what_is_wanted)
{
  const TimeBins line{1.0, 0};
  BOOST_CHECK(line.bin_of(2.0) == 0 && line.bin_of(1.0) == 0);
  BOOST_CHECK(line.bin_of(0.99) == 1 && line.bin_of(0.5) == 1 && line.bin_of(0.3) == 2);
  BOOST_CHECK(line.bin_of(0.5 * (1.0 - 1e-14)) == 1);    // rounding
  for (double dt = 1.0; dt > 1e-6; dt *= 0.77) {
    const double taken = line.step(line.bin_of(dt));
    BOOST_CHECK(taken <= dt * (1.0 + 1e-12) && taken > 0.5 * dt);
  }
}

// updates per time when every wanted step is rounded down to base / 2^k

static double cost(const std::vector<double> &wanted, double base)
{
  double sum = 0.0;
  const TimeBins line{base, 0};
  for (const double dt : wanted) sum += 1.0 / line.step(line.bin_of(dt));
  return sum;
}

BOOST_AUTO_TEST_CASE(base_step_of_one_or_two_populations)
{
  WantedSteps one;
  for (int k = 0; k < 100; k++) one.add(0.3, 0.3);
  BOOST_CHECK_SMALL(one.best_base_step(0.3, 0.1, 1.0) - 0.3, 1e-15);

  // few with 0.3, many with 1.1: steps of 0.3 and 0.6 waste, 0.275 and 1.1 do not
  std::vector<double> wanted(10, 0.3);
  wanted.resize(1000, 1.1);
  WantedSteps two;
  for (const double dt : wanted) two.add(dt, 0.3);
  const double base = two.best_base_step(0.3, 0.0, 1.0);
  double ideal = 0.0;
  for (const double dt : wanted) ideal += 1.0 / dt;
  BOOST_CHECK(cost(wanted, base) < 1.05 * ideal);
  BOOST_CHECK(cost(wanted, 4.0 * 0.3) > 1.5 * ideal);
  BOOST_CHECK(base <= 1.1 && base > 1.05);
}

BOOST_AUTO_TEST_CASE(no_particle_gets_more_than_wanted_whatever_the_base_step)
{
  std::vector<double> wanted;
  for (int k = 0; k < 300; k++) wanted.push_back(1e-4 * std::pow(1.03, k % 170));
  WantedSteps all;
  for (const double dt : wanted) all.add(dt, 1e-4);
  const TimeBins line{all.best_base_step(1e-4, 0.1, 1.0), 0};
  BOOST_CHECK(line.base > 5e-5);
  for (const double dt : wanted) BOOST_CHECK(line.step(line.bin_of(dt)) <= dt * (1.0 + 1e-12));
}

BOOST_AUTO_TEST_CASE(equal_base_steps_arrive_at_an_output_time_at_little_cost)
{
  // as above: steps of 0.275 and 1.1 are best
  std::vector<double> wanted(10, 0.3);
  wanted.resize(1000, 1.1);
  WantedSteps two;
  for (const double dt : wanted) two.add(dt, 0.3);
  const double best = two.best_base_step(0.3, 0.0, 1.0), best_cost = cost(wanted, best);
  for (double remaining = 1.2; remaining < 17.0; remaining += 0.37) {
    const double base = two.base_step_towards(remaining, 0.3, 0.0, 1.0), n_steps = remaining / base;
    BOOST_CHECK_SMALL(n_steps - std::round(n_steps), 1e-12);
    BOOST_CHECK(base <= 1.1);
    const double shortened = std::ceil(remaining / best) * best / remaining;
    BOOST_CHECK(cost(wanted, base) < 1.01 * shortened * best_cost);
  }
  BOOST_CHECK_SMALL(two.base_step_towards(0.9, 0.3, 0.0, 1.0) - 0.9, 0.0);
  BOOST_CHECK_SMALL(two.base_step_towards(100.0, 0.3, 0.0, 1.0) - two.best_base_step(0.3, 0.0, 1.0),
                    0.0);

  WantedSteps one;
  for (int k = 0; k < 100; k++) one.add(0.3, 0.3);
  BOOST_CHECK_SMALL(one.base_step_towards(0.5, 0.3, 0.0, 1.0) - 0.25, 1e-15);
  BOOST_CHECK_SMALL(one.base_step_towards(0.7, 0.3, 0.0, 1.0) - 0.7 / 3.0, 1e-15);
  BOOST_CHECK_SMALL(one.base_step_towards(9.0, 0.3, 0.0, 1.0) - 0.3, 1e-15);
}

BOOST_AUTO_TEST_CASE(uniform_step_unless_unequal_ones_gain_enough)
{
  // updates per time: 1000 / 0.3 with a uniform step, 10 / 0.275 + 990 / 1.1 with two, which is
  // 3.56 times fewer
  WantedSteps two;
  for (int k = 0; k < 1000; k++) two.add(k < 10 ? 0.3 : 1.1, 0.3);
  BOOST_CHECK(two.best_base_step(0.3, 0.0, 3.4) > 1.0);
  BOOST_CHECK_SMALL(two.best_base_step(0.3, 0.0, 3.7) - 0.3, 0.0);
  BOOST_CHECK_SMALL(two.base_step_towards(0.5, 0.3, 0.0, 3.7) - 0.25, 1e-15);
  // what each step costs besides makes it 2.8
  BOOST_CHECK(two.best_base_step(0.3, 0.1, 2.7) > 1.0);
  BOOST_CHECK_SMALL(two.best_base_step(0.3, 0.1, 2.9) - 0.3, 0.0);
}

BOOST_AUTO_TEST_SUITE_END()
