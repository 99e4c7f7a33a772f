// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/neighbor/cell_lists.h"

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

using namespace sphcloth;

namespace {

struct Cloud {
  std::vector<double> x;
  std::vector<int> type;
};

Cloud cloud(int n, int n_types, double a, double b, double c, unsigned seed)
{
  std::mt19937 generator(seed);
  std::uniform_real_distribution<> u(-0.5, 0.5);
  Cloud p;
  for (int i = 0; i < n; i++) {
    for (const double size : {a, b, c}) p.x.push_back(size * u(generator));
    p.type.push_back(1 + i % n_types);
  }
  return p;
}

// all that is nearer than the reach is listed once, nothing that is clearly further

void check_lists(const Cloud &p, int n_owned, int n_types, const std::vector<double> &reach)
{
  const int n = static_cast<int>(p.type.size());
  CellLists lists;
  lists.build({p.x.data(), p.type.data(), n_owned, n, n_types}, reach.data());
  std::set<int> seen;
  for (int t = 1; t <= n_types; t++)
    for (int slot = lists.begin(t); slot < lists.begin(t + 1); slot++) {
      const int i = lists.at(slot);
      seen.insert(i);
      BOOST_CHECK(p.type[i] == t && i < n_owned);
      for (int other = 1; other <= n_types; other++) {
        const double cutoff = reach[t * (n_types + 1) + other];
        std::multiset<int> listed;
        const NeighborSpan s = lists(slot, other);
        listed.insert(s.of, s.of + s.n);
        for (int j = 0; j < n; j++) {
          double r_sq = 0.0;
          for (int d = 0; d < 3; d++) r_sq += std::pow(p.x[3 * i + d] - p.x[3 * j + d], 2);
          const std::size_t count = listed.count(j);
          const bool candidate = j != i && p.type[j] == other && cutoff > 0.0;
          if (candidate && std::sqrt(r_sq) < cutoff)
            BOOST_CHECK(count == 1);
          else if (!candidate || std::sqrt(r_sq) > cutoff * 1.0001 + 1e-5)
            BOOST_CHECK(count == 0);
        }
      }
    }
  BOOST_CHECK(static_cast<int>(seen.size()) == n_owned);
}

// Layers that part every third pair, and count for which they were asked

class EveryThird : public Parting {
 public:
  std::multiset<std::pair<int, int>> asked;

  static bool parts(int i, int j) { return (i + j) % 3 == 0; }
  bool part(int i, int j, Sides, Sides) override
  {
    asked.insert(std::minmax(i, j));
    return parts(i, j);
  }
};

std::multiset<int> listed(const CellLists &lists, int slot, int other)
{
  const NeighborSpan s = lists(slot, other);
  return {s.of, s.of + s.n};
}

// as without layers, but for pairs that they part; returns how many these are

int check_parted(const CellLists &all, const CellLists &parts, int n_types)
{
  int n = 0;
  for (int slot = 0; slot < all.slots(); slot++) {
    BOOST_CHECK(all.at(slot) == parts.at(slot));
    for (int other = 1; other <= n_types; other++) {
      std::multiset<int> expected;
      for (int j : listed(all, slot, other))
        if (EveryThird::parts(all.at(slot), j))
          n++;
        else
          expected.insert(j);
      BOOST_CHECK(listed(parts, slot, other) == expected);
    }
  }
  return n;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(cell_lists)

BOOST_AUTO_TEST_CASE(lists_of_one_type_against_all_pairs)
{
  const std::vector<double> reach{0, 0, 0, 0.21};
  for (unsigned seed : {1u, 2u, 3u}) check_lists(cloud(400, 1, 1, 1, 1, seed), 300, 1, reach);
  check_lists(cloud(300, 1, 1, 1, 0, 4), 300, 1, reach);         // a plane
  check_lists(cloud(200, 1, 300, 2, 0.1, 5), 150, 1, reach);     // far apart
  check_lists(cloud(1, 1, 1, 1, 1, 6), 1, 1, reach);
  check_lists(cloud(60, 1, 0.01, 0.01, 0.01, 7), 60, 1, reach);    // all are neighbors of all
}

BOOST_AUTO_TEST_CASE(lists_of_several_types_each_pair_with_its_reach)
{
  // type 3 lists type 1 but not itself, type 2 and 3 never meet
  const std::vector<double> reach{0, 0, 0, 0, 0, 0.1, 0.15, 0.2, 0, 0.15, 0.25, 0, 0, 0.2, 0, 0};
  check_lists(cloud(500, 3, 1, 1, 1, 8), 400, 3, reach);
}

BOOST_AUTO_TEST_CASE(a_type_without_particles_has_no_neighbors_and_is_none)
{
  const std::vector<double> reach(25, 0.2);
  for (double size : {0.1, 1.0}) {
    Cloud p = cloud(200, 2, size, size, size, 12);
    for (int &t : p.type) t *= 2;    // 2 and 4 of 4
    check_lists(p, 150, 4, reach);
  }
}

BOOST_AUTO_TEST_CASE(no_owned_particle_or_none_at_all)
{
  const std::vector<double> reach{0, 0, 0, 0.21};
  check_lists(cloud(50, 1, 1, 1, 1, 9), 0, 1, reach);
  check_lists(Cloud(), 0, 1, reach);
}

BOOST_AUTO_TEST_CASE(pairs_parted_by_a_sheet_are_left_out_and_no_others)
{
  const Cloud p = cloud(600, 1, 1.0, 1.0, 1.0, 11);
  std::vector<Sides> sides(600, 0);
  for (int i = 0; i < 600; i++) {
    const double z = p.x[3 * i + 2];
    if (std::fabs(z) < 0.3) sides[i] = side_of_sheet(2, z > 0.0);
  }
  const std::vector<double> reach{0, 0, 0, 0.2};
  CellLists all, parts;
  all.build({p.x.data(), p.type.data(), 500, 600, 1}, reach.data());
  parts.build({p.x.data(), p.type.data(), 500, 600, 1, sides.data()}, reach.data());
  int left_out = 0;
  for (int slot = 0; slot < all.slots(); slot++) {
    const NeighborSpan one = all(slot, 1);
    std::multiset<int> expected;
    for (int k = 0; k < one.n; k++)
      if (parted(sides[all.at(slot)], sides[one.of[k]]))
        left_out++;
      else
        expected.insert(one.of[k]);
    BOOST_CHECK(all.at(slot) == parts.at(slot));
    BOOST_CHECK(listed(parts, slot, 1) == expected);
  }
  BOOST_CHECK(left_out > 500);
}

BOOST_AUTO_TEST_CASE(layers_are_asked_once_of_a_pair_of_owned_particles)
{
  const int n = 600, owned = 500;
  const Cloud p = cloud(n, 2, 1.0, 1.0, 1.0, 13);
  const std::vector<Sides> sides(n, NEAR_SHEET | LAYERED);
  const std::vector<double> reach{0, 0, 0, 0, 0.2, 0.15, 0, 0.15, 0.25};
  EveryThird layers;
  CellLists all, parts;
  all.build({p.x.data(), p.type.data(), owned, n, 2}, reach.data());
  parts.build({p.x.data(), p.type.data(), owned, n, 2, sides.data(), &layers}, reach.data());
  BOOST_CHECK(check_parted(all, parts, 2) > 1000);
  BOOST_CHECK(layers.asked.size() > 4000);
  for (const auto &pair : layers.asked) BOOST_CHECK(layers.asked.count(pair) == 1);
}

BOOST_AUTO_TEST_CASE(layers_are_not_asked_again_of_a_pair_that_is_listed)
{
  const int n = 600, owned = 500;
  Cloud p = cloud(n, 1, 1.0, 1.0, 1.0, 14);
  const std::vector<Sides> sides(n, NEAR_SHEET | LAYERED);
  const std::vector<double> reach{0, 0, 0, 0.2};
  EveryThird layers;
  CellLists all, parts;
  all.build({p.x.data(), p.type.data(), owned, n, 1}, reach.data());
  parts.build({p.x.data(), p.type.data(), owned, n, 1, sides.data(), &layers}, reach.data());
  std::vector<std::multiset<int>> before;
  for (int slot = 0; slot < parts.slots(); slot++) before.push_back(listed(parts, slot, 1));
  layers.asked.clear();
  for (int i = 0; i < n; i++) p.x[3 * i] += 0.02 * std::sin(1.0 * i);
  const auto every = [](int, int, int) { return true; };
  std::vector<int> near(owned, 0);
  const std::vector<double> nothing(4, 0.0);
  const std::vector<int> region(n, 0);
  const CellLists::Near inner{nothing.data(), region.data()};
  all.renew({p.x.data(), p.type.data(), owned, n, 1}, reach.data(), inner, near, every);
  parts.renew({p.x.data(), p.type.data(), owned, n, 1, sides.data(), &layers}, reach.data(), inner,
              near, every);
  BOOST_CHECK(check_parted(all, parts, 1) > 1000);
  std::size_t listed_before = 0, n_asked = 0;
  for (int slot = 0; slot < parts.slots(); slot++)
    for (int j : listed(parts, slot, 1)) listed_before += before[slot].count(j);
  for (int slot = 0; slot < all.slots(); slot++) n_asked += listed(all, slot, 1).size();
  BOOST_CHECK(listed_before > 3000);
  BOOST_CHECK(layers.asked.size() == n_asked - listed_before);
}

BOOST_AUTO_TEST_SUITE_END()
