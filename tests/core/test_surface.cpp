// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/surface.h"

#include <boost/test/unit_test.hpp>

#include <cmath>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(surface)

BOOST_AUTO_TEST_CASE(a_half_space_is_completed_wherever_its_surface_is)
{
  for (const KernelName name : ALL_KERNELS)
    with_kernel(name, [](auto kernel) {
      for (int dim : {2, 3}) {
        const WallTable wall = wall_table<decltype(kernel)>(dim);
        const SurfaceTable table(wall);
        for (double delta : {0.0, 0.01, 0.125, 0.3, 0.45, 0.6, 0.8, 0.97}) {
          const WallTable::Value missing = wall(delta);
          const double open = 1.0 - missing.lambda;
          BOOST_CHECK_CLOSE(open * table(-missing.slope / open).factor, 1.0, 0.05);
        }
      }
    });
}

BOOST_AUTO_TEST_CASE(slope_is_that_of_the_factor)
{
  const SurfaceTable table(wall_table<WendlandC2>(3));
  for (double x : {0.01, 0.2, 0.9, 1.7, 2.5, 2.9}) {
    const double h = 1e-7;
    BOOST_CHECK_SMALL(table(x).slope - (table(x + h).factor - table(x - h).factor) / (2.0 * h),
                      1e-6);
    BOOST_CHECK(table(x).slope > 0.0);
  }
}

BOOST_AUTO_TEST_CASE(inside_and_outside)
{
  const SurfaceTable table(wall_table<WendlandC2>(2));
  BOOST_CHECK(table(0.0).factor == 1.0 && table(0.0).slope == 0.0);
  BOOST_CHECK_CLOSE(table(50.0).factor, 2.0, 1e-9);
  BOOST_CHECK(table(50.0).slope == 0.0);
  BOOST_CHECK(table(std::nan("")).factor == 1.0);
}

// integrals over q of powers of q and 1 - q
BOOST_AUTO_TEST_CASE(bend_of_wendland_c2)
{
  BOOST_CHECK_CLOSE(bend_over_slope<WendlandC2>(2), std::sqrt(13.5), 0.1);
}

BOOST_AUTO_TEST_SUITE_END()
