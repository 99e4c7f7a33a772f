// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/kernel.h"

#include <boost/test/unit_test.hpp>

#include <cmath>

using namespace sphcloth;

namespace {

double sphere(int dim) { return dim == 3 ? 4.0 * PI : 2.0 * PI; }

template <class K> double value(const KernelScale &s, double r)
{
  return s.w * K::shape(r * s.inv_support);
}

// Simpson's rule over the radius, an even number of pieces that meets q = 1/2
template <class K> double integral(double support, int dim)
{
  const KernelScale s = kernel_scale<K>(support, dim);
  const int n = 4000;
  const double h = support / n;
  double sum = 0.0;
  for (int k = 0; k <= n; k++) {
    const double r = k * h, weight = k == 0 || k == n ? 1.0 : k % 2 ? 4.0 : 2.0;
    sum += weight * sphere(dim) * std::pow(r, dim - 1) * value<K>(s, r);
  }
  return sum * h / 3.0;
}

template <class K> void check_kernel()
{
  for (int dim : {2, 3}) {
    BOOST_CHECK_SMALL(integral<K>(0.37, dim) - 1.0, 1e-10);
    const KernelScale s = kernel_scale<K>(0.37, dim);
    const double peak = value<K>(s, 0.0), d = 1e-6 * 0.37;
    for (double r : {0.02, 0.1, 0.184, 0.186, 0.3, 0.36}) {
      const double slope = (value<K>(s, r + d) - value<K>(s, r - d)) / (2.0 * d);
      BOOST_CHECK_SMALL(r * s.f * K::slope_over_q(r * s.inv_support) / peak - slope / peak, 1e-7);
      BOOST_CHECK(K::slope_over_q(r * s.inv_support) < 0.0);
      const double q = r / 0.37, e = 1e-6;
      const double bend = (K::slope_over_q(q + e) - K::slope_over_q(q - e)) / (2.0 * e * q);
      BOOST_CHECK_SMALL(K::bend_over_q(q) - bend, 1e-4 * (1.0 + std::fabs(bend)));
    }
    BOOST_CHECK(K::shape(1.0) == 0.0);
    BOOST_CHECK(K::slope_over_q(1.0) == 0.0);
    BOOST_CHECK(K::shape(1.3) == 0.0);
    BOOST_CHECK(K::slope_over_q(1.3) == 0.0);
    BOOST_CHECK(std::isfinite(K::slope_over_q(0.0)));
    BOOST_CHECK(std::isfinite(K::bend_over_q(0.0)));
    BOOST_CHECK(K::bend_over_q(1.0) == 0.0 && K::bend_over_q(1.3) == 0.0);
  }
}

}    // namespace

BOOST_AUTO_TEST_SUITE(kernel)

BOOST_AUTO_TEST_CASE(integral_gradient_and_support_of_each_kernel)
{
  for (KernelName name : ALL_KERNELS)
    with_kernel(name, [](auto kernel) { check_kernel<decltype(kernel)>(); });
}

BOOST_AUTO_TEST_CASE(a_kernel_is_found_by_its_own_name_only)
{
  for (KernelName a : ALL_KERNELS)
    for (KernelName b : ALL_KERNELS) BOOST_CHECK((kernel_word(a) == kernel_word(b)) == (a == b));
}

BOOST_AUTO_TEST_CASE(single_precision_agrees_with_double)
{
  for (KernelName name : ALL_KERNELS)
    with_kernel(name, [](auto kernel) {
      using K = decltype(kernel);
      for (double q = 0.0; q < 1.2; q += 0.013) {
        BOOST_CHECK_SMALL(K::shape(static_cast<float>(q)) - K::shape(q), 2e-6 * K::shape(0.0));
        BOOST_CHECK_SMALL(K::slope_over_q(static_cast<float>(q)) - K::slope_over_q(q), 4e-5);
      }
    });
}

BOOST_AUTO_TEST_SUITE_END()
