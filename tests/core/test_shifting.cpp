// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/sph/shifting.h"

#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <array>
#include <cmath>
#include <random>
#include <vector>

using namespace sphcloth;
namespace data = boost::unit_test::data;

namespace {

constexpr double H = 0.3, SPACING = 0.12, CLUMPING = 0.4;

// a particle and n neighbors around it, some of them outside the support
struct Around {
  ShiftSites sites;
  std::vector<double> velocity;
  std::vector<int> near;    // and the indices that loops over groups read behind them
  int n;

  explicit Around(int n_) : n(n_)
  {
    std::mt19937 generator{11};
    std::uniform_real_distribution<> u(-1.0, 1.0);
    sites.resize(n + 1);
    for (int i = 0; i <= n; i++) {
      const double reach = i == 0 ? 0.0 : 1.1 * H / std::sqrt(3.0);
      sites.sites[i] = {2.0 + reach * u(generator), 1.0 + reach * u(generator),
                        reach * u(generator), 1e-3 * (2.0 + u(generator))};
      sites.at_rest[i] = 1e-3 * (2.0 + u(generator));
      for (int d = 0; d < 3; d++) velocity.push_back(u(generator));
    }
    for (int i = 1; i <= n; i++) near.push_back(i);
    near.resize(n + LANES, 1);
  }
};

// of all neighbors, one by one, by the formulas
template <class K> ConcentrationGradient plain_sums(const Around &around, int dim)
{
  ConcentrationGradient sum;
  const ShiftSites::Site self = around.sites.sites[0];
  const double w = K::norm(dim) / std::pow(H, dim);
  for (int j = 1; j <= around.n; j++) {
    const ShiftSites::Site &other = around.sites.sites[j];
    const std::array<double, 3> r{self.x - other.x, self.y - other.y, self.z - other.z};
    const double distance = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    if (distance >= H) continue;
    const double closeness = std::pow(K::shape(distance / H) / K::shape(SPACING / H), 4);
    for (int a = 0; a < 3; a++) {
      const double gradient = w / (H * H) * K::slope_over_q(distance / H) * r[a];
      sum.gradient[a] += other.volume * (1.0 + CLUMPING * closeness) * gradient;
      sum.cover -= around.sites.at_rest[j] * r[a] * gradient / dim;
      for (int b = 0; b < 3; b++)
        sum.grad_v[3 * b + a] +=
            other.volume * (around.velocity[3 * j + b] - around.velocity[b]) * gradient;
    }
  }
  return sum;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(shifting)

// whole groups, and groups that are filled up
BOOST_DATA_TEST_CASE(sums_are_those_of_the_formulas,
                     data::make({0, 1, 3, 4, 7, 30, 101}) * data::make({2, 3}), n, dim)
{
  for (const KernelName name : ALL_KERNELS)
    with_kernel(name, [&, n = n, dim = dim](auto kernel) {
      using K = decltype(kernel);
      const Around around(n);
      const NeighborSpan near{around.near.data(), n};
      const KernelScale scale = kernel_scale<K>(H, dim);
      ConcentrationGradient found;
      add_neighbors<K>(found, around.sites, 0, near,
                       {scale, 1.0 / K::shape(SPACING / H), CLUMPING, dim});
      add_velocities<K>(found, around.sites, 0, near, scale, around.velocity.data());
      const ConcentrationGradient plain = plain_sums<K>(around, dim);
      BOOST_TEST(std::fabs(found.cover - plain.cover) < 1e-12 * (1.0 + std::fabs(plain.cover)));
      for (int a = 0; a < 3; a++)
        BOOST_TEST(std::fabs(found.gradient[a] - plain.gradient[a]) < 1e-11);
      for (int a = 0; a < 9; a++) BOOST_TEST(std::fabs(found.grad_v[a] - plain.grad_v[a]) < 1e-11);
      if (n == 101) {
        BOOST_TEST(plain.cover > 0.1);
        BOOST_TEST(std::fabs(plain.gradient[0]) > 1e-3);
      }
    });
}

// what one type adds is added to what another has
BOOST_AUTO_TEST_CASE(types_add_up)
{
  const Around around(30);
  const ShiftTerms terms{kernel_scale<WendlandC2>(H, 3), 1.0 / WendlandC2::shape(SPACING / H),
                         CLUMPING, 3};
  ConcentrationGradient whole, parts;
  add_neighbors<WendlandC2>(whole, around.sites, 0, {around.near.data(), 30}, terms);
  add_neighbors<WendlandC2>(parts, around.sites, 0, {around.near.data(), 13}, terms);
  add_neighbors<WendlandC2>(parts, around.sites, 0, {around.near.data() + 13, 17}, terms);
  BOOST_TEST(parts.cover == whole.cover, boost::test_tools::tolerance(1e-13));
  for (int a = 0; a < 3; a++) BOOST_TEST(std::fabs(parts.gradient[a] - whole.gradient[a]) < 1e-12);
}

BOOST_AUTO_TEST_CASE(a_displacement_is_cut)
{
  std::array<double, 3> shift{3.0, 0.0, -4.0};
  BOOST_TEST(!cut_to(shift, 5.0));
  BOOST_TEST(cut_to(shift, 1.0));
  BOOST_TEST(std::fabs(shift[0] - 0.6) < 1e-15);
  BOOST_TEST(std::fabs(shift[2] + 0.8) < 1e-15);
}

BOOST_AUTO_TEST_SUITE_END()
