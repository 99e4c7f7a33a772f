// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/air/air_loads.h"

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>

using namespace sphcloth;
using Eigen::Vector3d;

namespace {

// vertices, triangles and masses of a piece of cloth
struct Cloth {
  std::vector<Vector3d> x, v, gain, impulse;
  std::vector<double> mass;
  AirTriangles triangles;
  AirDrag drag;

  Cloth() { drag.density = 1.2; }
  void add_vertex(const Vector3d &at, double m)
  {
    x.push_back(at);
    mass.push_back(m);
    v.emplace_back(Vector3d::Zero());
    gain.emplace_back(Vector3d::Zero());
  }
  void add_triangle(int a, int b, int c)
  {
    triangles.slot[0].push_back(a);
    triangles.slot[1].push_back(b);
    triangles.slot[2].push_back(c);
  }
  // a mass of 0: held
  void finish()
  {
    std::vector<int> n(x.size(), 0);
    for (const auto &slots : triangles.slot)
      for (const int s : slots) n[s]++;
    triangles.inverse_mass.assign(triangles.size(), 0.0);
    for (int t = 0; t < triangles.size(); t++)
      for (const auto &slots : triangles.slot)
        if (const int s = slots[t]; mass[s] > 0.0)
          triangles.inverse_mass[t] += n[s] / (9.0 * mass[s]);
  }
  double step(double dt)
  {
    impulse.assign(x.size(), Vector3d::Zero());
    return add_air_impulses(triangles, {x.data(), v.data(), gain.data()}, drag, dt, impulse.data());
  }
  Vector3d total() const
  {
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d &j : impulse) sum += j;
    return sum;
  }
  void set_velocity(const Vector3d &all) { std::fill(v.begin(), v.end(), all); }
};

Cloth one_triangle(double mass = 1.0)
{
  Cloth cloth;
  cloth.add_vertex({0.0, 0.0, 0.0}, mass);
  cloth.add_vertex({2.0, 0.0, 0.0}, mass);
  cloth.add_vertex({0.0, 3.0, 0.0}, mass);
  cloth.add_triangle(0, 1, 2);
  cloth.finish();
  return cloth;
}

// n by n squares of side 1 with masses by area: nothing but the border is held
Cloth sheet(int n, double areal, bool held = false)
{
  Cloth cloth;
  for (int j = 0; j <= n; j++)
    for (int i = 0; i <= n; i++) cloth.add_vertex(Vector3d(i, j, 0.0), 0.0);
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      cloth.add_triangle(a, b, d);
      cloth.add_triangle(a, d, c);
    }
  for (int t = 0; t < cloth.triangles.size(); t++)
    for (const auto &slots : cloth.triangles.slot) cloth.mass[slots[t]] += areal * 0.5 / 3.0;
  if (held) std::fill(cloth.mass.begin(), cloth.mass.end(), 0.0);
  cloth.finish();
  return cloth;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(air_loads)

BOOST_AUTO_TEST_CASE(a_held_triangle_bears_the_force_of_the_law)
{
  Cloth cloth = one_triangle(0.0);
  cloth.drag.coefficients = {1.3, 0.1};
  const double dt = 0.5, half = 0.5 * 1.2 * 3.0 * dt;    // its area is 3
  cloth.set_velocity({-3.0, 0.0, 4.0});    // minus the wind
  BOOST_TEST(cloth.step(dt) == 3.0);
  const Vector3d expected(half * 0.1 * 5.0 * 3.0, 0.0, -half * 1.3 * 16.0);
  BOOST_CHECK_SMALL((cloth.total() - expected).norm(), 1e-13);
  for (const Vector3d &j : cloth.impulse) BOOST_CHECK_SMALL((j - expected / 3.0).norm(), 1e-13);
}

BOOST_AUTO_TEST_CASE(both_sides_are_alike)
{
  Cloth cloth = one_triangle(), turned = one_triangle();
  std::swap(turned.triangles.slot[1], turned.triangles.slot[2]);
  for (Cloth *each : {&cloth, &turned}) {
    each->drag.coefficients = {1.3, 0.1};
    each->set_velocity({-3.0, 1.0, 4.0});
    each->gain[1] = {0.1, 0.2, 0.3};
    each->step(0.5);
  }
  BOOST_CHECK_SMALL((cloth.total() - turned.total()).norm(), 1e-14);
}

BOOST_AUTO_TEST_CASE(it_turns_with_the_triangle)
{
  Cloth cloth = one_triangle(), turned = one_triangle();
  const Eigen::Matrix3d by =
      Eigen::AngleAxisd(1.1, Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  cloth.set_velocity({-3.0, 1.0, 4.0});
  turned.set_velocity(by * Vector3d(-3.0, 1.0, 4.0));
  for (std::size_t s = 0; s < 3; s++) {
    cloth.gain[s] = Vector3d(0.3, 0.1 * static_cast<double>(s), -0.2);
    turned.gain[s] = by * cloth.gain[s];
    turned.x[s] = by * cloth.x[s] + Vector3d(5.0, 6.0, 7.0);
  }
  for (Cloth *each : {&cloth, &turned}) {
    each->drag.coefficients = {1.3, 0.1};
    each->step(0.5);
  }
  BOOST_CHECK_SMALL((by * cloth.total() - turned.total()).norm(), 1e-13);
}

// no step is so long, no sheet so light

BOOST_AUTO_TEST_CASE(the_relative_velocity_falls_and_keeps_its_sign)
{
  for (const double areal : {1e-6, 1e-2, 1e2})
    for (const double dt : {1e-4, 1.0, 1e4}) {
      Cloth cloth = sheet(4, areal);
      cloth.set_velocity({0.0, 0.0, 50.0});
      cloth.step(dt);
      for (std::size_t s = 0; s < cloth.x.size(); s++) {
        const double after = 50.0 + cloth.impulse[s][2] / cloth.mass[s];
        BOOST_TEST(after > 0.0);
        BOOST_TEST(after < 50.0);
      }
    }
}

BOOST_AUTO_TEST_CASE(energy_relative_to_the_air_never_rises)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vector = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  for (const double areal : {1e-5, 1e-2, 1.0})
    for (const double dt : {1e-3, 1.0}) {
      Cloth cloth = sheet(4, areal);
      cloth.drag.coefficients = {1.3, 0.2};
      double before = 0.0, after = 0.0;
      for (std::size_t s = 0; s < cloth.x.size(); s++) {
        cloth.x[s] += 0.3 * vector();
        cloth.v[s] = 50.0 * vector();
        before += cloth.mass[s] * cloth.v[s].squaredNorm();
      }
      cloth.step(dt);
      for (std::size_t s = 0; s < cloth.x.size(); s++)
        after += cloth.mass[s] * (cloth.v[s] + cloth.impulse[s] / cloth.mass[s]).squaredNorm();
      BOOST_TEST(after < before);
    }
}

// dv/dt = -c v^2: v = v0 / (1 + c v0 t)

BOOST_AUTO_TEST_CASE(the_decay_is_of_second_order)
{
  const double areal = 0.5, c = 0.5 * 1.2 * 1.17 / areal, v0 = 3.0, time = 1.0;
  double errors[3];
  for (int k = 0; k < 3; k++) {
    const int steps = 16 << k;
    Cloth cloth = sheet(2, areal);
    cloth.set_velocity({0.0, 0.0, v0});
    for (int n = 0; n < steps; n++) {
      cloth.step(time / steps);
      for (std::size_t s = 0; s < cloth.x.size(); s++)
        cloth.v[s] += cloth.impulse[s] / cloth.mass[s];
    }
    errors[k] = std::fabs(cloth.v[4][2] - v0 / (1.0 + c * v0 * time));
  }
  BOOST_TEST(errors[0] < 5e-3 * v0);
  for (int k = 0; k < 2; k++) {
    BOOST_TEST(errors[k] / errors[k + 1] > 3.5);
    BOOST_TEST(errors[k] / errors[k + 1] < 4.6);
  }
}

// a sheet that is held by something else bears the whole wind, however light it is

BOOST_AUTO_TEST_CASE(what_all_else_balances_is_the_whole_force)
{
  const double dt = 1.0, wind = 20.0;
  Cloth cloth = sheet(4, 1e-4), held = sheet(4, 1.0, true);
  held.set_velocity({0.0, 0.0, -wind});
  held.step(dt);
  cloth.set_velocity({0.0, 0.0, -wind});
  for (int n = 0; n < 4; n++) {
    for (std::size_t s = 0; s < cloth.x.size(); s++)
      cloth.gain[s] = -held.impulse[s] / cloth.mass[s];
    cloth.step(dt);
  }
  BOOST_CHECK_SMALL((cloth.total() - held.total()).norm() / held.total().norm(), 1e-9);
}

BOOST_AUTO_TEST_CASE(covered_triangles_take_their_share)
{
  Cloth cloth = one_triangle();
  cloth.set_velocity({0.0, 0.0, 2.0});
  cloth.mass.assign(3, 0.0);
  cloth.finish();
  cloth.step(0.1);
  const Vector3d all = cloth.total();
  cloth.triangles.open_share = {0.25};
  BOOST_TEST(cloth.step(0.1) == 0.75);
  BOOST_CHECK_SMALL((cloth.total() - 0.25 * all).norm(), 1e-14);
  cloth.triangles.open_share = {0.0};
  cloth.step(0.1);
  BOOST_TEST(cloth.total().norm() == 0.0);
}

BOOST_AUTO_TEST_CASE(a_triangle_without_area_takes_nothing)
{
  Cloth cloth = one_triangle();
  cloth.x[2] = cloth.x[1];
  cloth.set_velocity({1.0, 2.0, 3.0});
  BOOST_TEST(cloth.step(0.1) == 0.0);
  BOOST_TEST(cloth.total().norm() == 0.0);
}

// batches of vectors and their ends

BOOST_AUTO_TEST_CASE(each_triangle_counts_once)
{
  for (const int n : {1, 3, 5, 8, 9}) {
    Cloth cloth = sheet(n, 1.0, true);
    cloth.set_velocity({0.0, 0.0, -2.0});
    BOOST_CHECK_SMALL(cloth.step(1.0) - n * n, 1e-12);
    BOOST_CHECK_SMALL(cloth.total()[2] - 0.5 * 1.2 * 1.17 * 4.0 * n * n, 1e-10);
  }
}

BOOST_AUTO_TEST_CASE(a_table_stands_for_the_coefficients)
{
  constexpr double RIGHT = 1.57079632679489662;
  Cloth cloth = sheet(9, 1.0, true);
  cloth.drag.table = DragTable({{0.0, 0.0, 0.0}, {RIGHT, 2.0, 0.0}});
  cloth.set_velocity({0.0, 0.0, -2.0});
  cloth.step(1.0);
  BOOST_CHECK_SMALL(cloth.total()[2] - 0.5 * 1.2 * 2.0 * 4.0 * 81.0, 1e-10);
}

BOOST_AUTO_TEST_SUITE_END()
