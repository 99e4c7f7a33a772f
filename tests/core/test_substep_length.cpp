// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pbd/substep_length.h"

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <limits>

using namespace sphcloth;

namespace {

constexpr double DT = 1e-3;

double hardness(double strain) { return std::pow(1.0 + 9.0 * std::pow(strain, 4), -2); }

// under a load, over the one that strains the unloaded spring by as much as is allowed
double strain_under(double load)
{
  double low = 0.0, high = load;
  while (high - low > 1e-12 * high) {
    const double y = 0.5 * (low + high);
    (std::min(y, 1.6) / hardness(std::min(y, 1.6)) * std::max(1.0, y / 1.6) > load ? high : low) =
        y;
  }
  return high;
}

void find(SubstepLength &length, double strain)
{
  length.found(hardness(std::min(strain, 1.6)), strain);
}

// n steps of an edge, `of` is what strains it; the last number of substeps
template <class Strain> double steps(SubstepLength &length, int n, Strain of)
{
  double substeps = 0.0;
  for (int k = 0; k < n; k++) {
    substeps = length.substeps(DT, 10);
    find(length, of(length));
  }
  return substeps;
}

auto free_edge()
{
  return [](const SubstepLength &) { return 0.0; };
}

auto loaded(double load)
{
  return [load](const SubstepLength &length) { return strain_under(load / length.yield()); };
}

// Something holds the ends apart, at a strain over the one that `strain` allows.  The pull is that
// of a spring, or of the softer one that substeps make of it.
auto held(double strain)
{
  return [strain](const SubstepLength &length) {
    const double y = strain / length.yield();
    return strain_under(y / std::max(length.state.hardness, hardness(std::min(y, 1.6))));
  };
}

// half of the softness that a load leaves, where it hardens edges by far

double needed(double hardness) { return 10.0 / std::sqrt(0.5 * hardness * (1.0 + hardness)); }

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

BOOST_AUTO_TEST_CASE(constraints_without_a_size_take_substeps_of_their_own_to_a_limit)
{
  SubstepLength length;
  length.substeps(DT, 10);
  BOOST_TEST(length.substeps_for(DT, DT / 69.5) == 70);
  BOOST_TEST(length.substeps_for(0.5 * DT, DT / 69.5) == 35);
  BOOST_TEST(length.substeps_for(DT, std::numeric_limits<double>::infinity()) == 0);
  // no more than under the heaviest load
  BOOST_TEST(length.substeps_for(DT, 0.0) == std::ceil(needed(hardness(1.6))));
}

BOOST_AUTO_TEST_CASE(a_load_shortens_them_at_once_and_lengthens_them_slowly)
{
  SubstepLength length;
  steps(length, 3, free_edge());
  length.found(1.0 / 16.0, 0.76);
  BOOST_TEST(length.substeps(DT, 10) == std::ceil(needed(1.0 / 16.0) - 0.1));
  length.found(1.0, 0.0);
  BOOST_TEST(length.substeps(DT, 10) == std::ceil(needed(1.03 / 16.0) - 0.1));
  BOOST_TEST(steps(length, 30, free_edge()) > 20);
  BOOST_TEST(steps(length, 100, free_edge()) == 10);
  BOOST_TEST(length.longest() == 0.1 * DT);
}

// A sheet whose substeps change does not come to rest.

BOOST_AUTO_TEST_CASE(a_load_that_varies_by_little_changes_nothing)
{
  SubstepLength length;
  steps(length, 500, loaded(100.0));
  steps(length, 20, loaded(95.0));
  steps(length, 1, loaded(100.0));
  const double usual = steps(length, 1, loaded(100.0));
  for (int k = 0; k < 100; k++)
    BOOST_TEST(steps(length, 1, loaded(k % 2 == 0 ? 95.0 : 100.0)) == usual);
  BOOST_TEST(steps(length, 100, loaded(70.0)) < 0.9 * usual);
  steps(length, 100, loaded(100.0));
  BOOST_TEST(steps(length, 2, loaded(110.0)) > usual);
  BOOST_TEST(steps(length, 300, free_edge()) == 10);
}

// By 1 % in a step.  Springs bear it, and no more is allowed than the 3 % that a step takes back.

BOOST_AUTO_TEST_CASE(a_load_that_grows_slowly_is_borne)
{
  SubstepLength length;
  for (double load = 0.1; load < 3000.0; load *= 1.01) {
    const double substeps = steps(length, 1, loaded(load));
    BOOST_TEST(length.yield() < 1.03);
    BOOST_TEST(substeps >= 0.98 * needed(hardness(strain_under(load / 1.01))));
    BOOST_TEST(substeps <= 1.05 * needed(hardness(strain_under(load))) + 1.0);
  }
}

// A load that comes at once stretches edges farther than the springs that it needs would be.
// Springs that are as hard as it needs would give back more at this strain than it has put in.

BOOST_AUTO_TEST_CASE(an_impact_raises_the_allowed_strain_to_what_the_substeps_have_borne)
{
  SubstepLength length;
  steps(length, 200, loaded(1.9));
  const double before = length.state.hardness;
  BOOST_TEST(length.yield() == 1.0);
  BOOST_TEST(before < 0.35);
  const double strain = 3.0;
  steps(length, 1, held(strain));
  // but for the 5 % by which a load at rest varies
  BOOST_TEST(hardness(0.95 * strain / length.yield()) == 0.95 * before,
             boost::test_tools::tolerance(0.02));
  const double raised = length.yield();
  BOOST_TEST(raised == 5.0, boost::test_tools::tolerance(0.01));
  // what has not been stretched changes nothing, and it returns in time, not in steps
  steps(length, 1, free_edge());
  const double after_one = length.yield();
  BOOST_TEST(raised / after_one == 1.03, boost::test_tools::tolerance(1e-12));
  for (int n = 0; n < 10; n++) {
    length.substeps(0.1 * DT, 10);
    find(length, 0.0);
  }
  BOOST_TEST(after_one / length.yield() == 1.03, boost::test_tools::tolerance(1e-12));
  steps(length, 200, free_edge());
  BOOST_TEST(length.yield() == 1.0);
}

// More of them while half of what stops the water is missing, at most ten times as many.

BOOST_AUTO_TEST_CASE(contact_that_lags_behind_takes_more_of_them)
{
  SubstepLength length;
  steps(length, 3, free_edge());
  const auto after = [&length](double share, double dt = DT) {
    length.missed_in_contact(share);
    length.missed_in_contact(0.1);
    const double substeps = length.substeps(dt, 10);
    find(length, 0.0);
    return substeps;
  };
  BOOST_TEST(after(0.5) == 10);
  BOOST_TEST(after(0.51) == 13);
  BOOST_TEST(after(0.9) == 17);
  // and less of them in time, not in steps
  BOOST_TEST(length.state.refined == 1.69, boost::test_tools::tolerance(1e-12));
  for (int n = 0; n < 10; n++) after(0.0, 0.1 * DT);
  BOOST_TEST(length.state.refined == 1.69 / 1.03, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(steps(length, 30, free_edge()) == 10);
  for (int n = 0; n < 30; n++) after(1.0);
  BOOST_TEST(after(1.0) == 100);
}

BOOST_AUTO_TEST_CASE(what_is_held_apart_yields_until_it_is_soft)
{
  SubstepLength length;
  steps(length, 300, held(3.0));
  BOOST_TEST(length.is_held());
  BOOST_TEST(!length.is_overloaded());
  const double yield = length.yield();
  BOOST_TEST(3.0 / yield < 1.0 / 3.0);
  BOOST_TEST(3.0 / yield > 0.3);
  // 12 would do, which is less than a tenth softer
  const double its = hardness(3.0 / yield);
  BOOST_TEST(std::ceil(needed(its) - 0.1) == 12);
  BOOST_TEST(std::ceil(needed(its / 1.1) - 0.1) == 13);
  BOOST_TEST(steps(length, 200, held(3.0)) == 13);
  BOOST_TEST(length.yield() == yield);
  // an impact raises what is allowed further, but not for good
  steps(length, 1, held(30.0));
  BOOST_TEST(length.yield() > 2.0 * yield);
  steps(length, 200, held(3.0));
  BOOST_TEST(length.yield() == yield);
  BOOST_TEST(length.is_held());
  // let go, it is as before
  steps(length, 200, free_edge());
  BOOST_TEST(!length.is_held());
  BOOST_TEST(length.yield() == 1.0);
}

BOOST_AUTO_TEST_CASE(a_start_that_is_strained_is_soft_until_it_shrinks)
{
  SubstepLength length;
  length.begin(0.9);
  BOOST_TEST(length.yield() == 1.0);
  length.begin(10.0);
  // held apart: harder for some steps, which change nothing
  for (int k = 0; k < 100; k++) BOOST_TEST(steps(length, 1, held(10.0)) < 50);
  BOOST_TEST(length.is_held());
  BOOST_TEST(steps(length, 100, held(10.0)) == 12);
  SubstepLength other;
  other.begin(10.0);
  steps(other, 200, held(0.5));
  BOOST_TEST(other.yield() == 1.0);
  BOOST_TEST(!other.is_held());
}

// A load that strains edges at the start by more than is allowed is no reason to allow it.

BOOST_AUTO_TEST_CASE(a_start_that_is_strained_by_a_load_hardens)
{
  SubstepLength length;
  length.begin(10.0);
  steps(length, 300, loaded(length.yield() / 3.0));
  BOOST_TEST(length.yield() == 1.0);
  BOOST_TEST(!length.is_held());
}

BOOST_AUTO_TEST_CASE(a_load_that_no_hardening_bears_is_not_taken_for_held)
{
  SubstepLength length;
  for (double load = 1.0; load < 3000.0; load *= 1.01) steps(length, 1, loaded(load));
  BOOST_TEST(length.yield() < 1.03);
  steps(length, 100, loaded(1e4));
  BOOST_TEST(length.is_overloaded());
  BOOST_TEST(!length.is_held());
  steps(length, 200, loaded(1e4));
  BOOST_TEST(length.yield() == 1.0);
}

BOOST_AUTO_TEST_CASE(given_substeps_are_followed_down_slowly_and_up_at_once)
{
  SubstepLength length;
  for (int k = 0; k < 5; k++) length.follow(k == 2 ? 3.0 : 1.0);
  BOOST_TEST(length.longest() == 3.0 / 1.01 / 1.01, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_SUITE_END()
