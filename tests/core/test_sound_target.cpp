// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/sound_target.h"

#include <boost/test/unit_test.hpp>

#include <cmath>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(sound_target)

static const SoundBounds BOUNDS{5.0, 40.0, 0.1};
// from one count to the next
static const double RATIO = std::pow(8.0, 1.0 / SoundCounts::N);

static double wanted(double v, int n, double fast, int n_fast)
{
  SoundCounts counts(BOUNDS);
  for (int i = 0; i < n; i++) counts.add(v * v);
  for (int i = 0; i < n_fast; i++) counts.add(fast * fast);
  return counts.wanted();
}

BOOST_AUTO_TEST_CASE(nearly_all_of_the_fluid_is_slower_than_the_mach_number)
{
  for (const double v : {0.51, 0.7, 1.3, 2.0, 3.9}) {
    const double c = wanted(v, 1000, 0.0, 0);
    BOOST_CHECK(c >= 10.0 * v && c <= 10.0 * v * RATIO * (1.0 + 1e-12));
    // a hundredth may be faster
    BOOST_CHECK(wanted(v, 990, 3.95, 10) == c);
    BOOST_CHECK(wanted(v, 980, 3.99, 20) > 39.0);
  }
  // few particles all count
  BOOST_CHECK(wanted(1.0, 10, 2.0, 1) >= 20.0);
}

BOOST_AUTO_TEST_CASE(it_stays_within_its_bounds)
{
  BOOST_CHECK(wanted(0.0, 100, 0.0, 0) >= 5.0);
  BOOST_CHECK(wanted(0.0, 100, 0.0, 0) <= 5.0 * RATIO * (1.0 + 1e-12));
  BOOST_CHECK_CLOSE(wanted(100.0, 100, 0.0, 0), 40.0, 1e-9);
  BOOST_CHECK_CLOSE(SoundCounts(BOUNDS).wanted(), 5.0, 1e-9);    // no particle asks for anything
}

BOOST_AUTO_TEST_CASE(
    it_rises_with_waves_over_a_smoothing_length_and_falls_with_those_over_the_fluid)
{
  const double smoothing = 0.1, size = 2.0;
  double c = 10.0, time = 0.0;
  for (; c < 19.99 && time < 1.0; time += 1e-3) {
    const double next = next_sound(c, 20.0, 2e-3, smoothing, size);
    BOOST_REQUIRE(next >= c && next <= c * (1.0 + c * 2e-3 / (10.0 * smoothing)) + 1e-12);
    if (next == c) break;
    c = next;
  }
  BOOST_CHECK(c == 20.0 || c > 19.8);
  // what it falls to is reached after some times of ten waves over the fluid
  const double fallen = next_sound(20.0, 10.0, 10.0 * size / 20.0, smoothing, size);
  BOOST_CHECK_CLOSE(fallen, 10.0 + 10.0 * std::exp(-1.0), 1e-9);
  BOOST_CHECK(next_sound(20.0, 10.0, 1e9, smoothing, size) == 10.0);
  // small changes wait for their time
  BOOST_CHECK(next_sound(20.0, 20.1, 1e9, smoothing, size) == 20.0);
  BOOST_CHECK(next_sound(20.0, 10.0, 1e-6, smoothing, size) == 20.0);
  BOOST_CHECK_CLOSE(expansion_left(20.0, 10.0 * size / 20.0, size), std::exp(-1.0), 1e-9);
}

BOOST_AUTO_TEST_CASE(another_speed_of_sound_has_the_same_pressure_at_another_density)
{
  for (const double gamma : {7.0, 1.4})
    for (const double ratio : {0.25, 0.9, 1.1, 4.0})
      for (const double rho : {0.97, 1.0, 1.0001, 1.01, 1.2}) {
        const Tait now{1000.0, 400.0, gamma}, next{1000.0, 400.0 * ratio, gamma};
        const double same = density_of_same_pressure(now, next, 1000.0 * rho);
        BOOST_CHECK_SMALL(next.pressure(same) - now.pressure(1000.0 * rho), 1e-6);
        // to first order the compression is that over the ratio of stiffnesses
        if (rho == 1.0001) BOOST_CHECK_CLOSE(same / 1000.0 - 1.0, 1e-4 / ratio, 0.5);
      }
  // a softer fluid has no density with such a tension
  const Tait now{1000.0, 400.0, 7.0}, next{1000.0, 100.0, 7.0};
  const double thin = density_of_same_pressure(now, next, 800.0);
  BOOST_CHECK(thin > 0.0 && thin < 500.0);
}

BOOST_AUTO_TEST_SUITE_END()
