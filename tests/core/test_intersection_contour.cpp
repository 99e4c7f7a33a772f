// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/intersection_contour.h"

#include <boost/test/unit_test.hpp>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(intersection_contour)

namespace {

// a steep triangle whose side pq passes through another triangle
const Vec3 P(0.3, 0.2, 0.5), Q(0.2, 0.35, -0.4), R(0.6, 0.5, 0.2);
const Vec3 A(0, 0, 0.02), B(1, 0.1, 0), C(0.1, 1, -0.03);

Vec3 normal() { return (B - A).cross(C - A).normalized(); }

}    // namespace

BOOST_AUTO_TEST_CASE(weights_name_one_place_in_both)
{
  const auto w = weights_of_passing(P, Q, A, B, C);
  BOOST_CHECK_SMALL(w[0] + w[1] - 1.0, 1e-15);
  BOOST_CHECK_SMALL(w[2] + w[3] + w[4] + 1.0, 1e-15);
  BOOST_CHECK_SMALL((w[0] * P + w[1] * Q + w[2] * A + w[3] * B + w[4] * C).norm(), 1e-15);
  BOOST_CHECK_SMALL((w[0] * P + w[1] * Q - point_of_passing(P, Q, A, B, C)).norm(), 1e-15);
}

BOOST_AUTO_TEST_CASE(the_contour_lies_in_both_triangles_and_leads_into_that_at_the_edge)
{
  const Vec3 along = along_contour(P, Q, R, normal());
  BOOST_CHECK_SMALL(along.norm() - 1.0, 1e-15);
  BOOST_CHECK_SMALL(along.dot(normal()), 1e-15);
  BOOST_CHECK_SMALL(along.dot((Q - P).cross(R - P)), 1e-15);
  const Vec3 edge = (Q - P).normalized();
  BOOST_CHECK(along.dot(R - P - edge.dot(R - P) * edge) > 0.0);
  BOOST_CHECK_SMALL((along - along_contour(Q, P, R, -normal())).norm(), 1e-15);
}

// Edge and triangle move by half of a displacement each, in opposite directions.

BOOST_AUTO_TEST_CASE(minus_the_gradient_of_the_length_at_this_end)
{
  const Vec3 along = along_contour(P, Q, R, normal());
  const Vec3 shorter = shortening(P, Q, normal(), along), start = point_of_passing(P, Q, A, B, C);
  constexpr double STEP = 1e-6;
  for (int d = 0; d < 3; d++) {
    const Vec3 half = 0.5 * STEP * Vec3::Unit(d);
    const Vec3 end = point_of_passing(P + half, Q + half, A - half, B - half, C - half);
    BOOST_CHECK_SMALL(along.dot(end - start) / STEP - 0.5 * shorter[d], 1e-6);
  }
}

BOOST_AUTO_TEST_CASE(what_is_flat_stays_finite)
{
  const Vec3 level(0.9, 0.2, 0.5);
  const Vec3 shorter = shortening(P, level, Vec3::UnitZ(), Vec3::UnitX());
  BOOST_CHECK(shorter.norm() < 25.0);
  BOOST_CHECK(along_contour(P, level, Vec3(0.5, 0.9, 0.5), Vec3::UnitZ()) == Vec3::Zero());
}

BOOST_AUTO_TEST_SUITE_END()
