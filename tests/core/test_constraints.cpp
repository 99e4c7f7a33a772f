// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pbd/cloth_solver.h"

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "core/pbd/constraint_errors.h"

using namespace sphcloth;

namespace {

std::mt19937 generator(7);

Vec3 random_vec()
{
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  return {u(generator), u(generator), u(generator)};
}

// a hinge of the given angle between two triangles at the edge (0,0,0) - (1,0,0)
std::array<Vec3, 4> folded(double angle)
{
  return {Vec3(0.4, 0.9, 0.0), Vec3(0.0, 0.0, 0.0), Vec3(1.0, 0.0, 0.0),
          Vec3(0.6, -0.8 * std::cos(angle), 0.8 * std::sin(angle))};
}

Vec3 position(const Vertex &v) { return {v.x, v.y, v.z}; }

constexpr double FREE = std::numeric_limits<double>::infinity();

// one constraint alone

template <std::size_t N> struct Alone {
  Constraints<N> c;
  std::array<Vertex, N + 1> p, start, displacement,
      change;    // p: after the sweeps, from there the next ones go on
  bool along_start = false;

  Alone(const std::array<Vec3, N> &x, const std::array<double, N> &w, const Spring &spring)
  {
    std::array<int, N> slots;
    for (std::size_t q = 0; q < N; q++) {
      slots[q] = static_cast<int>(q);
      p[q] = {x[q][0], x[q][1], x[q][2], w[q]};
    }
    start = p;
    c.clear(1, N);
    c.add(slots, spring);
    c.close_color();
  }
  void sweep(int n = 1)
  {
    for (std::size_t q = 0; q < N; q++)
      displacement[q] = {p[q].x - start[q].x, p[q].y - start[q].y, p[q].z - start[q].z, p[q].w};
    for (int k = 0; k < n; k++)
      project(c, 0, {start.data(), displacement.data(), along_start, nullptr, 1.0});
    for (std::size_t q = 0; q < N; q++)
      p[q] = {start[q].x + displacement[q].x, start[q].y + displacement[q].y,
              start[q].z + displacement[q].z, p[q].w};
  }
};

void project_distance(Vec3 &a, Vec3 &b, double wa, double wb, double rest, double k)
{
  Alone<2> one({a, b}, {wa, wb}, {rest, k, 0.0, FREE});
  one.sweep();
  a = position(one.p[0]);
  b = position(one.p[1]);
}

void project_hinge(std::array<Vec3, 4> &x, const std::array<double, 4> &w, double rest, double k)
{
  Alone<4> one(x, w, {rest, k, 0.0, FREE});
  one.sweep();
  for (int q = 0; q < 4; q++) x[q] = position(one.p[q]);
}

// the gradient of a hinge's angle, from what a small step of it moves

std::array<Vec3, 4> gradient(const std::array<Vec3, 4> &x)
{
  const Vec3 u = x[0] - x[1], e = x[2] - x[1], v = x[3] - x[1];
  const HingeShape h = hinge_shape(u[0], u[1], u[2], e[0], e[1], e[2], v[0], v[1], v[2]);
  const Vec3 a(h.ax, h.ay, h.az), b(h.bx, h.by, h.bz);
  const Vec3 e2 = -(h.a2 * a + h.b2 * b);
  return {a, -(a + b + e2), e2, b};
}

double angle_of(const std::array<Vec3, 4> &x) { return hinge_angle(x[0], x[1], x[2], x[3]); }

}    // namespace

BOOST_AUTO_TEST_SUITE(constraints)

BOOST_AUTO_TEST_CASE(stiffness_per_iteration_of_equation_9)
{
  for (int n : {1, 2, 7, 1000})
    for (double k : {1e-12, 0.3, 0.999})
      BOOST_CHECK_SMALL(std::pow(1.0 - stiffness_per_iteration(k, n), n) - (1.0 - k), 1e-12);
  BOOST_CHECK(stiffness_per_iteration(0.0, 10) == 0.0);
  BOOST_CHECK(stiffness_per_iteration(1.0, 10) == 1.0);
  BOOST_CHECK(stiffness_per_iteration(0.3, 1) == 0.3 ||
              std::fabs(stiffness_per_iteration(0.3, 1) - 0.3) < 1e-16);
}

BOOST_AUTO_TEST_CASE(distance_is_exact_and_keeps_momentum_and_pins)
{
  for (int trial = 0; trial < 100; trial++) {
    const Vec3 a0 = random_vec(), b0 = random_vec();
    const double wa = 0.5, wb = 3.0;
    Vec3 a = a0, b = b0;
    project_distance(a, b, wa, wb, 0.7, 1.0);
    BOOST_CHECK_SMALL((a - b).norm() - 0.7, 1e-14);
    BOOST_CHECK_SMALL(((a - a0) / wa + (b - b0) / wb).norm(), 1e-14);
    BOOST_CHECK_SMALL((a0.cross(a - a0) / wa + b0.cross(b - b0) / wb).norm(), 1e-13);
  }
  Vec3 a(0, 0, 0), b(2, 0, 0);
  project_distance(a, b, 0.0, 1.0, 1.0, 1.0);
  BOOST_CHECK(a == Vec3(0, 0, 0) && b == Vec3(1, 0, 0));
}

BOOST_AUTO_TEST_CASE(distance_without_stiffness_or_direction_moves_nothing)
{
  const Vec3 a0 = random_vec(), b0 = random_vec();
  Vec3 a = a0, b = b0;
  project_distance(a, b, 1.0, 2.0, 0.7, 0.0);
  BOOST_CHECK(a == a0 && b == b0);
  b = a;
  project_distance(a, b, 1.0, 1.0, 0.7, 1.0);
  BOOST_CHECK(a == a0 && b == a0);
  b = b0;
  project_distance(a, b, 0.0, 0.0, 0.7, 1.0);
  BOOST_CHECK(a == a0 && b == b0);
}

BOOST_AUTO_TEST_CASE(hinge_angle_has_a_sign_and_every_digit_near_flat)
{
  for (double angle : {-2.6, -1.0, -1e-10, 0.0, 1e-12, 0.5, 2.6}) {
    const auto x = folded(angle);
    BOOST_CHECK_SMALL(std::fabs(angle_of(x)) - std::fabs(angle), 1e-12 * std::fabs(angle) + 1e-17);
    BOOST_CHECK_SMALL(angle_of({x[3], x[2], x[1], x[0]}) - angle_of(x), 1e-15);
  }
  BOOST_CHECK(angle_of(folded(0.3)) * angle_of(folded(-0.3)) < 0.0);
}

BOOST_AUTO_TEST_CASE(hinge_gradients_are_finite_differences_without_net_force_or_torque)
{
  for (int trial = 0; trial < 100; trial++) {
    std::array<Vec3, 4> x = folded(trial % 2 ? 0.0 : -2.4 + 0.05 * trial);
    for (Vec3 &v : x) v += 0.1 * random_vec();
    const std::array<Vec3, 4> grad = gradient(x);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (int i = 0; i < 4; i++) {
      force += grad[i];
      torque += x[i].cross(grad[i]);
      for (int d = 0; d < 3; d++) {
        const double step = 1e-6;
        auto hi = x, lo = x;
        hi[i][d] += step;
        lo[i][d] -= step;
        const double slope = angle_difference(angle_of(hi), angle_of(lo)) / (2.0 * step);
        BOOST_CHECK_SMALL(grad[i][d] - slope, 1e-7);
      }
    }
    BOOST_CHECK_SMALL(force.norm(), 1e-12);
    BOOST_CHECK_SMALL(torque.norm(), 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(hinge_reaches_rest_angles_from_minus_150_to_150_degrees)
{
  for (double degrees : {-150.0, -90.0, -10.0, 0.0, 30.0, 120.0, 150.0}) {
    const double rest = degrees * PI / 180.0;
    std::array<Vec3, 4> x = folded(0.2);
    for (int n = 0; n < 200; n++) project_hinge(x, {1.0, 2.0, 1.0, 0.5}, rest, 1.0);
    BOOST_CHECK_SMALL(angle_of(x) - rest, 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(difference_of_angles_across_180_degrees)
{
  BOOST_CHECK_SMALL(angle_difference(-3.0, 3.0) - (2.0 * PI - 6.0), 1e-15);
  BOOST_CHECK_SMALL(angle_difference(3.0, -3.0) - (6.0 - 2.0 * PI), 1e-15);
  BOOST_CHECK(angle_difference(1.0, -1.0) == 2.0);
}

BOOST_AUTO_TEST_CASE(hinge_leaves_degenerate_triangles_alone)
{
  std::array<Vec3, 4> x = folded(0.3);
  x[0] = Vec3(0.5, 0.0, 0.0);    // on the edge
  const auto before = x;
  project_hinge(x, {1.0, 1.0, 1.0, 1.0}, 0.0, 1.0);
  BOOST_CHECK(x == before);
}

BOOST_AUTO_TEST_CASE(hinge_with_an_edge_of_the_size_of_rounding_keeps_momentum)
{
  const std::array<double, 4> w{2.0, 0.5, 1.0, 1.5};
  for (int trial = 0; trial < 1000; trial++) {
    const Vec3 wing = random_vec();
    std::array<Vec3, 4> x = {wing, 1e-16 * random_vec(), 1e-16 * random_vec(),
                             wing + 1e-16 * random_vec()};
    const auto before = x;
    project_hinge(x, w, 0.0, 1.0);
    Vec3 given = Vec3::Zero();
    double moved = 1.0;
    for (int q = 0; q < 4; q++) {
      given += (x[q] - before[q]) / w[q];
      moved = std::max(moved, (x[q] - before[q]).norm() / w[q]);
    }
    BOOST_CHECK_SMALL(given.norm(), 1e-14 * moved);
  }
}

BOOST_AUTO_TEST_CASE(hinge_is_finite_down_to_the_smallest_numbers)
{
  for (double edge : {1.0, 1e-80, 1e-120, 1e-156, 1e-160, 1e-170, 1e-320})
    for (double wing : {1.0, 1e-80, 1e-120, 1e-156, 1e-160, 1e-170, 1e-320}) {
      std::array<Vec3, 4> x = {wing * random_vec(), Vec3::Zero(), edge * random_vec(),
                               wing * random_vec()};
      project_hinge(x, {1e3, 1.0, 1e-3, 0.0}, 0.5, 1.0);
      for (const Vec3 &v : x) BOOST_CHECK(v.allFinite());
      x[0] = Vec3(1.0, 2.0, 3.0);
      project_hinge(x, {1e3, 1.0, 1e-3, 1.0}, 0.5, 1.0);
      for (const Vec3 &v : x) BOOST_CHECK(v.allFinite());
    }
}

BOOST_AUTO_TEST_CASE(hinge_moves_no_vertex_without_lever_far)
{
  // right angles at e1: moving e1 does not turn the hinge to first order
  std::array<Vec3, 4> x = {Vec3(1e-17, 1, 1e-3), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, -1, 0)};
  const Vec3 before = x[2];
  project_hinge(x, {0.0, 0.0, 1.0, 0.0}, 0.0, 1.0);
  BOOST_CHECK((x[2] - before).norm() < 0.1);
}

BOOST_AUTO_TEST_CASE(arc_tangent_in_all_quadrants_near_zero_and_on_the_axes)
{
  for (int trial = 0; trial < 2000; trial++) {
    const Vec3 r = random_vec();
    const double x = trial % 3 ? r[0] : r[0] * 1e-9, y = trial % 5 ? r[1] : r[1] * 1e-9;
    BOOST_CHECK_SMALL(arc_tangent(y, x) - std::atan2(y, x), 5e-16 * std::fabs(std::atan2(y, x)));
  }
  for (double x : {-1.0, 0.0, 1.0})
    for (double y : {-1.0, 0.0, 1.0})
      BOOST_CHECK_SMALL(arc_tangent(y, x) - std::atan2(y, x), 1e-16);
  BOOST_CHECK(arc_tangent(1e-300, 1.0) == 1e-300);
}

BOOST_AUTO_TEST_CASE(compliant_multiplier_is_the_force_after_any_number_of_sweeps)
{
  // one end held: compliance times force = stretch, force = what moves the other end
  const double a = 0.02, w = 4.0;
  for (int sweeps : {1, 2, 50}) {
    Alone<2> one({Vec3(0, 0, 0), Vec3(1.3, 0, 0)}, {0.0, w}, {1.0, 1.0, a, FREE});
    one.sweep(sweeps);
    const double stretch = one.p[1].x - 1.0;
    BOOST_CHECK_SMALL(stretch - 0.3 * a / (w + a), 1e-15);
    BOOST_CHECK_SMALL(one.c.lambda[0] + stretch / a, 1e-13);
    BOOST_CHECK_SMALL(residual(one.c, one.p.data(), 1.0, 1.0), 1e-15);
    BOOST_CHECK_SMALL(elastic_energy(one.c, one.p.data(), 2) - 0.5 * stretch * stretch / a, 1e-15);
  }
}

BOOST_AUTO_TEST_CASE(tension_only_is_slack_in_compression_and_exact_in_tension)
{
  for (double compliance : {0.0, 0.1}) {
    Alone<2> slack({Vec3(0, 0, 0), Vec3(0.8, 0, 0)}, {1.0, 1.0}, {1.0, 1.0, compliance, 0.0});
    slack.sweep(5);
    BOOST_CHECK(slack.p[0].x == 0.0 && slack.p[1].x == 0.8 && slack.c.lambda[0] == 0.0);
    BOOST_CHECK(residual(slack.c, slack.p.data(), 1.0, 1.0) == 0.0);
    Alone<2> both({Vec3(0, 0, 0), Vec3(1.2, 0, 0)}, {1.0, 1.0}, {1.0, 1.0, compliance, 0.0});
    Alone<2> same({Vec3(0, 0, 0), Vec3(1.2, 0, 0)}, {1.0, 1.0}, {1.0, 1.0, compliance, FREE});
    both.sweep(5);
    same.sweep(5);
    BOOST_CHECK(both.p[1].x == same.p[1].x);
  }
  // pulled too far and pushed back by something else, it gives back what it did, and no more
  Alone<2> one({Vec3(0, 0, 0), Vec3(1.2, 0, 0)}, {0.0, 1.0}, {1.0, 1.0, 0.0, 0.0});
  one.sweep();
  BOOST_CHECK(one.c.lambda[0] < 0.0);
  one.p[1].x = 0.5;
  one.sweep();
  BOOST_CHECK(one.c.lambda[0] == 0.0);
  BOOST_CHECK_SMALL(one.p[1].x - 0.7, 1e-15);
}

BOOST_AUTO_TEST_CASE(along_the_first_edge_is_exact_and_keeps_angular_momentum)
{
  const std::array<Vec3, 2> before{Vec3(0, 0, 0), Vec3(1, 0, 0)};
  for (double turn : {0.0, 0.3, 0.9, 1.0, 1.1, 2.0}) {
    const Vec3 end = 1.1 * Vec3(std::cos(turn), std::sin(turn), 0.1);
    Alone<2> one(before, {1.0, 2.0}, {1.0, 1.0, 0.0, FREE});
    one.p[1] = {end[0], end[1], end[2], 2.0};
    one.along_start = true;
    one.sweep();
    const Vec3 moved = position(one.p[0]);
    const bool along = std::cos(turn) / std::sqrt(1.01) >= 0.5;
    BOOST_CHECK((moved.cross(before[1]).norm() < 1e-15) == (along || turn == 0.0));
    if (!along) BOOST_CHECK(moved.cross(end).norm() < 1e-15);
    BOOST_CHECK_SMALL((moved + 0.5 * (position(one.p[1]) - end)).norm(), 1e-15);
    one.sweep(20);
    BOOST_CHECK_SMALL((position(one.p[1]) - position(one.p[0])).norm() - 1.0, 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(jacobi_sweep_adds_up_and_agrees_with_gauss_seidel_for_one)
{
  const std::array<Vec3, 2> x{Vec3(0, 0, 0), Vec3(1.4, 0.2, 0)};
  Alone<2> direct(x, {1.0, 3.0}, {1.0, 1.0, 0.0, FREE}), summed = direct;
  direct.sweep();
  for (int q = 0; q < 2; q++) summed.displacement[q].w = summed.p[q].w;
  project(summed.c, 0,
          {summed.p.data(), summed.displacement.data(), false, summed.change.data(), 1.0});
  for (int q = 0; q < 2; q++) {
    BOOST_CHECK(position(summed.displacement[q]) == Vec3(0, 0, 0));
    BOOST_CHECK_SMALL((x[q] + position(summed.change[q]) - position(direct.p[q])).norm(), 1e-15);
  }
}

BOOST_AUTO_TEST_CASE(place_in_a_group_does_not_matter_and_groups_are_filled_up)
{
  Vertices p(15);
  for (int i = 0; i < 14; i++) {
    const Vec3 r = random_vec();
    p[i] = {r[0], r[1], r[2], 0.5 + 0.1 * i};
  }
  Vertices displacement(15);
  for (int i = 0; i < 14; i++) displacement[i].w = p[i].w;
  Constraints<2> c;
  c.clear(2, 14);
  for (int m = 0; m < 7; m++) c.add({2 * m, 2 * m + 1}, {0.6, 1.0, 1e-3, FREE});
  c.close_color();
  c.add({0, 13}, {0.6, 1.0, 0.0, FREE});
  c.close_color();
  BOOST_CHECK(c.size() == 2 * CONSTRAINT_GROUP && c.colors() == 2 &&
              c.begin[1] == CONSTRAINT_GROUP);
  project(c, 0, {p.data(), displacement.data(), false, nullptr, 1.0});
  for (int m = 0; m < 7; m++) {
    Alone<2> one({position(p[2 * m]), position(p[2 * m + 1])}, {p[2 * m].w, p[2 * m + 1].w},
                 {0.6, 1.0, 1e-3, FREE});
    one.sweep();
    BOOST_CHECK(position(one.displacement[0]) == position(displacement[2 * m]) &&
                position(one.displacement[1]) == position(displacement[2 * m + 1]));
  }
  BOOST_CHECK(displacement[14].x == 0.0 && displacement[14].y == 0.0 && displacement[14].z == 0.0);
}

BOOST_AUTO_TEST_CASE(rescaled_stiffness_is_a_compliance_in_any_step_and_comes_back)
{
  const std::array<Vec3, 2> x{random_vec(), random_vec()};
  const double k = 0.3, weight = 2.5, rest = 0.1;
  Alone<2> kept(x, {0.5, 2.0}, {rest, k, 0.0, FREE});
  for (double ratio : {16.0, 1.0, 0.25}) {
    // one projection by k/(k + (1 - k) ratio) is one with a = W (1 - k)/k ratio
    Alone<2> one = kept,
             compliant(x, {0.5, 2.0}, {rest, 1.0, weight * (1.0 - k) / k * ratio, FREE});
    one.c.rescale_stiffness(ratio);
    one.sweep();
    compliant.sweep();
    BOOST_CHECK_SMALL((position(one.p[0]) - position(compliant.p[0])).norm(), 1e-15);
  }
  kept.c.rescale_stiffness(7.0);
  BOOST_CHECK(kept.c.k[0] < k);
  kept.c.rescale_stiffness(1.0);
  BOOST_CHECK(kept.c.k[0] == k);
  Alone<2> rigid(x, {0.5, 2.0}, {rest, 1.0, 0.0, FREE});
  rigid.c.rescale_stiffness(100.0);
  BOOST_CHECK(rigid.c.k[0] == 1.0);
}

BOOST_AUTO_TEST_CASE(edge_damping_takes_stretching_and_keeps_momentum_and_rigid_motion)
{
  Alone<2> edge({random_vec(), random_vec()}, {0.5, 2.0}, {1.0, 1.0, 0.0, FREE});
  const Vec3 along = position(edge.p[0]) - position(edge.p[1]);
  const Vec3 v1 = random_vec(), v2 = random_vec();
  std::array<Vertex, 3> v{Vertex{v1[0], v1[1], v1[2], 0.5}, Vertex{v2[0], v2[1], v2[2], 2.0}};
  damp(edge.c, 0, edge.p.data(), v.data(), 1.0);
  BOOST_CHECK_SMALL((position(v[0]) - position(v[1])).dot(along), 1e-14);
  BOOST_CHECK_SMALL((position(v[0]) / 0.5 + position(v[1]) / 2.0 - v1 / 0.5 - v2 / 2.0).norm(),
                    1e-14);
  v[0] = {0.0, 0.0, -3.0, 0.5};
  v[1] = {0.0, 0.0, -3.0, 2.0};
  damp(edge.c, 0, edge.p.data(), v.data(), 0.7);
  for (int q = 0; q < 2; q++) BOOST_CHECK(position(v[q]) == Vec3(0.0, 0.0, -3.0));
}

BOOST_AUTO_TEST_CASE(edge_damping_is_finite_down_to_the_smallest_numbers)
{
  for (double length : {1e-80, 1e-156, 1e-161, 1e-162, 1e-170, 1e-320})
    for (double w : {1e-3, 1.0, 1e3}) {
      Alone<2> edge({length * Vec3(1.0, 1.0, 1.0), Vec3::Zero()}, {w, w}, {1.0, 1.0, 0.0, FREE});
      std::array<Vertex, 3> v{Vertex{1.0, 2.0, 3.0, w}, Vertex{-1.0, 0.5, 2.0, w}};
      damp(edge.c, 0, edge.p.data(), v.data(), 1.0);
      for (int q = 0; q < 2; q++)
        BOOST_CHECK(position(v[q]).allFinite() && position(v[q]).norm() < 10.0);
    }
}

BOOST_AUTO_TEST_SUITE_END()
