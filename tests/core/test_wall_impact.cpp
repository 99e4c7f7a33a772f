// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/wall_impact.h"

#include "half_space.h"

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <limits>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(wall_impact)

template <class K> static double by_sum(double delta, int dim)
{
  // 0.01 h_s^2 is 0.0025 H^2
  return behind(delta, dim, [dim](double q, double z) {
    return -K::norm(dim) * K::slope_over_q(q) * z * z / (q * q + 0.0025);
  });
}

BOOST_AUTO_TEST_CASE(it_is_the_sum_over_the_half_space_with_each_kernel)
{
  for (const KernelName name : ALL_KERNELS)
    with_kernel(name, [](auto kernel) {
      using K = decltype(kernel);
      for (const int dim : {2, 3}) {
        const WallImpact table = ::sphcloth::wall_impact<K>(dim);
        const double largest = by_sum<K>(0.0, dim);
        for (const double delta : {0.0, 0.1, 0.25, 0.3333, 0.5, 0.77})
          BOOST_CHECK_SMALL(table(delta) - by_sum<K>(delta, dim), 2e-3 * largest);
      }
    });
}

BOOST_AUTO_TEST_CASE(behind_the_plane_it_is_that_on_it_and_out_of_reach_there_is_none)
{
  const WallImpact table = ::sphcloth::wall_impact<WendlandC2>(3);
  BOOST_CHECK(table(-0.3) == table(0.0));
  BOOST_CHECK(table(1.0) == 0.0);
  BOOST_CHECK(table(std::numeric_limits<double>::infinity()) == 0.0);
  BOOST_CHECK(table(std::numeric_limits<double>::quiet_NaN()) == 0.0);
  BOOST_CHECK(table(1.0 - 1e-9) < 1e-6 * table(0.0));
}

BOOST_AUTO_TEST_SUITE_END()
