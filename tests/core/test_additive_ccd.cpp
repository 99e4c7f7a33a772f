// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/additive_ccd.h"

#include <boost/test/unit_test.hpp>

#include <limits>
#include <random>

using namespace sphcloth;

namespace {

std::mt19937 random_numbers(11);

Vec3 random_point(double size)
{
  std::uniform_real_distribution<double> coordinate(-size, size);
  return {coordinate(random_numbers), coordinate(random_numbers), coordinate(random_numbers)};
}

PairMotion random_motion(PairKind kind, double size)
{
  PairMotion pair{kind, {}, {}};
  for (int k = 0; k < 4; k++) {
    pair.start[k] = random_point(1.0);
    pair.displacement[k] = random_point(size);
  }
  return pair;
}

double distance_at(const PairMotion &pair, double time)
{
  return closest_points(pair.kind, pair.at(time)).vector.norm();
}

double smallest_distance(const PairMotion &pair, double until)
{
  constexpr int N = 2000;
  double smallest = std::numeric_limits<double>::infinity();
  for (int n = 0; n <= N; n++) smallest = std::min(smallest, distance_at(pair, until * n / N));
  return smallest;
}

constexpr PairKind KINDS[] = {PairKind::POINT_TRIANGLE, PairKind::EDGE_EDGE};

}    // namespace

BOOST_AUTO_TEST_SUITE(additive_ccd)

BOOST_AUTO_TEST_CASE(pairs_stay_apart_until_the_safe_time_and_most_of_the_distance_is_used)
{
  int met = 0;
  for (const PairKind kind : KINDS)
    for (int n = 0; n < 300; n++) {
      const PairMotion pair = random_motion(kind, 2.0);
      const double start = distance_at(pair, 0.0), keep = 0.1 * start;
      const SafeTime safe = safe_time(pair, keep);
      BOOST_CHECK(smallest_distance(pair, safe.time) > keep);
      BOOST_CHECK_SMALL((closest_points(kind, pair.at(safe.time)).vector - safe.vector).norm(),
                        safe.time == 1.0 ? 10.0 : 1e-12);
      if (safe.time == 1.0) continue;
      met++;
      BOOST_CHECK(distance_at(pair, safe.time) <= keep + 0.1 * (start - keep) + 1e-12);
    }
  BOOST_CHECK(met > 50);
}

BOOST_AUTO_TEST_CASE(every_test_agrees_with_what_the_distance_does)
{
  int apart = 0, meet = 0;
  for (const PairKind kind : KINDS)
    for (int n = 0; n < 300; n++) {
      const PairMotion pair = random_motion(kind, 1.0);
      const Vec3 vector = closest_points(kind, pair.start).vector;
      const double keep = 0.1 * vector.norm();
      const bool stays = stays_apart(pair, vector, keep);
      const double smallest = smallest_distance(pair, 1.0);
      if (stays) BOOST_CHECK(smallest > keep - 1e-12);
      if (smallest > 0.25 * vector.norm()) BOOST_CHECK(stays);
      (stays ? apart : meet)++;
    }
  BOOST_CHECK(apart > 100);
  BOOST_CHECK(meet > 50);
}

BOOST_AUTO_TEST_CASE(motion_of_all_together_does_not_matter)
{
  for (const PairKind kind : KINDS) {
    PairMotion pair = random_motion(kind, 0.0);
    for (Vec3 &u : pair.displacement) u = Vec3(3.0, -200.0, 1.0);
    BOOST_CHECK_SMALL(max_approach(pair), 1e-12);
    BOOST_CHECK_SMALL(max_approach_along(Vec3(0, 1, 0), pair), 1e-12);
    BOOST_CHECK(safe_time(pair, 0.5 * distance_at(pair, 0.0)).time == 1.0);
  }
}

BOOST_AUTO_TEST_CASE(layers_that_slide_far_are_told_by_the_plane_between_them)
{
  const Vec3 slide(100.0, 0.0, 0.0);
  PairMotion pair{PairKind::POINT_TRIANGLE,
                  {Vec3(0, 0, 0.01), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)},
                  {slide, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}};
  BOOST_CHECK(stays_apart(pair, {0, 0, 0.01}, 1e-3));
  pair.displacement[0] += Vec3(0, 0, -0.0095);    // it is beside the triangle when it is so low
  BOOST_CHECK(stays_apart(pair, {0, 0, 0.01}, 1e-3));
  pair.displacement[0] = Vec3(0, 0, -0.0095);
  BOOST_CHECK(!stays_apart(pair, {0, 0, 0.01}, 1e-3));
}

BOOST_AUTO_TEST_SUITE_END()
