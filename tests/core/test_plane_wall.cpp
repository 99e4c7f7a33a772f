// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/plane_wall.h"

#include "half_space.h"

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

using namespace sphcloth;

namespace {

constexpr double DELTAS[] = {0.0, 0.013, 0.2, 0.331, 0.5, 0.77, 0.96};

template <class K> void check_wall()
{
  for (int dim : {2, 3}) {
    const WallTable table = wall_table<K>(dim);
    const double norm = K::norm(dim);
    BOOST_CHECK_SMALL(table(0.0).lambda - 0.5, 1e-12);
    BOOST_CHECK_SMALL(table(1.0 - 1e-9).lambda, 1e-15);
    BOOST_CHECK(table(1.0).lambda == 0.0 && table(1.0).slope == 0.0);
    BOOST_CHECK(table(-1.0).lambda == 1.0 && table(-1.5).slope == 0.0);
    for (double delta : DELTAS) {
      const WallTable::Value value = table(delta);
      const auto density = [&](double q, double) { return norm * K::shape(q); };
      BOOST_CHECK_SMALL(value.lambda - behind(delta, dim, density), 2e-6);
      BOOST_CHECK_SMALL(table(-delta).lambda - (1.0 - value.lambda), 1e-14);
      BOOST_CHECK(table(-delta).slope == value.slope);

      // the slope is that of what the table returns, not only of what it approximates
      const double h = 1e-6;
      const double rise = table(delta + h).lambda - table(delta - h).lambda;
      BOOST_CHECK_SMALL(value.slope - rise / (2.0 * h), 1e-8);

      // friction: the linear continuation, integrated
      if (delta < NEAREST_FRICTION) continue;
      const auto viscous = [&](double q, double z) {
        return -norm * K::slope_over_q(q) * (1.0 + (z - delta) / delta);
      };
      const double support = 0.37;
      const double rate = wall_friction(value, delta, support) * support * support;
      BOOST_CHECK_SMALL(rate - behind(delta, dim, viscous), 3e-5);
    }
    // as fine as round-off in the force asks for: exact in the middle of a piece too
    const double middle = 0.3 + 0.5 / 480.0;
    const auto density = [&](double q, double) { return norm * K::shape(q); };
    BOOST_CHECK_SMALL(table(middle).lambda - behind(middle, dim, density), 2e-6);
    BOOST_CHECK(std::isfinite(wall_friction(table(0.0), 0.0, 1.0)));
  }
}

// the three quadrants behind one or both of two walls at right angles
double exact_corner(double a, double b)
{
  const int n = 400;
  double sum = 0.0;
  for (int i = 0; i < 2 * n; i++)
    for (int j = 0; j < 2 * n; j++) {
      const double x = (i + 0.5) / n - 1.0, y = (j + 0.5) / n - 1.0, q = std::sqrt(x * x + y * y);
      if (q < 1.0 && (x > a || y > b)) sum += WendlandC2::shape(q) / (n * n);
    }
  return WendlandC2::norm(2) * sum;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(plane_wall)

BOOST_AUTO_TEST_CASE(half_space_integral_slope_and_friction_of_each_kernel)
{
  for (KernelName name : ALL_KERNELS)
    with_kernel(name, [](auto kernel) { check_wall<decltype(kernel)>(); });
}

BOOST_AUTO_TEST_CASE(wendland_c2_in_three_dimensions_in_closed_form)
{
  // 21 int_delta^1 (1-q)^4 (1+4q) q (q-delta) dq, integrated by parts
  const WallTable table = wall_table<WendlandC2>(3);
  for (double d : {0.0, 0.1, 0.2511, 0.5, 0.9}) {
    const double u = 1.0 - d;
    // in powers of u: q = 1 - p, p from 0 to u
    const auto power = [&](int n) { return std::pow(u, n + 1) / (n + 1); };
    // p^4 (5-4p) (1-p) (u-p)
    const double sum =
        5 * u * power(4) - (9 * u + 5) * power(5) + (4 * u + 9) * power(6) - 4 * power(7);
    BOOST_CHECK_SMALL(table(d).lambda - 21.0 * sum, 1e-11);
  }
}

BOOST_AUTO_TEST_CASE(two_walls_at_right_angles)
{
  const WallTable table = wall_table<WendlandC2>(2);
  double worst = 0.0;
  for (double a = 0.0; a < 1.0; a += 0.1)
    for (double b = 0.0; b < 1.0; b += 0.1) {
      const std::array<WallTable::Value, 2> walls = {table(a), table(b)};
      worst = std::max(worst, std::fabs(joint_lambda(walls) - exact_corner(a, b)));
    }
  std::printf("  corner of two walls: largest error of lambda %.4f\n", worst);
  BOOST_CHECK(worst < 0.002);
  const std::array<WallTable::Value, 2> edge = {table(0.0), table(0.0)};
  BOOST_CHECK_SMALL(joint_lambda(edge) - 0.75, 1e-12);

  // the shares are the derivatives
  const double h = 1e-6;
  const std::array<WallTable::Value, 2> at = {table(0.3), table(0.4)};
  std::array<WallTable::Value, 2> more = at, less = at;
  more[1].lambda += h;
  less[1].lambda -= h;
  BOOST_CHECK_SMALL((joint_lambda(more) - joint_lambda(less)) / (2.0 * h) - joint_share(at, 1),
                    1e-9);
}

BOOST_AUTO_TEST_CASE(a_distance_that_is_no_number_meets_no_wall)
{
  const WallTable table = wall_table<WendlandC2>(3);
  BOOST_CHECK(table(std::numeric_limits<double>::quiet_NaN()).lambda == 0.0);
  BOOST_CHECK(table(std::numeric_limits<double>::infinity()).lambda == 0.0);
}

BOOST_AUTO_TEST_CASE(a_particle_behind_the_wall_is_stopped_within_half_the_support)
{
  BOOST_CHECK(stop_strain(0.1) == 0.0);
  BOOST_CHECK_SMALL(stop_strain(-STOPPING_DEPTH) - 1.0, 1e-15);
}

BOOST_AUTO_TEST_SUITE_END()
