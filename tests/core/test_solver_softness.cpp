// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pbd/solver_softness.h"

#include <boost/test/unit_test.hpp>

#include <cmath>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(solver_softness)

// Bisected: y + kappa y (1 + 9 y^4)^2 = size.  The approximation is above.

BOOST_AUTO_TEST_CASE(the_strain_that_a_constraint_comes_to_is_right_to_some_percent)
{
  for (double kappa = 1e-5; kappa < 4.0; kappa *= 1.5)
    for (double size = 1e-3; size < 1e5; size *= 1.3) {
      double low = 0.0, high = size;
      while (high - low > 1e-12 * high) {
        const double y = 0.5 * (low + high), pull = kappa * std::pow(1.0 + 9.0 * std::pow(y, 4), 2);
        (y + pull * y > size ? high : low) = y;
      }
      const double y = hardened_strain(size, kappa);
      BOOST_TEST(y > (1.0 - 1e-9) * low);
      BOOST_TEST(y < 1.1 * high);
    }
}

BOOST_AUTO_TEST_SUITE_END()
