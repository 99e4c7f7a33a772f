// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/calibration.h"
#include "core/sph/tait.h"

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstdio>

using namespace sphcloth;

namespace {

// the density sum over a lattice stretched to `spacing`, over the mass of a particle
template <class K> double summed(double support, double spacing, int dim)
{
  const int reach = static_cast<int>(support / spacing) + 1;
  double sum = 0.0;
  for (int i = -reach; i <= reach; i++)
    for (int j = -reach; j <= reach; j++)
      for (int k = (dim == 3 ? -reach : 0); k <= (dim == 3 ? reach : 0); k++) {
        const double q = spacing * std::hypot(std::hypot(i, j), k) / support;
        if (q < 1.0) sum += K::norm(dim) / std::pow(support, dim) * K::shape(q);
      }
  return sum;
}

// worst error of the stress of a lattice over its pressure, up to 5 % of compression
template <class K> double worst_stress(double support_over_spacing, int dim, bool calibrated)
{
  const double rho0 = 1000.0, spacing = 0.1, support = support_over_spacing * spacing;
  const Tait eos{rho0, 400.0};
  Calibration map{rho0};
  double mass = rho0 * std::pow(spacing, dim);
  if (calibrated) {
    const LatticeSums lattice = lattice_sums<K>(support_over_spacing, dim);
    map.sum = lattice.sum;
    map.exponent = lattice.exponent;
  } else
    mass = rho0 / summed<K>(support, spacing, dim);
  const auto density = [&](double a) { return map.density(mass * summed<K>(support, a, dim)); };
  BOOST_CHECK_CLOSE(density(spacing), rho0, 1e-10);
  double worst = 0.0;
  for (double more : {0.005, 0.01, 0.02, 0.05}) {
    const double a = spacing * std::pow(1.0 + more, -1.0 / dim), h = 1e-5 * a;
    // - dE/dV
    const double stress = -mass * (eos.energy(density(a + h)) - eos.energy(density(a - h))) /
        (std::pow(a + h, dim) - std::pow(a - h, dim));
    if (calibrated) BOOST_CHECK_CLOSE(density(a), rho0 * (1.0 + more), 0.02 + 10.0 * more);
    worst = std::max(worst, std::fabs(stress / eos.pressure(density(a)) - 1.0));
  }
  return worst;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(calibration)

BOOST_AUTO_TEST_CASE(stress_of_a_lattice_is_its_pressure)
{
  for (int dim : {2, 3})
    for (double support : {2.0, 2.4, 3.0, 4.0}) {
      const double plain = worst_stress<WendlandC2>(support, dim, false);
      const double calibrated = worst_stress<WendlandC2>(support, dim, true);
      std::printf("  %d-D, support %.1f: stress off by %.3f, calibrated by %.4f\n", dim, support,
                  plain, calibrated);
      BOOST_CHECK(calibrated < 0.03);
      BOOST_CHECK(calibrated < plain);
    }
  BOOST_CHECK(worst_stress<WendlandC2>(2.0, 3, false) > 0.05);
}

BOOST_AUTO_TEST_CASE(slope_is_that_of_the_density)
{
  const Calibration map{1000.0, 1.034, 0.95};
  for (double sum : {10.0, 700.0, 1034.0, 1100.0, 3000.0}) {
    const double h = 1e-5 * sum, rho = map.density(sum);
    BOOST_CHECK_CLOSE(map.slope(rho), (map.density(sum + h) - map.density(sum - h)) / (2.0 * h),
                      1e-6);
    BOOST_CHECK_CLOSE(map.summed(rho), sum, 1e-10);
  }
  BOOST_CHECK_CLOSE(map.density(1034.0), 1000.0, 1e-12);
  BOOST_CHECK(map.density(0.0) == 0.0);
}

BOOST_AUTO_TEST_CASE(what_layers_before_a_plane_lack)
{
  // of the layers at 1/2, 3/2, ... the same sums over particles at the other side, one by one
  const double support = 3.0;
  const LatticeSums lattice = lattice_sums<WendlandC4>(support, 3);
  BOOST_CHECK_EQUAL(lattice.layers.size(), 3u);
  const double norm = WendlandC4::norm(3) / (support * support * support);
  for (int layer = 0; layer < 3; layer++) {
    double sum = 0.0, gradient = 0.0;
    for (int x = -1; x >= -4; x--)
      for (int y = -4; y <= 4; y++)
        for (int z = -4; z <= 4; z++) {
          const double dx = x - layer, q = std::sqrt(dx * dx + y * y + z * z) / support, h = 1e-6;
          if (q >= 1.0) continue;
          sum += norm * WendlandC4::shape(q);
          const double rise = (WendlandC4::shape(q + h) - WendlandC4::shape(q - h)) / (2.0 * h);
          gradient += norm * rise / support * dx / (q * support);
        }
    BOOST_CHECK_CLOSE(1.0 + lattice.layers[layer].sum, 1.0 + sum, 1e-10);
    BOOST_CHECK_SMALL(lattice.layers[layer].gradient - gradient, 1e-8);
  }
}

BOOST_AUTO_TEST_SUITE_END()
