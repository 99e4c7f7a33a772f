// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/surface_loops.h"

#include "water_and_sheet.h"

#include <boost/test/unit_test.hpp>

using namespace water_and_sheet;

namespace {

// Water on both sides of a sheet; what has a turn is the water

struct Turned {
  Scene scene;
  Evaluation of;
  std::vector<double> turn, gradient, force, rate, pressure;

  explicit Turned(const Scene &s) :
      scene(s), of(scene), turn(3 * s.x.size(), 0.0), gradient(turn), force(turn),
      rate(s.x.size(), 0.0), pressure(rate)
  {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (std::size_t i = 0; i < scene.x.size(); i++)
      if (scene.type[i] == WATER)
        for (int d = 0; d < 3; d++) turn[3 * i + d] = any(random);
    of.p.p_over_rho2 = pressure.data();
    of.p.f = force.data();
    of.p.drho = rate.data();
    of.p.force_unit = 1.0;
    of.fluid->record(of.p);
    of.fluid->sum_gradients(of.p, gradient.data());
    of.fluid->record_turns(of.p, turn.data());
    of.fluid->turn_forces(of.p);
  }
  static Vector3d at(const std::vector<double> &v, std::size_t i)
  {
    return Eigen::Map<const Vector3d>(&v[3 * i]);
  }
  bool is_water(std::size_t i) const { return scene.type[i] == WATER; }
  double each(std::size_t i) const { return is_water(i) ? scene.mass[i] : RHO0 * scene.volume; }
  Vector3d slope(const Vector3d &r) const
  {
    return of.scale.f * WendlandC2::slope_over_q(r.norm() * of.scale.inv_support) * r;
  }

  Vector3d expected_gradient(std::size_t i) const
  {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t j = 0; j < scene.x.size(); j++)
      if (j != i) sum += each(j) * slope(scene.x[i] - scene.x[j]);
    return sum;
  }
  // second derivatives of W by finite differences
  Vector3d expected_force(std::size_t i) const
  {
    Vector3d sum = Vector3d::Zero();
    constexpr double STEP = 1e-6;
    for (std::size_t j = 0; j < scene.x.size(); j++) {
      if (j == i || !(is_water(i) || is_water(j))) continue;
      const Vector3d r = scene.x[i] - scene.x[j], by = STEP * (at(turn, i) - at(turn, j));
      sum -= each(i) * each(j) * (slope(r + by) - slope(r - by)) / (2.0 * STEP);
    }
    return sum;
  }
};

}    // namespace

BOOST_AUTO_TEST_SUITE(surface_loops)

BOOST_AUTO_TEST_CASE(gradients_and_forces_are_sums_over_pairs)
{
  for (const Precision precision : {Precision::DOUBLE, Precision::MIXED})
    for (const int dim : {2, 3}) {
      Scene scene = lattice(dim, 8, 0.2, 4.0);
      scene.precision = precision;
      const Turned s(scene);
      const double close = precision == Precision::MIXED ? 3e-5 : 1e-6;
      double largest_gradient = 0.0, largest_force = 0.0;
      for (std::size_t i = 0; i < scene.x.size(); i++) {
        largest_gradient = std::max(largest_gradient, s.expected_gradient(i).norm());
        largest_force = std::max(largest_force, s.expected_force(i).norm());
      }
      Vector3d sum = Vector3d::Zero();
      for (std::size_t i = 0; i < scene.x.size(); i++) {
        const Vector3d found = s.at(s.force, i);
        sum += found;
        BOOST_CHECK_SMALL((found - s.expected_force(i)).norm() / largest_force, close);
        if (!s.is_water(i)) continue;
        const Vector3d off = s.at(s.gradient, i) - s.expected_gradient(i);
        BOOST_CHECK_SMALL(off.norm() / largest_gradient, close);
      }
      BOOST_CHECK_SMALL(sum.norm() / largest_force, 1e-11);
    }
}

BOOST_AUTO_TEST_CASE(virials_are_those_of_the_forces)
{
  Turned s(lattice(3, 8, 0.2, 4.0));
  Eigen::Matrix3d expected = Eigen::Matrix3d::Zero(), found = expected;
  for (std::size_t i = 0; i < s.scene.x.size(); i++)
    expected += s.scene.x[i] * s.at(s.force, i).transpose();
  struct Context {
    const Turned &of;
    Eigen::Matrix3d &sum;
  } context{s, found};
  s.of.fluid->turn_virials(
      s.of.p,
      [](void *to, int i, const Acceleration &a) {
        const Context &c = *static_cast<Context *>(to);
        const double *v = a.virial;
        Eigen::Matrix3d of_one;
        of_one << v[0], v[3], v[4], v[3], v[1], v[5], v[4], v[5], v[2];
        c.sum += c.of.of.p.mass_or_volume[i] * of_one;
      },
      &context);
  const Eigen::Matrix3d both = 0.5 * (expected + expected.transpose());
  BOOST_TEST((found - both).norm() < 1e-10 * both.norm());
}

BOOST_AUTO_TEST_SUITE_END()
