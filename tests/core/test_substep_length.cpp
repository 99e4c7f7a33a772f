// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pbd/substep_length.h"

#include <boost/test/unit_test.hpp>

using namespace sphcloth;

namespace {

constexpr double DT = 1e-3, USUAL = DT / 10;

// steps under a load, whose strain over the allowed one is `of` the square of a length
template <class Strain> double steps(SubstepLength &length, int n, Strain of)
{
  double substeps = 0.0;
  for (int k = 0; k < n; k++) {
    substeps = length.substeps(DT, 10);
    length.use(DT / substeps);
    length.set_demand(of(length.length()) / (length.length() * length.length()));
  }
  return substeps;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(substep_length)

BOOST_AUTO_TEST_CASE(the_longest_step_has_as_many_as_usual)
{
  SubstepLength length;
  BOOST_TEST(length.substeps(DT, 10) == 10);
  BOOST_TEST(length.substeps(2.0 * DT, 10) > 19);    // it lengthens slowly
  BOOST_TEST(length.substeps(0.1 * DT, 10) == 1);
  BOOST_TEST(length.length() == USUAL, boost::test_tools::tolerance(0.03));
}

BOOST_AUTO_TEST_CASE(a_load_shortens_it_by_one_percent_a_step_until_the_strain_is_allowed)
{
  SubstepLength length;
  const auto load = [](double of) { return 16.0 * of * of / (USUAL * USUAL); };
  steps(length, 2, load);
  BOOST_TEST(length.length() == USUAL / 1.01, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(steps(length, 300, load) == 40);
  BOOST_TEST(length.length() == USUAL / 4, boost::test_tools::tolerance(1e-3));
  BOOST_TEST(!length.is_held());
  // without it back to what is usual
  BOOST_TEST(steps(length, 300, [](double) { return 0.0; }) == 10);
}

BOOST_AUTO_TEST_CASE(a_strain_that_does_not_fall_shortens_it_no_more)
{
  SubstepLength length;
  const auto held = [](double) { return 3.0; };
  int first = 0;
  for (int k = 1; k < 5000; k++) {
    steps(length, 1, held);
    if (length.is_held() && first == 0) first = k;
  }
  BOOST_TEST(first > 200);
  BOOST_TEST(first < 300);
  BOOST_TEST(length.length() == USUAL, boost::test_tools::tolerance(0.02));
  steps(length, 300, [](double) { return 0.5; });
  BOOST_TEST(length.length() == USUAL, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(a_load_that_grows_is_not_held)
{
  SubstepLength length;
  double growth = 1.0;
  const auto load = [&](double of) {
    growth = std::min(growth * 1.03, 64.0);
    return growth * of * of / (USUAL * USUAL);
  };
  for (int k = 0; k < 100; k++) {
    steps(length, 10, load);
    BOOST_TEST(!length.is_held());
  }
  BOOST_TEST(length.length() == USUAL / 8, boost::test_tools::tolerance(1e-3));
}

BOOST_AUTO_TEST_CASE(it_is_never_shorter_than_the_present_one)
{
  SubstepLength length;
  for (int k = 0; k < 5; k++) {
    length.stiffen();
    length.use(k == 2 ? 3.0 : 1.0);
  }
  BOOST_TEST(length.length() == 3.0 / 1.01 / 1.01, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_SUITE_END()
