// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/air/gust_field.h"

#include <boost/test/unit_test.hpp>

#include <cmath>

using namespace sphcloth;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double PI = 3.14159265358979323846;

Vector3d at(const GustField &gust, const Vector3d &x)
{
  Vector3d v = Vector3d::Zero();
  const double *const from[3] = {&x[0], &x[1], &x[2]};
  double *const to[3] = {&v[0], &v[1], &v[2]};
  gust.add(1, from, to);
  return v;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(gust_field)

BOOST_AUTO_TEST_CASE(it_is_the_sum_of_its_modes)
{
  const GustField gust(2.0, 3.0, 17);
  for (const double t : {-7.3, 0.0, 0.4, 123.4}) {
    const Vector3d x(t, 1.0 - 0.3 * t, 2.0);
    Vector3d expected = Vector3d::Zero();
    for (const GustField::Mode &mode : gust.all())
      expected += mode.velocity * std::cos(2.0 * PI * (mode.wave.dot(x) + mode.phase));
    BOOST_CHECK_SMALL((at(gust, x) - expected).norm(), 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(components_have_the_variance_that_was_asked_for)
{
  for (const int seed : {1, 2, 3}) {
    const GustField gust(2.0, 3.0, seed);
    Matrix3d mean = Matrix3d::Zero();    // of v v^T over all space
    for (const GustField::Mode &mode : gust.all())
      mean += 0.5 * mode.velocity * mode.velocity.transpose();
    BOOST_CHECK_SMALL((mean - 4.0 * Matrix3d::Identity()).norm(), 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(it_has_no_divergence)
{
  const GustField gust(2.0, 3.0, 5);
  for (const GustField::Mode &mode : gust.all())
    BOOST_CHECK_SMALL(mode.velocity.dot(mode.wave), 1e-14 * mode.wave.norm());
  const double h = 1e-4;
  double divergence = 0.0, gradient = 0.0;
  for (int d = 0; d < 3; d++) {
    const Vector3d step = h * Vector3d::Unit(d), x(0.3, -1.2, 4.0);
    const Vector3d rate = (at(gust, x + step) - at(gust, x - step)) / (2.0 * h);
    divergence += rate[d];
    gradient += rate.squaredNorm();
  }
  BOOST_CHECK_SMALL(divergence, 1e-5 * std::sqrt(gradient));
}

// of an isotropic field the integral length is pi/2 <E/k> / sigma^2

BOOST_AUTO_TEST_CASE(the_spectrum_has_the_length_that_was_asked_for)
{
  const double length = 3.0;
  const GustField gust(1.0, length, 5);
  double sum = 0.0;
  for (const GustField::Mode &mode : gust.all())
    sum += 0.25 * mode.velocity.squaredNorm() / (2.0 * PI * mode.wave.norm());
  BOOST_CHECK_SMALL(0.5 * PI * sum / length - 1.0, 0.03);
}

// behind the peak as k^(-5/3)

BOOST_AUTO_TEST_CASE(small_eddies_follow_kolmogorov)
{
  const GustField gust(1.0, 1.0, 5);
  const auto &modes = gust.all();
  const GustField::Mode &a = modes[modes.size() - 10], &b = modes[modes.size() - 1];
  // the energy of a range that is as wide in the logarithm is k E
  const double slope = std::log(b.velocity.squaredNorm() / a.velocity.squaredNorm()) /
      std::log(b.wave.norm() / a.wave.norm());
  BOOST_CHECK_SMALL(slope + 2.0 / 3.0, 0.01);
}

BOOST_AUTO_TEST_CASE(a_seed_gives_one_field)
{
  const Vector3d x(0.1, 0.2, 0.3);
  const Vector3d one = at(GustField(1.0, 1.0, 9), x), again = at(GustField(1.0, 1.0, 9), x);
  BOOST_TEST((one - again).norm() == 0.0);
  BOOST_TEST((one - at(GustField(1.0, 1.0, 10), x)).norm() > 0.01);
}

BOOST_AUTO_TEST_SUITE_END()
