// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/lattice_modes.h"

#include <boost/test/unit_test.hpp>

#include <random>

using namespace sphcloth;

namespace {

// Of waves of displacements u = cos(q r) on a lattice, by displacing particles:
// the change of the gradient of the sum over that of the sum, times H, each the largest of
// all waves

template <class K> double bend_of_waves(double support, int dim)
{
  const int reach = static_cast<int>(support) + 1;
  std::mt19937 numbers(3);
  std::uniform_real_distribution<double> any(0.0, PI);
  const auto gradient_at = [](const Eigen::Vector3d &r, double h) -> Eigen::Vector3d {
    const double q = r.norm() / h;
    return q < 1.0 ? Eigen::Vector3d(K::slope_over_q(q) / h * r) : Eigen::Vector3d::Zero();
  };
  double density = 0.0, gradient = 0.0;
  for (int wave = 0; wave < 4000; wave++) {
    Eigen::Vector3d k = Eigen::Vector3d::Zero(), along = Eigen::Vector3d::Zero();
    for (int d = 0; d < dim; d++) {
      k[d] = wave % 3 == 0 ? (any(numbers) > 1.0 ? PI : 0.0) : any(numbers);
      along[d] = any(numbers) - 0.5 * PI;
    }
    along.normalize();
    Eigen::Vector3d denser = Eigen::Vector3d::Zero();
    Eigen::Vector3d turned = Eigen::Vector3d::Zero();
    constexpr double STEP = 1e-5;
    for (int x = -reach; x <= reach; x++)
      for (int y = -reach; y <= reach; y++)
        for (int z = dim == 3 ? -reach : 0; z <= (dim == 3 ? reach : 0); z++) {
          const Eigen::Vector3d r(x, y, z);
          if (r.isZero()) continue;
          denser += gradient_at(r, support) * std::sin(k.dot(r));
          const Eigen::Vector3d by = STEP * (1.0 - std::cos(k.dot(r))) * along;
          turned += (gradient_at(r + by, support) - gradient_at(r - by, support)) / (2.0 * STEP);
        }
    density = std::max(density, denser.norm());
    gradient = std::max(gradient, turned.norm());
  }
  return support * gradient / density;
}

template <class K> void check_bend(double support, int dim)
{
  const double bound = lattice_modes<K>(support, dim).bend, found = bend_of_waves<K>(support, dim);
  BOOST_TEST_CONTEXT("support " << support << ", " << dim << "-D")
  {
    BOOST_TEST(bound > 0.95 * found);
    BOOST_TEST(bound < 1.15 * found);
  }
}

}    // namespace

BOOST_AUTO_TEST_SUITE(lattice_modes)

BOOST_AUTO_TEST_CASE(gradients_change_as_those_of_displaced_lattices)
{
  for (const int dim : {2, 3})
    for (const double support : {2.0, 2.5, 3.0, 4.0}) {
      check_bend<WendlandC2>(support, dim);
      check_bend<CubicSpline>(support, dim);
    }
}

BOOST_AUTO_TEST_CASE(without_neighbors_there_is_no_wave)
{
  const LatticeModes modes = sphcloth::lattice_modes<WendlandC2>(0.9, 3);
  BOOST_TEST(modes.sound == 1.0);
  BOOST_TEST(modes.bend == 0.0);
}

BOOST_AUTO_TEST_SUITE_END()
