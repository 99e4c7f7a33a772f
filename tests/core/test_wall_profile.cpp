// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/wall_profile.h"

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

using namespace sphcloth;

namespace {

struct Sums {
  double density = 0.0, gradient = 0.0;
};

// of a particle at distance `layer` + 1/2 from a plane: over a lattice of unit spacing and mass
// from `first` on, counted from the plane
template <class K> Sums over_lattice(double support, int dim, int layer, int first)
{
  Sums sums;
  const double norm = K::norm(dim) / std::pow(support, dim), h = 1e-6;
  const int reach = static_cast<int>(support) + 1;
  for (int x = first; x <= layer + reach; x++)
    for (int y = -reach; y <= reach; y++)
      for (int z = (dim == 3 ? -reach : 0); z <= (dim == 3 ? reach : 0); z++) {
        const double dx = layer - x, q = std::sqrt(dx * dx + y * y + z * z) / support;
        if (q >= 1.0) continue;
        sums.density += norm * K::shape(q);
        if (q == 0.0) continue;
        const double rise = (K::shape(q + h) - K::shape(q - h)) / (2.0 * h);
        sums.gradient += norm * rise / support * dx / (q * support);
      }
  return sums;
}

template <class K> WallProfile profile_of(const WallTable &table, double support, int dim, double r)
{
  return {table, lattice_sums<K>(support, dim), support, r};
}

// one pressure everywhere: the forces of pairs of particles, p/rho^2 twice, and of the wall
template <class K> void check_layers(double support, int dim)
{
  const WallTable table = wall_table<K>(dim);
  for (double reflection : {1.0, 2.0}) {
    const WallProfile profile = profile_of<K>(table, support, dim, reflection);
    BOOST_CHECK(profile.changes());
    const double inside = over_lattice<K>(support, dim, 20, 0).density;
    for (int layer = 0; layer + 0.5 < support; layer++) {
      const Sums sums = over_lattice<K>(support, dim, layer, 0);
      const WallTable::Value wall = profile(table((layer + 0.5) / support));
      // a layer that lacks hardly anything has what a power of lambda leaves there
      BOOST_CHECK_SMALL(sums.density + wall.lambda - inside, 5e-4);
      BOOST_CHECK_SMALL(2.0 * sums.gradient + reflection * wall.slope / support, 1e-2);
    }
    const Sums first = over_lattice<K>(support, dim, 0, 0);
    const WallTable::Value wall = profile(table(0.5 / support));
    BOOST_CHECK_SMALL(first.density + wall.lambda - inside, 1e-12);
    BOOST_CHECK_SMALL(2.0 * first.gradient + reflection * wall.slope / support, 1e-8);
  }
}

}    // namespace

BOOST_AUTO_TEST_SUITE(wall_profile)

BOOST_AUTO_TEST_CASE(a_lattice_half_a_spacing_away_is_at_rest_under_pressure)
{
  for (double support : {2.0, 2.4, 3.0, 3.6, 4.0, 5.0})
    for (int dim : {2, 3}) {
      check_layers<WendlandC2>(support, dim);
      check_layers<WendlandC4>(support, dim);
      check_layers<CubicSpline>(support, dim);
      check_layers<QuinticSpline>(support, dim);
    }
}

BOOST_AUTO_TEST_CASE(derivatives_are_those_of_the_value)
{
  for (double support : {2.0, 3.0, 4.0}) {
    const WallTable table = wall_table<WendlandC2>(3);
    const WallProfile profile = profile_of<WendlandC2>(table, support, 3, 1.0);
    double before = profile(table(-0.99)).lambda;
    for (double delta = -0.98; delta < 0.99; delta += 0.0137) {
      const double h = 1e-6;
      const WallTable::Value at = profile(table(delta)), less = profile(table(delta - h)),
                             more = profile(table(delta + h));
      const double scale = std::fabs(at.slope) + 1e-3;
      BOOST_CHECK_SMALL((at.slope - (more.lambda - less.lambda) / (2.0 * h)) / scale, 1e-5);
      const double bent = std::fabs(at.curvature) + 1e-2;
      BOOST_CHECK_SMALL((at.curvature - (more.slope - less.slope) / (2.0 * h)) / bent, 0.02);
      BOOST_CHECK(at.slope <= 0.0);
      BOOST_CHECK(at.lambda <= before);
      before = at.lambda;
    }
    BOOST_CHECK(profile(table(1.0)).lambda == 0.0);
  }
}

BOOST_AUTO_TEST_CASE(without_a_lattice_a_wall_is_its_half_space)
{
  const WallTable table = wall_table<WendlandC2>(3);
  const WallProfile plain;
  BOOST_CHECK(!plain.changes());
  for (double delta : {-0.3, 0.0, 0.4, 1.2}) {
    BOOST_CHECK(plain(table(delta)).lambda == table(delta).lambda);
    BOOST_CHECK(plain(table(delta)).slope == table(delta).slope);
  }
}

BOOST_AUTO_TEST_CASE(edges_of_two_walls)
{
  // the particle in the corner of a square lattice, half a spacing from both walls
  for (double support : {2.0, 3.0}) {
    const WallTable table = wall_table<WendlandC2>(2);
    const WallProfile profile = profile_of<WendlandC2>(table, support, 2, 1.0);
    const double norm = WendlandC2::norm(2) / (support * support);
    double inside = 0.0, here = 0.0;
    for (int x = -5; x <= 5; x++)
      for (int y = -5; y <= 5; y++) {
        const double q = std::sqrt(x * x + y * y) / support;
        if (q >= 1.0) continue;
        inside += norm * WendlandC2::shape(q);
        if (x >= 0 && y >= 0) here += norm * WendlandC2::shape(q);
      }
    const std::vector<NearWall> both(2, {0, 0.5 / support, table, profile});
    const JointWalls walls(both.data(), 2, profile);
    std::printf("  edge, support %.0f: density %.4f\n", support, (here + walls.lambda()) / inside);
    BOOST_CHECK_SMALL((here + walls.lambda()) / inside - 1.0, 0.02);
  }
  // slopes are the derivatives, of the sign of one wall also where others add more than 1
  const WallTable table = wall_table<WendlandC2>(3);
  for (const WallProfile &profile : {WallProfile(), profile_of<WendlandC2>(table, 2.0, 3, 1.0)})
    for (double a : {-0.5, -0.1, 0.05, 0.2, 0.6})
      for (double b : {-0.3, 0.1, 0.8, 2.0}) {
        const double h = 1e-6;
        const auto at = [&](double delta, auto asked) {
          const std::array<NearWall, 3> near{
              {{0, delta, table, profile}, {1, b, table, profile}, {2, 0.3, table, profile}}};
          return asked(JointWalls(near.data(), near.size(), profile));
        };
        const auto lambda = [&](double delta) {
          return at(delta, [](const JointWalls &walls) { return walls.lambda(); });
        };
        const double slope = at(a, [](const JointWalls &walls) { return walls.slope(0); });
        for (int k = 0; k < 3; k++) {
          const auto its_slope = [&](double delta) {
            return at(delta, [k](const JointWalls &walls) { return walls.slope(k); });
          };
          const double bend = at(a, [k](const JointWalls &walls) { return walls.curvature(k, 0); });
          BOOST_TEST(bend == at(a, [k](const JointWalls &walls) { return walls.curvature(0, k); }),
                     boost::test_tools::tolerance(1e-12));
          const double found = (its_slope(a + h) - its_slope(a - h)) / (2.0 * h);
          BOOST_CHECK_SMALL((bend - found) / (std::fabs(bend) + 0.1), 1e-3);
        }
        BOOST_CHECK_SMALL(slope - (lambda(a + h) - lambda(a - h)) / (2.0 * h), 1e-6);
        BOOST_CHECK(at(a, [](const JointWalls &walls) { return walls.share(0); }) > 0.0);
      }
}

BOOST_AUTO_TEST_SUITE_END()
