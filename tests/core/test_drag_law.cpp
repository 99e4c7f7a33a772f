// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/air/drag_law.h"

#include <boost/test/unit_test.hpp>

#include <cmath>

using namespace sphcloth;

namespace {

constexpr double RIGHT = 1.57079632679489662;

// of the cross-flow principle: drag C sin^3 a, lift C sin^2 a cos a
DragTable table_of(double coefficient, int rows)
{
  std::vector<DragTable::Row> all;
  for (int k = 0; k < rows; k++) {
    const double angle = RIGHT * k / (rows - 1);
    const double sine = std::sin(angle);
    all.push_back(
        {angle, coefficient * sine * sine * sine, coefficient * sine * sine * std::cos(angle)});
  }
  return DragTable(all);
}

template <class Law> double slope_of_normal(const Law &law, double across, double along)
{
  const double h = 1e-6;
  return (law.terms(across + h, along).normal - law.terms(across - h, along).normal) / (2.0 * h);
}

template <class Law> double slope_of_tangential(const Law &law, double across, double along)
{
  const double h = 1e-6;
  return (law.terms(across, along + h).tangential - law.terms(across, along - h).tangential) /
      (2.0 * h);
}

}    // namespace

BOOST_AUTO_TEST_SUITE(drag_law)

BOOST_AUTO_TEST_CASE(a_plate_across_the_wind_has_the_normal_coefficient)
{
  const DragCoefficients law{1.2, 0.02};
  BOOST_TEST(law.terms(3.0, 0.0).normal == 1.2 * 9.0);
  BOOST_TEST(law.terms(3.0, 0.0).tangential == 0.0);
  BOOST_TEST(law.terms(0.0, 3.0).normal == 0.0);
  BOOST_CHECK_SMALL(law.terms(0.0, 3.0).tangential - 0.02 * 9.0, 1e-14);
  BOOST_CHECK_SMALL(law.terms(3.0, 4.0).normal - 1.2 * 9.0, 1e-14);
  BOOST_CHECK_SMALL(law.terms(3.0, 4.0).tangential - 0.02 * 5.0 * 4.0, 1e-14);
}

BOOST_AUTO_TEST_CASE(slopes_are_derivatives)
{
  const DragCoefficients law{1.2, 0.3};
  const DragTable table = table_of(1.2, 19);
  for (const double along : {0.3, 2.0, 5.0})
    for (const double across : {0.2, 1.7, 4.0}) {
      const DragTerms by_law = law.terms(across, along), by_table = table.terms(across, along);
      BOOST_CHECK_SMALL(by_law.normal_slope - slope_of_normal(law, across, along), 1e-8);
      BOOST_CHECK_SMALL(by_law.tangential_slope - slope_of_tangential(law, across, along), 1e-8);
      BOOST_CHECK_SMALL(by_table.normal_slope - slope_of_normal(table, across, along), 1e-7);
    }
}

BOOST_AUTO_TEST_CASE(a_table_follows_the_law_it_was_made_of)
{
  const DragCoefficients law{1.2, 0.0};
  for (const double along : {0.0, 0.3, 5.0})
    for (const double across : {0.0, 0.2, 4.0}) {
      const double coarse =
          table_of(1.2, 10).terms(across, along).normal - law.terms(across, along).normal;
      const double fine =
          table_of(1.2, 91).terms(across, along).normal - law.terms(across, along).normal;
      BOOST_CHECK_SMALL(coarse, 0.02 * (across * across + along * along));
      BOOST_CHECK_SMALL(fine, 0.0003 * (across * across + along * along));
    }
}

BOOST_AUTO_TEST_CASE(rows_are_met_and_ends_hold)
{
  const DragTable table({{0.0, 0.1, 0.0}, {0.5, 0.4, 0.8}, {RIGHT, 1.5, 0.0}});
  const double across = std::sin(0.5), along = std::cos(0.5);
  const DragTerms terms = table.terms(across, along);
  BOOST_CHECK_SMALL(terms.normal - (0.4 * across + 0.8 * along), 1e-14);
  BOOST_CHECK_SMALL(terms.tangential - (0.4 * along - 0.8 * across), 1e-14);
  BOOST_CHECK_SMALL(table.terms(2.0, 0.0).normal - 6.0, 1e-14);
  BOOST_CHECK_SMALL(table.terms(0.0, 2.0).tangential - 0.4, 1e-14);
  BOOST_TEST(table.terms(0.0, 0.0).normal == 0.0);
}

// a slope above force over velocity: a step with it never turns the velocity around

BOOST_AUTO_TEST_CASE(slopes_are_not_below_force_over_velocity)
{
  const DragTable table({{0.0, 0.0, 0.0}, {0.2, 0.3, 1.2}, {0.5, 0.5, 0.3}, {RIGHT, 1.2, 0.0}});
  for (double angle = 0.05; angle < 1.55; angle += 0.1) {
    const double across = 3.0 * std::sin(angle), along = 3.0 * std::cos(angle);
    const DragTerms terms = table.terms(across, along);
    BOOST_TEST(terms.normal_slope * across >= terms.normal * (1.0 - 1e-14));
    BOOST_TEST(terms.tangential_slope * along >= terms.tangential * (1.0 - 1e-14));
  }
}

BOOST_AUTO_TEST_SUITE_END()
