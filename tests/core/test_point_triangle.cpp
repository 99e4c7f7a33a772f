// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/point_triangle.h"

#include <boost/test/unit_test.hpp>

#include <array>
#include <random>

using namespace sphcloth;

namespace {

std::array<Sweep, 3> resting_triangle(double z = 0.0)
{
  const Vec3 a(0, 0, z), b(1, 0, z), c(0, 1, z);
  return {Sweep{a, a}, Sweep{b, b}, Sweep{c, c}};
}

}    // namespace

BOOST_AUTO_TEST_SUITE(point_triangle)

BOOST_AUTO_TEST_CASE(cubic_roots_in_the_unit_interval_in_order)
{
  // (t - .1)(t - .5)(t - .9)
  const Roots r = cubic_roots(-0.045, 0.59, -1.5, 1.0);
  BOOST_CHECK(r.n == 3);
  BOOST_CHECK_SMALL(r.t[0] - 0.1, 1e-12);
  BOOST_CHECK_SMALL(r.t[1] - 0.5, 1e-12);
  BOOST_CHECK_SMALL(r.t[2] - 0.9, 1e-12);
  BOOST_CHECK(cubic_roots(-0.5, 1.0, 0.0, 0.0).n == 1);
  BOOST_CHECK_SMALL(cubic_roots(-0.5, 1.0, 0.0, 0.0).t[0] - 0.5, 1e-14);
  BOOST_CHECK(cubic_roots(1.0, 0.0, 0.0, 0.0).n == 0);
  BOOST_CHECK(cubic_roots(0.25, -1.0, 0.0, 0.0).n == 1);
}

BOOST_AUTO_TEST_CASE(through_the_middle_from_both_sides_at_any_speed)
{
  for (double side : {1.0, -1.0})
    for (double speed : {0.02, 1.0, 1000.0}) {
      const Sweep p{{0.3, 0.1, side * 0.01}, {0.3, 0.1, side * (0.01 - speed)}};
      const ContactResult t = point_triangle_contact(p, resting_triangle(), 1e-3);
      BOOST_CHECK(t.hit);
      BOOST_CHECK(t.through == (speed > 0.01));
      BOOST_CHECK_SMALL(t.normal[2] - side, 1e-15);
      BOOST_CHECK_SMALL(t.depth - (speed - 0.01 + 1e-3), 1e-9 * speed);
      BOOST_CHECK_SMALL((t.weight - Vec3(0.6, 0.3, 0.1)).norm(), 1e-9);
    }
}

static ContactResult contact_at_rest(const Sweep &p)
{
  return point_triangle_contact(p, resting_triangle(), 1e-3);
}

BOOST_AUTO_TEST_CASE(past_the_edge_away_along_and_short_of_it_do_not_count)
{
  BOOST_CHECK(!contact_at_rest({{0.8, 0.8, 0.1}, {0.8, 0.8, -0.1}}).hit);
  BOOST_CHECK(!contact_at_rest({{0.2, 0.2, 0.1}, {0.2, 0.2, 0.3}}).hit);
  BOOST_CHECK(!contact_at_rest({{0.2, 0.2, 0.1}, {0.3, 0.2, 0.1}}).hit);
  BOOST_CHECK(!contact_at_rest({{0.2, 0.2, 0.1}, {0.2, 0.2, 0.01}}).hit);
}

BOOST_AUTO_TEST_CASE(inside_the_thickness_the_gap_may_not_shrink_and_is_never_widened)
{
  const ContactResult nearer =
      point_triangle_contact({{0.2, 0.2, 4e-4}, {0.2, 0.2, 3e-4}}, resting_triangle(), 1e-3);
  BOOST_CHECK(nearer.hit);
  BOOST_CHECK(!nearer.through);
  BOOST_CHECK_SMALL(nearer.depth - 1e-4, 1e-12);
  BOOST_CHECK(!contact_at_rest({{0.2, 0.2, 4e-4}, {0.25, 0.2, 4e-4}}).hit);
  BOOST_CHECK(!contact_at_rest({{0.2, 0.2, 4e-4}, {0.2, 0.2, 5e-4}}).hit);
}

BOOST_AUTO_TEST_CASE(a_falling_or_turning_triangle_sweeps_over_a_resting_point)
{
  const Vec3 rest(0.2, 0.2, 0.0);
  std::array<Sweep, 3> falling = resting_triangle(0.5);
  for (Sweep &s : falling) s.end[2] = -0.5;
  BOOST_CHECK(point_triangle_contact({rest, rest}, falling, 1e-3).hit);
  std::array<Sweep, 3> turning = resting_triangle(0.05);
  turning[1].end = Vec3(1, 0, -2);
  turning[2].end = Vec3(0, 1, -2);
  BOOST_CHECK(point_triangle_contact({rest, rest}, turning, 1e-3).hit);
}

BOOST_AUTO_TEST_CASE(no_seam_between_two_triangles)
{
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  const Vec3 a(0, 0, 0.1), b(1, 0, 0.3), c(1, 1, -0.2), d(0, 1, 0.4);
  const std::array<Sweep, 3> t1 = {Sweep{a, a}, Sweep{b, b}, Sweep{c, c}};
  const std::array<Sweep, 3> t2 = {Sweep{a, a}, Sweep{c, c}, Sweep{d, d}};
  for (int k = 0; k < 10000; k++) {
    const double s = u(generator);    // points right on the shared edge
    const Vec3 on_edge = a + s * (c - a);
    const Sweep p{on_edge + Vec3(0, 0, u(generator)), on_edge - Vec3(0, 0, u(generator))};
    BOOST_CHECK(point_triangle_contact(p, t1, 1e-6).hit || point_triangle_contact(p, t2, 1e-6).hit);
  }
}

BOOST_AUTO_TEST_CASE(edges_and_vertices_keep_their_distance_too)
{
  // beside the edge from (0, 0) to (1, 0), and off the corner at the origin
  const ContactResult edge =
      point_triangle_contact({{0.5, -0.02, 0.0}, {0.5, -0.005, 0.0}}, resting_triangle(), 0.01);
  BOOST_CHECK(edge.hit && !edge.through);
  BOOST_CHECK_SMALL(edge.depth - 0.005, 1e-12);
  BOOST_CHECK_SMALL((edge.normal - Vec3(0, -1, 0)).norm(), 1e-12);
  BOOST_CHECK_SMALL((edge.weight - Vec3(0.5, 0.5, 0.0)).norm(), 1e-12);
  const ContactResult corner =
      point_triangle_contact({{-0.3, -0.4, 0.0}, {-0.003, -0.004, 0.0}}, resting_triangle(), 0.01);
  BOOST_CHECK(corner.hit);
  BOOST_CHECK_SMALL(corner.depth - 0.005, 1e-12);
  BOOST_CHECK_SMALL((corner.weight - Vec3(1, 0, 0)).norm(), 1e-12);
}

BOOST_AUTO_TEST_CASE(no_point_of_a_triangle_is_nearer_than_the_closest)
{
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto vec = [&] { return Vec3(u(generator), u(generator), u(generator)); };
  for (int k = 0; k < 200; k++) {
    const Vec3 a = vec(), b = vec(), c = vec(), p = 2.0 * vec();
    Vec3 weight;
    const double distance = distance_vector(p, a, b, c, weight).norm();
    BOOST_CHECK(weight.minCoeff() >= 0.0);
    BOOST_CHECK_SMALL(weight.sum() - 1.0, 1e-14);
    for (int m = 0; m < 200; m++) {
      double r = 0.5 * (u(generator) + 1.0), s = 0.5 * (u(generator) + 1.0);
      if (r + s > 1.0) {
        r = 1.0 - r;
        s = 1.0 - s;
      }
      BOOST_CHECK((p - a - r * (b - a) - s * (c - a)).norm() >= distance - 1e-12);
    }
  }
}

BOOST_AUTO_TEST_CASE(volume_that_is_never_zero_has_no_root)
{
  std::mt19937 generator(9);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  int never = 0;
  for (int k = 0; k < 20000; k++) {
    const SignedVolume v{u(generator), u(generator), u(generator), u(generator)};
    if (!v.never_zero()) continue;
    never++;
    BOOST_CHECK(cubic_roots(v.c0, v.c1, v.c2, v.c3).n == 0);
  }
  BOOST_CHECK(never > 2000);
}

BOOST_AUTO_TEST_CASE(what_is_known_of_the_start_finds_the_same_contact)
{
  std::mt19937 dice(11);
  std::uniform_real_distribution<double> any(-0.3, 0.3);
  const auto point = [&] { return Vec3(any(dice), any(dice), any(dice)); };
  const double thickness = 0.1;
  int hits = 0, clear = 0;
  for (int n = 0; n < 20000; n++) {
    const Sweep p{point(), point()};
    const std::array<Sweep, 3> t{Sweep{point(), point()}, {point(), point()}, {point(), point()}};
    const ContactResult whole = point_triangle_contact(p, t, thickness, 0.0);
    const ContactStart start = contact_start({p.start, t[0].start, t[1].start, t[2].start});
    const PointAndTriangle end{p.end, t[0].end, t[1].end, t[2].end};
    if (whole.through || start.side * end.height < 0.0) continue;
    const ContactResult known =
        point_triangle_nearness(end, start.side, start.gap(thickness), 0.0);
    BOOST_REQUIRE(known.hit == whole.hit);
    Vec3 weight;
    const double distance = distance_vector(end.p, end.a, end.b, end.c, weight).norm();
    if (known.hit) {
      hits++;
      BOOST_CHECK(known.depth == whole.depth && known.normal == whole.normal);
      BOOST_CHECK_SMALL(known.depth - (start.gap(thickness) - distance), 1e-15);
    } else {
      clear += known.clearance > 0.0;
      BOOST_CHECK(known.clearance >= 0.0);
      BOOST_CHECK(known.clearance <= distance - start.gap(thickness) + 1e-15);
    }
  }
  BOOST_CHECK(hits > 500);
  BOOST_CHECK(clear > 5000);
}

BOOST_AUTO_TEST_CASE(above_a_flat_triangle_nothing_points_along_it_however_near)
{
  for (double height : {1e-3, 1e-9, 1e-14, -1e-14, 0.0}) {
    const Vec3 p(0.3, 0.2, 0.7 + height), a(0, 0, 0.7), b(1, 0, 0.7), c(0, 1, 0.7);
    const PointAndTriangle at{p, a, b, c};
    const Nearness near = nearness(at, -1.0);
    BOOST_CHECK(near.direction == Vec3(0.0, 0.0, height > 0.0 ? 1.0 : -1.0));
    BOOST_CHECK_SMALL(near.distance - std::fabs(height), 1e-15);
  }
}

BOOST_AUTO_TEST_SUITE_END()
