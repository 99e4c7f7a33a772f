// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pbd/cloth_solver.h"

#include <boost/test/unit_test.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "core/pbd/constraint_errors.h"

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

template <std::size_t N> Constraints<N> alone(const Spring &spring, double size = 1.0)
{
  Constraints<N> c;
  c.clear(1, N);
  std::array<int, N> slots;
  for (std::size_t q = 0; q < N; q++) slots[q] = static_cast<int>(q);
  c.add(slots, spring, 1.0, size);
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

// of an edge of the length 1.1 in place of 1: part of its error that one projection leaves

double left_of_edge(const Spring &spring, ClothState state)
{
  const std::array<Vec3, 2> x{Vec3(0.0, 0.0, 0.0), Vec3(1.1, 0.0, 0.0)};
  Constraints<2> c = alone<2>(spring);
  const auto start = vertices<2>(x, {1.0, 3.0});
  auto displacement = start;
  for (Vertex &v : displacement) v.x = v.y = v.z = 0.0;
  state.start = start.data();
  state.displacement = displacement.data();
  state.inv_dt_sq = 1.0;
  project(c, 0, state);
  return (1.1 + displacement[1].x - displacement[0].x - 1.0) / 0.1;
}

// forces on held vertices by vertex, with a multiplier of 1

template <std::size_t N>
std::map<int, Vec3> held(const std::array<Vec3, N> &x, const std::array<double, N> &w)
{
  Constraints<N> c = alone<N>({0.0, 1.0, 0.0, FREE});
  c.lambda[0] = 1.0;
  const auto p = vertices<N>(x, w);
  std::map<int, Vec3> force;
  for_each_held(c, p.data(), nullptr,
                [&](int q, const Vec3 &f) { BOOST_CHECK(force.emplace(q, f).second); });
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
    BOOST_CHECK_SMALL(
        error_after(hinge(), angle_of(hinge()) - ERROR, share) - (1.0 - share) * ERROR, 1e-8);
}

// W = 4: what is left is a/(W + a), a the compliance that the edge has in the projection

BOOST_AUTO_TEST_CASE(an_edge_takes_no_more_than_its_share_and_is_as_soft_as_in_a_longer_substep)
{
  const auto with = [](double share, double ratio) {
    ClothState state;
    state.max_edge_share = share;
    state.longest_sq = ratio;
    return state;
  };
  const auto left = [](double a) { return a / (4.0 + a); };
  const auto close = boost::test_tools::tolerance(1e-12);
  const Spring rigid{1.0, 1.0, 0.0, FREE}, soft{1.0, 1.0, 6.0, FREE}, k{1.0, 0.3, 0.0, FREE},
      stiff{1.0, 0.95, 0.0, FREE};
  BOOST_CHECK_SMALL(left_of_edge(rigid, with(1.0, 1.0)), 1e-12);
  BOOST_TEST(left_of_edge(rigid, with(0.8, 1.0)) == 0.2, close);
  // W/4 and W/2 of h^2, in a substep of half the length
  BOOST_TEST(left_of_edge(rigid, with(0.8, 4.0)) == left(4.0 * 4.0 / 4 + 3.0 * 4.0 / 2), close);
  BOOST_TEST(left_of_edge(rigid, with(1.0, 4.0)) == left(3.0 * 4.0 / 2), close);
  // a compliance that is softer than the share stays what it is
  BOOST_TEST(left_of_edge(soft, with(0.8, 1.0)) == left(6.0), close);
  BOOST_TEST(left_of_edge(soft, with(0.8, 4.0)) == left(6.0 + 3.0 * 4.0 / 2), close);
  // a k below 1 has a reference of its own, and the same share
  BOOST_TEST(left_of_edge(k, with(0.8, 4.0)) == 0.7, close);
  BOOST_TEST(left_of_edge(stiff, with(0.8, 1.0)) == 0.2, close);
}

BOOST_AUTO_TEST_CASE(a_load_hardens_its_constraint)
{
  constexpr double INV_DT_SQ = 4.0, STRAIN = 0.01, LENGTH = 0.2, LONGEST_SQ = 9.0, SOFTEST = 0.75;
  constexpr double UNLOADED = SOFTEST * 4.0 * LONGEST_SQ;
  const auto close = boost::test_tools::tolerance(1e-3);
  const auto vertex = vertices<2>({Vec3(0, 0, 0), Vec3(1, 0, 0)}, {1.0, 3.0});
  const auto of_edge = [&](double size, double compliance, double force, double strain = 0.01) {
    Constraints<2> c;
    c.clear(1, 2);
    c.add({0, 1}, {1.0, 1.0, compliance, FREE}, 1.0, size);
    c.close_color();
    c.weigh(vertex.data());
    c.lambda[0] = -force / INV_DT_SQ;
    return solver_error(c, {INV_DT_SQ, LONGEST_SQ, strain, SOFTEST});
  };
  for (const double y : {0.01, 0.3, 0.9, 1.5}) {
    const double root = 1.0 + 9.0 * std::pow(y, 4),
                 force = y * root * root * STRAIN * LENGTH / UNLOADED;
    BOOST_TEST(of_edge(LENGTH, 0.0, force).hardest == 1.0 / (root * root), close);
    BOOST_TEST(of_edge(LENGTH, 0.0, force).largest == y * STRAIN, close);
  }
  // no more from 1.6 of the strain on
  const double hardest = 1.0 + 9.0 * std::pow(1.6, 4);
  BOOST_TEST(of_edge(LENGTH, 0.0, 1e9).hardest == 1.0 / (hardest * hardest), close);
  // W h^2/2 is a tenth of a compliance, if that is longer
  const double floor = 0.1 * 0.5 / (0.5 * 4.0 * LONGEST_SQ);
  BOOST_TEST(of_edge(LENGTH, 0.5, 1e9).hardest == floor, close);
  BOOST_TEST(of_edge(LENGTH, 0.5, 0.0).hardest == 1.0, close);
  // no load says anything of what has no size
  BOOST_TEST(of_edge(0.0, 0.5, 1e9).hardest == 1.0);
  BOOST_TEST(of_edge(0.0, 0.5, 1e9).largest == 0.0);
  // no strain is asked for
  BOOST_TEST(of_edge(LENGTH, 0.0, 1e9, 0.0).hardest == 1.0);
  BOOST_TEST(of_edge(LENGTH, 0.0, 2.0, 0.0).largest == UNLOADED * 2.0 / LENGTH, close);

  Constraints<4> hinge;
  hinge.clear(1, 4);
  hinge.add({0, 1, 2, 3}, {0.0, 1.0, 0.0, FREE}, 1.0, 1.0, 2.5);
  hinge.close_color();
  const auto corners = vertices<4>(::hinge(), {1.0, 3.0, 0.5, 2.0});
  hinge.weigh(corners.data());
  hinge.lambda[0] = 1e-9 / INV_DT_SQ;
  BOOST_TEST(solver_error(hinge, {INV_DT_SQ, LONGEST_SQ, STRAIN, SOFTEST}).largest ==
                 SOFTEST * 2.5 * 6.5 * LONGEST_SQ * 1e-9,
             close);
}

// Its substeps follow from its compliance alone: what edges beside it may be strained by changes
// nothing.

BOOST_AUTO_TEST_CASE(an_edge_without_a_size_is_as_soft_under_any_load)
{
  constexpr double SHARE = 0.02;
  const auto close = boost::test_tools::tolerance(1e-12);
  const auto vertex = vertices<2>({Vec3(0, 0, 0), Vec3(1, 0, 0)}, {1.0, 3.0});
  Constraints<2> c;
  c.clear(1, 2);
  for (const double compliance : {2.0, 0.5, 8.0}) c.add({0, 1}, {0, 1, compliance, FREE}, 1.0, 0.0);
  c.add({0, 1}, {1.0, 1.0, 0.1, FREE}, 1.0, 1.0);
  c.add({0, 2}, {1.0, 1.0, 0.1, FREE}, 1.0, 0.0, 0.0);
  c.close_color();
  c.weigh(vertex.data());
  BOOST_TEST(c.min_compliance_per_weight(true) == 0.5 / 4.0, close);

  for (const double error : {1e-3, 1.0, 1e3})
    for (const double allowed : {0.01, 1.28}) {
      auto ends = vertices<2>({Vec3(0, 0, 0), Vec3(error, 0, 0)}, {0.0, 1.0});
      Constraints<2> edge = alone<2>({0.0, 1.0, 100.0, FREE}, 0.0);
      auto displacement = ends;
      for (Vertex &v : displacement) v.x = v.y = v.z = 0.0;
      ClothState state{ends.data(), displacement.data(), true, nullptr, 1.0};
      state.longest_sq = 1e6;
      state.max_edge_share = 0.8;
      state.max_edge_error = allowed;
      state.without_size = SHARE;
      project(edge, 0, state);
      // its compliance, and half of what 4 percent of it are more than W
      BOOST_TEST(-displacement[1].x == error / (1.0 + 100.0 + 0.5 * (4.0 - 1.0)), close);
    }
}

// Most of many constraints are passed over: none that is harder, or has a larger error.

BOOST_AUTO_TEST_CASE(the_hardest_of_many_constraints_is_found)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-3.0, 3.0), share(0.0, 1.0);
  const auto vertex = vertices<2>({Vec3(0, 0, 0), Vec3(1, 0, 0)}, {1.0, 3.0});
  for (const double allowed : {0.0, 0.01})
    for (int repeat = 0; repeat < 200; repeat++) {
      const LoadedSolver solver{4.0, 9.0, allowed, 0.75};
      Constraints<2> c;
      c.clear(1, 2);
      for (int m = 0; m < 30; m++) {
        const double compliance = share(random) < 0.5 ? 0.0 : std::pow(10.0, exponent(random));
        c.add({0, 1}, {1.0, 1.0, compliance, FREE}, 1.0, share(random) < 0.2 ? 0.0 : 0.2);
      }
      c.close_color();
      c.weigh(vertex.data());
      SolverError all;
      for (int m = 0; m < 30; m++) {
        c.lambda[m] = 1e-4 * std::pow(10.0, exponent(random));
        all.join(solver.of(c.lambda[m] * 4.0, c.weight[m], c.compliance[m], c.per_size[m]));
      }
      const SolverError found = solver_error(c, solver);
      BOOST_TEST(found.hardest == all.hardest, boost::test_tools::tolerance(1e-6));
      BOOST_TEST(found.largest == all.largest, boost::test_tools::tolerance(1e-6));
    }
}

// Pulled slowly by a force and let go, in substeps that are ever other ones, an edge returns no
// more than was put in.

BOOST_AUTO_TEST_CASE(an_edge_that_hardens_returns_no_more_than_it_took)
{
  constexpr double LONGEST = 1e-3, MASS = 2.0, ALLOWED = 0.01, SHARE = 0.8;
  Constraints<2> c = alone<2>({1.0, 1.0, 0.0, FREE});
  auto start = vertices<2>({Vec3(0, 0, 0), Vec3(1, 0, 0)}, {0.0, 1.0 / MASS});
  c.weigh(start.data());
  // 30 times what strains an edge of the softness in the longest substep by all of it
  constexpr double FORCE = 30.0 * ALLOWED * MASS / (0.75 * LONGEST * LONGEST), PERIOD = 0.6;
  double hardest = 1.0, velocity = 0.0, work = 0.0, time = 0.0, largest = 0.0, softest = 1.0;
  for (int n = 0; time < PERIOD; n++) {
    const double h = LONGEST * std::sqrt(hardest) * (n % 3 == 0 ? 0.4 : 0.9);
    const double force = FORCE * std::pow(std::sin(PI * time / PERIOD), 2);
    velocity += h * force / MASS;
    auto displacement = start;
    for (Vertex &v : displacement) v.x = v.y = v.z = 0.0;
    displacement[1].x = h * velocity;
    ClothState state{start.data(), displacement.data(), true, nullptr, 1.0 / (h * h)};
    state.longest_sq = LONGEST * LONGEST / (h * h);
    state.max_edge_share = SHARE;
    state.max_edge_error = ALLOWED;
    c.lambda[0] = 0.0;
    project(c, 0, state);
    hardest =
        solver_error(c, {1.0 / (h * h), LONGEST * LONGEST, ALLOWED, 1.0 / SHARE - 0.5}).hardest;
    softest = std::min(softest, hardest);
    start[1].x += displacement[1].x;
    velocity = displacement[1].x / h;
    work += force * displacement[1].x;
    largest = std::max(largest, start[1].x - 1.0);
    time += h;
  }
  BOOST_TEST(largest > 0.6 * ALLOWED);
  BOOST_TEST(largest < ALLOWED);
  BOOST_TEST(softest < 0.1);
  BOOST_TEST(hardest > 0.9);
  // of the energy of 0.5 F x what is left is motion
  BOOST_TEST(0.5 * MASS * velocity * velocity < 0.02 * FORCE * largest);
  BOOST_TEST(work > -1e-3 * FORCE * largest);
}

// A slack edge comes to its end within one substep.  Pulled by its law at the start of that it
// would be soft there, and hard on the way back: up to 1.2 times the speed.

BOOST_AUTO_TEST_CASE(an_edge_that_snaps_taut_returns_no_faster)
{
  constexpr double LONGEST = 1e-3, ALLOWED = 0.01, SHARE = 0.8, SUBSTEP = 0.1 * LONGEST;
  Constraints<2> c = alone<2>({1.0, 1.0, 0.0, 0.0});
  for (double strain = 0.02; strain < 4.0; strain *= 1.1)
    for (const double slack : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      const double speed = strain * ALLOWED / SUBSTEP;
      auto start = vertices<2>({Vec3(0, 0, 0), Vec3(1, 0, 0)}, {0.0, 1.0});
      start[1].x -= slack * speed * SUBSTEP;
      double velocity = speed;
      for (int n = 0; n < 10000 && start[1].x > 1.0 - speed * SUBSTEP; n++) {
        auto displacement = start;
        for (Vertex &v : displacement) v.x = v.y = v.z = 0.0;
        displacement[1].x = SUBSTEP * velocity;
        ClothState state{start.data(), displacement.data(), true, nullptr,
                         1.0 / (SUBSTEP * SUBSTEP)};
        state.longest_sq = LONGEST * LONGEST / (SUBSTEP * SUBSTEP);
        state.max_edge_share = SHARE;
        state.max_edge_error = ALLOWED;
        c.lambda[0] = 0.0;
        project(c, 0, state);
        start[1].x += displacement[1].x;
        velocity = displacement[1].x / SUBSTEP;
      }
      BOOST_TEST(velocity < 0.0);
      BOOST_TEST(-velocity / speed < 1.02);
    }
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
