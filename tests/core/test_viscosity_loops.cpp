// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/viscosity_loops.h"

#include "water_and_sheet.h"

#include <boost/test/unit_test.hpp>

#include <functional>

using namespace water_and_sheet;

namespace {

constexpr double FLOOR = 0.2, NOISE = 0.3;

using Flow = std::function<Vector3d(const Vector3d &)>;

// Shares of water on both sides of a sheet that moves with it

struct Shares {
  Scene scene;
  Evaluation of;
  std::vector<double> v, pressure, share;

  Shares(const Scene &s, const Flow &flow, double noise = NOISE, double floor = FLOOR) :
      scene(s), of(scene), pressure(s.x.size(), 0.0), share(s.x.size(), -1.0)
  {
    for (const Vector3d &x : scene.x)
      for (int d = 0; d < 3; d++) v.push_back(flow(x)[d]);
    of.p.v = v.data();
    of.p.p_over_rho2 = pressure.data();
    of.fluid->model.viscosity_switch.assign(3, ViscositySwitch());
    of.fluid->model.viscosity_switch[WATER] = {floor, noise};
    of.fluid->record(of.p);
    of.fluid->viscosity_shares(of.p, share.data());
  }
  Vector3d at(std::size_t i) const { return Eigen::Map<const Vector3d>(&v[3 * i]); }

  double expected(std::size_t i) const
  {
    double divergence = 0.0;
    Vector3d curl = Vector3d::Zero();
    for (std::size_t j = 0; j < scene.x.size(); j++) {
      const Vector3d r = scene.x[i] - scene.x[j];
      const double q = r.norm() * of.scale.inv_support;
      if (i == j || q >= 1.0) continue;
      const double each = scene.type[j] == WATER ? scene.mass[j] : RHO0 * scene.volume;
      const Vector3d gradient = each * of.scale.f * WendlandC2::slope_over_q(q) * r;
      divergence += (at(i) - at(j)).dot(gradient);
      curl += (at(i) - at(j)).cross(gradient);
    }
    const double d = std::fabs(divergence) / of.rho[i], c = curl.norm() / of.rho[i];
    return FLOOR + (1.0 - FLOOR) * d / (d + c + NOISE);
  }
  std::vector<double> inside() const
  {
    std::vector<double> found;
    for (std::size_t i = 0; i < scene.x.size(); i++)
      if ((scene.x[i].array() > 0.1).all() && (scene.x[i].array() < 0.25).all())
        found.push_back(share[i]);
    BOOST_REQUIRE(!found.empty());
    return found;
  }
};

Vector3d stirred(const Vector3d &x)
{
  return {std::sin(20.0 * x[1]) + 3.0 * std::sin(12.0 * x[0]), std::cos(13.0 * x[2]) + 3.0 * x[1],
          2.0 * std::sin(9.0 * x[0])};
}

}    // namespace

BOOST_AUTO_TEST_SUITE(viscosity_loops)

BOOST_AUTO_TEST_CASE(shares_are_those_of_a_sum_over_pairs)
{
  for (const Precision precision : {Precision::DOUBLE, Precision::MIXED}) {
    Scene scene = lattice(3, 8, 0.2, 4.0);
    scene.precision = precision;
    const Shares s(scene, stirred);
    double smallest = 1.0, largest = 0.0;
    for (std::size_t i = 0; i < scene.x.size(); i++) {
      if (scene.type[i] != WATER) continue;
      BOOST_CHECK_SMALL(s.share[i] - s.expected(i), precision == Precision::MIXED ? 1e-4 : 1e-12);
      smallest = std::min(smallest, s.share[i]);
      largest = std::max(largest, s.share[i]);
    }
    BOOST_TEST(smallest < 0.3);
    BOOST_TEST(largest > 0.7);
  }
}

BOOST_AUTO_TEST_CASE(what_turns_or_shears_has_the_floor_and_what_is_compressed_has_all)
{
  const Scene scene = lattice(3, 8, 0.0);
  const auto all_near = [&](const Flow &flow, double value) {
    for (const double share : Shares(scene, flow, 1e-6).inside())
      BOOST_TEST(share == value, boost::test_tools::tolerance(1e-5));
  };
  all_near([](const Vector3d &x) { return Vector3d(-x[1], x[0], 0.0); }, FLOOR);
  all_near([](const Vector3d &x) { return Vector3d(0.0, 0.0, 3.0 * x[0]); }, FLOOR);
  all_near([](const Vector3d &x) { return Vector3d(-2.0 * x); }, 1.0);
  // whose divergence and curl are alike
  all_near([](const Vector3d &x) { return Vector3d(x[0] - x[1], 0.0, 0.0); },
           FLOOR + 0.5 * (1.0 - FLOOR));
}

BOOST_AUTO_TEST_CASE(slow_motion_is_noise_and_rest_is_no_division_by_zero)
{
  const Scene scene = lattice(3, 8, 0.0);
  const auto slow = [](const Vector3d &x) { return Vector3d(-1e-9 * x); };
  for (const double share : Shares(scene, slow).inside())
    BOOST_TEST(share == FLOOR, boost::test_tools::tolerance(1e-6));
  const auto together = [](const Vector3d &) { return Vector3d(1.0, 2.0, 3.0); };
  for (const double share : Shares(scene, together, 0.0).inside()) BOOST_TEST(share == FLOOR);
}

BOOST_AUTO_TEST_CASE(a_fluid_without_a_switch_takes_part_with_all)
{
  for (const double share : Shares(lattice(3, 8, 0.2), stirred, 1e-6, 1.0).inside())
    BOOST_TEST(share == 1.0);
}

BOOST_AUTO_TEST_SUITE_END()
