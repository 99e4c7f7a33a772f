// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/point_passage.h"

#include <boost/test/unit_test.hpp>

#include <random>
#include <vector>

using namespace sphcloth;

namespace {

PairMotion motion(const FourPoints &start, const FourPoints &end)
{
  PairMotion pair{PairKind::POINT_TRIANGLE, start, {}};
  for (int k = 0; k < 4; k++) pair.displacement[k] = end[k] - start[k];
  return pair;
}

FourPoints over_triangle(const Vec3 &p, double z = 0.0)
{
  return {p, Vec3(0, 0, z), Vec3(1, 0, z), Vec3(0, 1, z)};
}

std::optional<Vec3> past_resting_triangle(const Vec3 &from, const Vec3 &to)
{
  return passage(motion(over_triangle(from), over_triangle(to)));
}

}    // namespace

BOOST_AUTO_TEST_SUITE(point_passage)

BOOST_AUTO_TEST_CASE(through_the_middle_from_both_sides_at_any_speed)
{
  for (double side : {1.0, -1.0})
    for (double speed : {0.02, 1.0, 1000.0}) {
      const auto at =
          past_resting_triangle({0.3, 0.1, side * 0.01}, {0.3, 0.1, side * (0.01 - speed)});
      BOOST_REQUIRE(at);
      BOOST_CHECK_SMALL((*at - Vec3(0.6, 0.3, 0.1)).norm(), 1e-12);
    }
}

BOOST_AUTO_TEST_CASE(past_the_edge_away_along_and_short_of_it_do_not_count)
{
  BOOST_CHECK(!past_resting_triangle({0.8, 0.8, 0.1}, {0.8, 0.8, -0.1}));
  BOOST_CHECK(!past_resting_triangle({0.2, 0.2, 0.1}, {0.2, 0.2, 0.3}));
  BOOST_CHECK(!past_resting_triangle({0.2, 0.2, 0.1}, {0.3, 0.2, 0.1}));
  BOOST_CHECK(!past_resting_triangle({0.2, 0.2, 0.1}, {0.2, 0.2, 0.01}));
}

BOOST_AUTO_TEST_CASE(the_start_itself_does_not_count_and_the_end_does)
{
  BOOST_CHECK(!past_resting_triangle({0.2, 0.2, 0.0}, {0.2, 0.2, -1.0}));
  BOOST_CHECK(past_resting_triangle({0.2, 0.2, 1.0}, {0.2, 0.2, 0.0}));
  BOOST_CHECK(past_resting_triangle({0.2, 0.2, -1.0}, {0.2, 0.2, 0.0}));
}

BOOST_AUTO_TEST_CASE(a_falling_or_turning_triangle_sweeps_over_a_resting_point)
{
  const Vec3 rest(0.2, 0.2, 0.0);
  BOOST_CHECK(passage(motion(over_triangle(rest, 0.5), over_triangle(rest, -0.5))));
  FourPoints turned = over_triangle(rest, 0.05);
  turned[2] = Vec3(1, 0, -2);
  turned[3] = Vec3(0, 1, -2);
  BOOST_CHECK(passage(motion(over_triangle(rest, 0.05), turned)));
}

BOOST_AUTO_TEST_CASE(no_seam_between_two_triangles)
{
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  const Vec3 a(0, 0, 0.1), b(1, 0, 0.3), c(1, 1, -0.2), d(0, 1, 0.4);
  for (int k = 0; k < 10000; k++) {
    const double s = u(generator);    // points right on the shared edge
    const Vec3 on_edge = a + s * (c - a), from = on_edge + Vec3(0, 0, u(generator)),
               to = on_edge - Vec3(0, 0, u(generator));
    BOOST_CHECK(passage(motion({from, a, b, c}, {to, a, b, c})) ||
                passage(motion({from, a, c, d}, {to, a, c, d})));
  }
}

// The heights at many moments show how often a point passes the plane; where it does so once, the
// place follows by bisection.

BOOST_AUTO_TEST_CASE(a_single_passage_is_found_where_it_is)
{
  std::mt19937 dice(11);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto point = [&] { return Vec3(any(dice), any(dice), any(dice)); };
  constexpr int MOMENTS = 200;
  int through = 0, beside = 0, none = 0;
  for (int n = 0; n < 20000; n++) {
    const PairMotion pair =
        motion({point(), point(), point(), point()}, {point(), point(), point(), point()});
    const auto is_above = [&](double time) {
      const FourPoints x = pair.at(time);
      return (x[0] - x[1]).dot((x[2] - x[1]).cross(x[3] - x[1])) > 0.0;
    };
    int changes = 0;
    double from = 0.0;
    for (int m = 0; m < MOMENTS; m++)
      if (is_above(m / double(MOMENTS)) != is_above((m + 1) / double(MOMENTS))) {
        changes++;
        from = m / double(MOMENTS);
      }
    const auto found = passage(pair);
    if (changes % 2 == 0) {
      BOOST_CHECK(!found);
      none++;
    }
    if (changes != 1) continue;
    double to = from + 1.0 / MOMENTS;
    for (int k = 0; k < 60; k++) {
      const double middle = 0.5 * (from + to);
      (is_above(middle) == is_above(from) ? from : to) = middle;
    }
    const FourPoints x = pair.at(from);
    const Vec3 normal = (x[2] - x[1]).cross(x[3] - x[1]);
    if (normal.norm() < 0.01) continue;
    const Vec3 weight = barycentric(x[0], x[1], x[2], x[3]);
    if (std::fabs(weight.minCoeff()) < 1e-6) continue;
    BOOST_REQUIRE(found.has_value() == (weight.minCoeff() > 0.0));
    if (!found) {
      beside++;
      continue;
    }
    through++;
    BOOST_CHECK_SMALL((*found - weight).norm(), 1e-6);
  }
  BOOST_CHECK(through > 500);
  BOOST_CHECK(beside > 2000);
  BOOST_CHECK(none > 5000);
}

BOOST_AUTO_TEST_SUITE_END()
