// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/gradient.h"

#include <boost/test/unit_test.hpp>

#include <array>
#include <random>

using namespace sphcloth;

namespace {

constexpr double SLOPE[3] = {3.0, -2.0, 0.5};

// neighbors at d = x_j - x_i with weights; the field is linear

void add(Differences &s, double dx, double dy, double dz, double weight)
{
  const double more = SLOPE[0] * dx + SLOPE[1] * dy + SLOPE[2] * dz;
  s.xx += weight * dx * dx;
  s.yy += weight * dy * dy;
  s.zz += weight * dz * dz;
  s.xy += weight * dx * dy;
  s.xz += weight * dx * dz;
  s.yz += weight * dy * dz;
  s.x += weight * dx * more;
  s.y += weight * dy * more;
  s.z += weight * dz * more;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(gradient)

BOOST_AUTO_TEST_CASE(exact_for_a_linear_field_all_around_and_in_a_corner)
{
  std::mt19937 generator(5);
  std::uniform_real_distribution<> u(0.0, 1.0);
  for (int dim : {2, 3})
    for (double low : {-1.0, 0.0}) {
      Differences s;
      for (int k = 0; k < 40; k++) {
        const double x = low + (1.0 - low) * u(generator), y = low + (1.0 - low) * u(generator),
                     z = low + (1.0 - low) * u(generator);
        add(s, x, y, dim == 3 ? z : 0.0, 0.1 + u(generator));
      }
      const std::array<double, 3> g = s.gradient(dim);
      BOOST_CHECK_SMALL(g[0] - SLOPE[0], 1e-13);
      BOOST_CHECK_SMALL(g[1] - SLOPE[1], 1e-13);
      BOOST_CHECK_SMALL(g[2] - (dim == 3 ? SLOPE[2] : 0.0), 1e-13);
    }
}

BOOST_AUTO_TEST_CASE(none_for_one_particle_on_a_line_or_in_a_plane_at_any_scale)
{
  const std::array<double, 3> none{0.0, 0.0, 0.0};
  for (int dim : {2, 3}) BOOST_CHECK(Differences().gradient(dim) == none);
  Differences line, plane;
  for (double d : {-1.0, 0.3, 1.0}) {
    add(line, d, 0.7 * d, 0.0, 1.0);
    add(plane, d, d * d, 0.0, 1.0);
  }
  for (int dim : {2, 3}) BOOST_CHECK(line.gradient(dim) == none);
  BOOST_CHECK(plane.gradient(3) == none);
  BOOST_CHECK_SMALL(plane.gradient(2)[1] - SLOPE[1], 1e-13);
  for (double size : {1e-8, 1e8}) {
    Differences s;
    for (double d : {-1.0, 0.3, 1.0}) add(s, d, d * d, 0.0, size);
    BOOST_CHECK_SMALL(s.gradient(2)[0] - SLOPE[0], 1e-13);
  }
}

BOOST_AUTO_TEST_CASE(none_from_a_layer_that_is_nearly_flat)
{
  for (double height : {0.05, 0.3}) {
    Differences s;
    for (int x : {-1, 0, 1})
      for (int y : {-1, 0, 1}) add(s, x, y, (x + y) % 2 ? -height : height, 1.0);
    BOOST_CHECK((s.gradient(3)[0] != 0.0) == (height > 0.2));
  }
}

BOOST_AUTO_TEST_SUITE_END()
