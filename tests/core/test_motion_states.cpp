// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/timestep/motion_states.h"

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(motion_states)

// Type 1 flies, type 2 does not, type 0 is none.

BOOST_AUTO_TEST_CASE(states_of_many_particles_are_those_of_each)
{
  constexpr int N = 50;
  constexpr double REST = 1000.0, ROUNDING = 1e-6, FTM2V = 0.5, TOLERATED = 0.1;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<int> type(N), particles;
  std::vector<double> v(3 * N), f(3 * N), rho(N), drho(N), rmass(N);
  for (double &x : v) x = uniform(random);
  for (double &x : f) x = uniform(random);
  for (int i = 0; i < N; i++) {
    type[i] = 1 + i % 2;
    rho[i] = REST + 20.0 * uniform(random);
    drho[i] = 1e3 * uniform(random);
    rmass[i] = 2.0 + uniform(random);
    if (i % 7 != 3) particles.push_back(N - 1 - i);
  }
  const std::vector<double> mass = {0.0, 3.0, 4.0}, support = {0.0, 0.1, 0.2};
  const std::vector<double> rest = {0.0, REST, -std::numeric_limits<double>::infinity()};
  const std::vector<double> rounding = {0.0, ROUNDING, 0.0};
  const int n = static_cast<int>(particles.size());
  int flying = 0;
  const double *const columns[3] = {v.data(), v.data() + N, v.data() + 2 * N};    // any numbers
  for (const bool of_types : {false, true})
    for (const bool eases : {false, true}) {
      const double *const *external = eases ? columns : nullptr;
      StepStates states;
      states.rho[n] = -1.0;
      const double *m = of_types ? mass.data() : rmass.data();
      find_motion_states({type.data(), v.data(), f.data(), rho.data(), drho.data(), external, m,
                          of_types, support.data(), rest.data(), rounding.data(), FTM2V, TOLERATED,
                          eases},
                         particles.data(), n, states);
      for (int k = 0; k < n; k++) {
        const int i = particles[k], t = type[i];
        const double speed_sq =
            v[3 * i] * v[3 * i] + v[3 * i + 1] * v[3 * i + 1] + v[3 * i + 2] * v[3 * i + 2];
        const auto is = [](double a, double b) {
          BOOST_TEST(a == b, boost::test_tools::tolerance(1e-14));
        };
        is(states.support[k], support[t]);
        is(states.speed_sq[k], speed_sq);
        double force_sq = 0.0;
        for (int d = 0; d < 3; d++)
          force_sq += std::pow(f[3 * i + d] + (external ? columns[d][i] : 0.0), 2);
        is(states.accel_sq[k], force_sq * std::pow(FTM2V / (of_types ? mass[t] : rmass[i]), 2));
        is(states.rho[k], rho[i]);
        const bool flies = t == 1 && rho[i] <= REST;
        const double rate = drho[i], gap = REST - rho[i];
        is(states.until_pressed[k], flies ? time_to_cross(gap, rate, 0.0) : 0.0);
        const bool eased = flies && eases;
        is(states.drho[k], eased ? rate_beyond(gap, rate, TOLERATED * rho[i]) : rate);
        flying += flies;
      }
      BOOST_TEST(states.rho[n] == -1.0);
    }
  BOOST_TEST(flying > N / 2);
}

BOOST_AUTO_TEST_SUITE_END()
