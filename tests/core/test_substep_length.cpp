// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pbd/substep_length.h"

#include <boost/test/unit_test.hpp>

#include <cmath>

using namespace sphcloth;

namespace {

constexpr double DT = 1e-3;

double hardness(double strain) { return std::pow(1.0 + 9.0 * std::pow(strain, 4), -2); }

// steps in which an edge has this strain over the one that `strain` allows; the last number of
// substeps
template <class Strain> double steps(SubstepLength &length, int n, Strain of)
{
  double substeps = 0.0;
  for (int k = 0; k < n; k++) {
    substeps = length.substeps(DT, 10);
    const double strain = of(length) / length.yield();
    length.found(hardness(strain), strain);
  }
  return substeps;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(substep_length)

BOOST_AUTO_TEST_CASE(the_longest_step_has_as_many_as_usual)
{
  SubstepLength length;
  BOOST_TEST(length.substeps(DT, 10) == 10);
  BOOST_TEST(length.substeps(2.0 * DT, 10) == 10);
  BOOST_TEST(length.substeps(0.1 * DT, 10) == 1);
  BOOST_TEST(length.substeps(0.5 * DT, 10) == 3);
  BOOST_TEST(length.longest() == 0.2 * DT);
}

BOOST_AUTO_TEST_CASE(a_load_shortens_them_in_steps_and_lengthens_them_slowly)
{
  SubstepLength length;
  const auto strain = [](double of) { return [of](const SubstepLength &) { return of; }; };
  const double heavy = std::pow(3.0 / 9.0, 0.25);    // g is 1/16
  steps(length, 3, strain(0.0));
  BOOST_TEST(steps(length, 1, strain(heavy)) == 10);
  // half of the softness in each step
  for (const double substeps : {15, 20, 29, 40, 40})
    BOOST_TEST(steps(length, 1, strain(heavy)) == substeps);
  BOOST_TEST(steps(length, 30, strain(0.0)) > 20);
  BOOST_TEST(steps(length, 100, strain(0.0)) == 10);
  BOOST_TEST(length.longest() == 0.1 * DT);
}

// what hardens from step to step is hardened as much again in advance

BOOST_AUTO_TEST_CASE(the_growth_of_a_load_is_extrapolated)
{
  SubstepLength length;
  const auto found = [&](double hardest) {
    length.found(hardest, 0.5);
    return length.substeps(DT, 10);
  };
  length.substeps(DT, 10);
  found(1.0);
  BOOST_TEST(found(0.8) == std::ceil(10.0 / 0.8 - 0.1));
  BOOST_TEST(found(0.8) == std::ceil(10.0 / std::sqrt(0.8 * 0.8 * 1.03) - 0.1));
}

BOOST_AUTO_TEST_CASE(what_is_held_apart_yields_until_it_is_soft)
{
  SubstepLength length;
  const auto held = [](const SubstepLength &) { return 2.0; };
  int first = 0;
  for (int k = 1; k < 500; k++) {
    steps(length, 1, held);
    if (length.is_held() && first == 0) first = k;
  }
  BOOST_TEST(first > 30);
  BOOST_TEST(first < 100);
  BOOST_TEST(!length.is_overloaded());
  BOOST_TEST(steps(length, 1, held) < 30);
  // let go, it is as before
  steps(length, 200, [](const SubstepLength &) { return 0.0; });
  BOOST_TEST(!length.is_held());
  BOOST_TEST(length.yield() == 1.0);
}

BOOST_AUTO_TEST_CASE(a_start_that_is_strained_is_soft_until_it_shrinks)
{
  SubstepLength length;
  length.begin(0.9);
  BOOST_TEST(length.yield() == 1.0);
  length.begin(10.0);
  BOOST_TEST(steps(length, 100, [](const SubstepLength &) { return 10.0; }) <= 12);
  BOOST_TEST(!length.is_held());
  steps(length, 250, [](const SubstepLength &) { return 10.0; });
  BOOST_TEST(length.is_held());
  SubstepLength other;
  other.begin(10.0);
  steps(other, 200, [](const SubstepLength &) { return 0.5; });
  BOOST_TEST(other.yield() == 1.0);
  BOOST_TEST(!other.is_held());
}

BOOST_AUTO_TEST_CASE(a_load_that_no_hardening_bears_is_not_taken_for_held)
{
  SubstepLength length;
  const auto load = [](const SubstepLength &of) { return 2.0 * of.yield(); };
  steps(length, 100, load);
  BOOST_TEST(length.is_overloaded());
  BOOST_TEST(!length.is_held());
  steps(length, 100, load);
  BOOST_TEST(length.yield() == 1.0);
  // a moment is not enough for either
  SubstepLength other;
  for (int k = 0; k < 50; k++) {
    steps(other, 20, load);
    steps(other, 1, [](const SubstepLength &) { return 0.5; });
    BOOST_TEST(other.yield() == 1.0);
  }
}

// A load that comes at once stretches edges farther than the springs that it needs would be.
// Springs that are as hard as it needs would give back more at this strain than it has put in.

BOOST_AUTO_TEST_CASE(an_impact_raises_the_allowed_strain_to_what_the_substeps_have_borne)
{
  SubstepLength length;
  const auto step = [&](double dt, double hardest) {
    length.substeps(dt, 10);
    length.found(hardest, 1.0);
  };
  step(DT, 1.0);
  step(DT, 0.5);
  BOOST_TEST(length.state.hardness == 1.0);
  // as far as springs are under their load, or hardly hard
  length.stretched(1.9, 1.0);
  length.stretched(0.66, 0.1);
  BOOST_TEST(length.yield() == 1.0);
  // a load that came at once, or a stretch that it does not explain
  SubstepLength other = length;
  other.found(0.2, 1.0);
  other.stretched(1.9, 1.0);
  BOOST_TEST(other.yield() > 3.0);
  step(DT, 0.3);
  length.stretched(5.0, 1.0);
  // springs at that strain are as hard as the substeps were
  BOOST_TEST(hardness(5.0 / length.yield()) == length.state.hardness,
             boost::test_tools::tolerance(1e-12));
  const double raised = length.yield();
  // what has not been stretched changes nothing
  length.stretched(0.1, 1.0);
  BOOST_TEST(length.yield() == raised);
  // it returns in time, not in steps
  step(DT, 0.01);
  const double after_one = length.yield();
  for (int n = 0; n < 10; n++) step(0.1 * DT, 0.01);
  BOOST_TEST(raised / after_one == 1.03, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(after_one / length.yield() == 1.03, boost::test_tools::tolerance(1e-12));
  for (int n = 0; n < 200; n++) step(DT, 1.0);
  BOOST_TEST(length.yield() == 1.0);
}

BOOST_AUTO_TEST_CASE(given_substeps_are_followed_down_slowly_and_up_at_once)
{
  SubstepLength length;
  for (int k = 0; k < 5; k++) length.follow(k == 2 ? 3.0 : 1.0);
  BOOST_TEST(length.longest() == 3.0 / 1.01 / 1.01, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_SUITE_END()
