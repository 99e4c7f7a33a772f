// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pbd/cloth_solver.h"

#include <boost/test/unit_test.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>

using namespace sphcloth;

namespace {

constexpr double FREE = std::numeric_limits<double>::infinity();
using Corners = std::array<Vec3, 4>;

// a hinge without symmetry: wing a, the edge, wing b
Corners hinge(double size = 1.0)
{
  Corners x{Vec3(0.3, 0.9, 0.1), Vec3(0.0, 0.1, -0.2), Vec3(1.1, 0.0, 0.2), Vec3(0.7, -0.8, 0.5)};
  for (Vec3 &v : x) v *= size;
  return x;
}

double angle_of(const Corners &x) { return hinge_angle(x[0], x[1], x[2], x[3]); }

template <std::size_t N>
std::array<Vertex, N + 1> vertices(const std::array<Vec3, N> &x, const std::array<double, N> &w)
{
  std::array<Vertex, N + 1> p{};    // the last one is idle
  for (std::size_t q = 0; q < N; q++) p[q] = {x[q][0], x[q][1], x[q][2], w[q]};
  return p;
}

template <std::size_t N> Constraints<N> alone(const Spring &spring)
{
  Constraints<N> c;
  c.clear(1, N);
  std::array<int, N> slots;
  for (std::size_t q = 0; q < N; q++) slots[q] = static_cast<int>(q);
  c.add(slots, spring);
  c.close_color();
  return c;
}

// angle minus rest angle, after one projection that may take a part of the error

double error_after(const Corners &x, double rest, double share)
{
  const std::array<double, 4> w{1.0, 3.0, 0.5, 2.0};
  Constraints<4> c = alone<4>({rest, 1.0, 0.0, FREE});
  const auto start = vertices<4>(x, w);
  auto displacement = start;
  for (Vertex &v : displacement) v.x = v.y = v.z = 0.0;
  ClothState state{start.data(), displacement.data(), false, nullptr, 1.0};
  state.max_hinge_share = share;
  project(c, 0, state);
  Corners after = x;
  for (int q = 0; q < 4; q++)
    after[q] += Vec3(displacement[q].x, displacement[q].y, displacement[q].z);
  return angle_of(after) - rest;
}

// forces on held vertices by vertex, with a multiplier of 1

template <std::size_t N>
std::map<int, Vec3> held(const std::array<Vec3, N> &x, const std::array<double, N> &w)
{
  Constraints<N> c = alone<N>({0.0, 1.0, 0.0, FREE});
  c.lambda[0] = 1.0;
  const auto p = vertices<N>(x, w);
  std::map<int, Vec3> force;
  for_each_held(c, p.data(), nullptr, [&](int q, const Vec3 &f) {
    BOOST_CHECK(force.emplace(q, f).second);
  });
  return force;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(cloth_solver)

// Newton's method: what is left is of the second order.

BOOST_AUTO_TEST_CASE(a_projection_of_a_hinge_takes_a_small_error_whole)
{
  constexpr double ERROR = 1e-5;
  BOOST_CHECK_SMALL(error_after(hinge(), angle_of(hinge()) - ERROR, 1.0), 1e-8);
}

BOOST_AUTO_TEST_CASE(a_projection_of_a_hinge_takes_no_more_than_its_share)
{
  constexpr double ERROR = 1e-5;
  for (double share : {0.25, 0.5})
    BOOST_CHECK_SMALL(error_after(hinge(), angle_of(hinge()) - ERROR, share) -
                          (1.0 - share) * ERROR, 1e-8);
}

BOOST_AUTO_TEST_CASE(a_hinge_of_any_size_has_its_angle)
{
  for (double size : {1e-9, 1e-5, 1e5, 1e9}) {
    BOOST_CHECK_SMALL(angle_of(hinge(size)) - angle_of(hinge()), 1e-14);
    BOOST_CHECK_SMALL(error_after(hinge(size), angle_of(hinge()) - 1e-5, 1.0), 1e-8);
  }
  for (double size : {1e-5, 1.0, 1e5}) {    // one wing a billion times thinner than long
    Corners thin = hinge(size);
    thin[0] = 0.5 * (thin[1] + thin[2]) + 1e-9 * (thin[0] - thin[1]);
    BOOST_CHECK(std::isnan(angle_of(thin)));
  }
}

BOOST_AUTO_TEST_CASE(forces_of_a_hinge_on_held_vertices_are_the_slope_of_its_angle)
{
  const Corners x = hinge();
  const std::map<int, Vec3> force = held<4>(x, {0.0, 0.0, 0.0, 0.0});
  BOOST_REQUIRE(force.size() == 4);
  for (int q = 0; q < 4; q++)
    for (int d = 0; d < 3; d++) {
      constexpr double STEP = 1e-6;
      Corners hi = x, lo = x;
      hi[q][d] += STEP;
      lo[q][d] -= STEP;
      BOOST_CHECK_SMALL(force.at(q)[d] - (angle_of(hi) - angle_of(lo)) / (2.0 * STEP), 1e-8);
    }
  const std::map<int, Vec3> of_one = held<4>(x, {1.0, 0.0, 2.0, 3.0});
  BOOST_CHECK(of_one.size() == 1 && of_one.at(1) == force.at(1));
  BOOST_CHECK(held<4>(x, {1.0, 1.0, 1.0, 1.0}).empty());
}

BOOST_AUTO_TEST_CASE(forces_of_an_edge_act_on_its_held_ends_and_are_opposite)
{
  const std::array<Vec3, 2> x{Vec3(1.0, 2.0, 3.0), Vec3(1.0, 6.0, 0.0)};
  const Vec3 pull(0.0, -0.8, 0.6);    // from the second end to the first
  const std::map<int, Vec3> both = held<2>(x, {0.0, 0.0});
  BOOST_REQUIRE(both.size() == 2);
  BOOST_CHECK_SMALL((both.at(0) - pull).norm(), 1e-15);
  BOOST_CHECK_SMALL((both.at(1) + pull).norm(), 1e-15);
  const std::map<int, Vec3> first = held<2>(x, {0.0, 1.0}), second = held<2>(x, {1.0, 0.0});
  BOOST_CHECK(first.size() == 1 && first.at(0) == both.at(0));
  BOOST_CHECK(second.size() == 1 && second.at(1) == both.at(1));
  BOOST_CHECK(held<2>(x, {1.0, 1.0}).empty());
}

BOOST_AUTO_TEST_CASE(constraints_that_are_made_anew_have_the_stiffness_of_the_reference)
{
  constexpr double K = 0.3, RATIO = 0.25;
  Constraints<2> c = alone<2>({1.0, K, 0.0, FREE});
  c.rescale_stiffness(RATIO);
  const double rescaled = c.k[0];
  BOOST_CHECK(rescaled > K);
  c.clear(1, 2);
  c.add({0, 1}, {1.0, K, 0.0, FREE});
  c.close_color();
  BOOST_CHECK(c.k[0] == K);
  c.rescale_stiffness(RATIO);
  BOOST_CHECK(c.k[0] == rescaled);
}

BOOST_AUTO_TEST_SUITE_END()
