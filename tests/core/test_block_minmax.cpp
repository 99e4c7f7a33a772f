// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/neighbor/block_minmax.h"

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <random>
#include <vector>

using namespace sphcloth;

namespace {

constexpr double WIDTH = 0.1;
constexpr int TYPES = 2;

struct Scattered {
  std::vector<double> x;
  std::vector<int> type, value;
  Blocks blocks;
  int n;

  // in a cube, or one that is stretched along an axis
  explicit Scattered(int n_, int axis = 0, double stretch = 1.0) : n(n_)
  {
    std::mt19937 generator{5};
    std::uniform_real_distribution<> u(0.0, 1.0);
    for (int i = 0; i < 3 * n; i++) x.push_back((i % 3 == axis ? stretch : 1.0) * u(generator));
    for (int i = 0; i < n; i++) type.push_back(1 + i % TYPES);
    blocks.divide({x.data(), type.data(), n, n, TYPES}, WIDTH);
  }
  bool near(int i, int j) const
  {
    double r_sq = 0.0;
    for (int d = 0; d < 3; d++) r_sq += std::pow(x[3 * i + d] - x[3 * j + d], 2);
    return r_sq < WIDTH * WIDTH;
  }
  int block(int i) const { return blocks.of_particle()[i]; }
};

}    // namespace

BOOST_AUTO_TEST_SUITE(block_minmax)

BOOST_AUTO_TEST_CASE(each_particle_is_in_one_block_of_its_type)
{
  const Scattered s(9000);
  BOOST_CHECK(s.blocks.count() > 100);
  BOOST_CHECK(s.n >= 32 * (s.blocks.count() - 1));
  std::vector<int> found(s.n);
  for (int b = 0; b < s.blocks.count(); b++)
    for (int t = 1; t <= TYPES; t++)
      for (const int i : s.blocks.in(s.blocks.row(b, t))) {
        found[i]++;
        BOOST_CHECK(s.type[i] == t);
        BOOST_CHECK(s.block(i) == b);
      }
  for (const int times : found) BOOST_CHECK(times == 1);
}

BOOST_AUTO_TEST_CASE(a_long_box_has_as_many_blocks_as_particles_fill)
{
  for (int axis = 0; axis < 3; axis++) {
    const Scattered s(9000, axis, 8.0);
    const int count = s.blocks.count();
    BOOST_CHECK(count > 50 && 16 * count < s.n);
    std::vector<int> particles(count);
    for (int i = 0; i < s.n; i++) {
      BOOST_REQUIRE(s.block(i) >= 0 && s.block(i) < count);
      particles[s.block(i)]++;
    }
    for (const int found : particles) BOOST_CHECK(found > 0);
  }
}

static bool all_have(const BlockMinMax &of, int value, int b, int t)
{
  return of.smallest(b, t) >= value && of.greatest(b, t) <= value;
}

BOOST_AUTO_TEST_CASE(minimum_and_maximum_of_neighbors_whatever_their_block)
{
  Scattered s(9000);
  s.value.assign(s.n, 3);
  BlockMinMax survey(s.blocks);
  survey.take(s.value.data());
  for (int b = 0; b < s.blocks.count(); b++)
    for (int t = 1; t <= TYPES; t++)
      BOOST_CHECK(all_have(survey, 3, b, t) && survey.greatest(b, t) == 3);

  // two others, of one type
  const int low = 100, high = 200;
  s.value[low] = 1;
  s.value[high] = 7;
  survey.take(s.value.data());
  int beside = 0, quiet = 0;
  for (int i = 0; i < s.n; i++) {
    const int b = s.block(i), t = s.type[low];
    if (s.near(i, low) || s.near(i, high)) {
      beside++;
      BOOST_CHECK(!all_have(survey, 3, b, t));
      if (s.near(i, high)) BOOST_CHECK(survey.greatest(b, t) == 7);
      if (s.near(i, low)) BOOST_CHECK(survey.smallest(b, t) == 1);
    }
    BOOST_CHECK(!all_have(survey, 1, b, t));
    BOOST_CHECK(all_have(survey, 3, b, 3 - t));    // no particle of the other type has changed
    quiet += all_have(survey, 3, b, t);
  }
  BOOST_CHECK(beside > 20);
  BOOST_CHECK(quiet > s.n / 2);
}

BOOST_AUTO_TEST_CASE(no_particles_have_no_minimum_or_maximum)
{
  const std::vector<double> x{0.5, 0.5, 0.5};
  const std::vector<int> type{1}, value{4};
  Blocks blocks;
  blocks.divide({x.data(), type.data(), 1, 1, TYPES}, WIDTH);
  BlockMinMax survey(blocks);
  survey.take(value.data());
  BOOST_CHECK(all_have(survey, 4, 0, 1) && !all_have(survey, 5, 0, 1));
  BOOST_CHECK(all_have(survey, 5, 0, 2));
  BOOST_CHECK(survey.greatest(0, 2) < -1000000);
}

BOOST_AUTO_TEST_SUITE_END()
