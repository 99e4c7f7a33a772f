// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/neighbor/dual_lists.h"

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

using namespace sphcloth;

namespace {

constexpr double SUPPORT = 0.2, SKIN = 0.06;

struct Walk {
  std::mt19937 generator{11};
  std::vector<double> x;
  std::vector<int> type;
  int n;

  explicit Walk(int n_) : n(n_)
  {
    std::uniform_real_distribution<> u(0.0, 1.0);
    for (int i = 0; i < 3 * n; i++) x.push_back(u(generator));
    for (int i = 0; i < n; i++) type.push_back(1 + i % 2);
  }
  void move(double by)
  {
    std::uniform_real_distribution<> u(-by, by);
    for (double &c : x) c += u(generator);
  }
};

// how many of those inside the support are missing in the front of a list

int missing(const DualLists &lists, const Walk &w, int i, int t)
{
  const int slot = lists.slot(i);
  const NeighborSpan front = lists(slot, t);
  int n = 0;
  for (int j = 0; j < w.n; j++) {
    if (j == i || w.type[j] != t) continue;
    double r_sq = 0.0;
    for (int d = 0; d < 3; d++) r_sq += std::pow(w.x[3 * i + d] - w.x[3 * j + d], 2);
    if (r_sq < SUPPORT * SUPPORT)
      n += std::find(front.of, front.of + front.n, j) == front.of + front.n;
  }
  return n;
}

struct Watched {
  Walk walk;
  int owned;
  std::vector<double> v;
  DualLists lists;
  // types 1 and 2; type 2 does not interact with itself
  const std::vector<double> support{0, 0, 0, 0, SUPPORT, SUPPORT, 0, SUPPORT, 0};

  explicit Watched(double skin = SKIN, int n = 300) : walk(n), owned(2 * n / 3)
  {
    build(0.0, {1.0, 1.0, 1.0}, skin);
  }
  // all velocities up to this
  void build(double fastest, const std::vector<double> &interval, double skin = SKIN)
  {
    std::uniform_real_distribution<> u(-fastest, fastest);
    v.resize(walk.x.size());
    for (double &component : v) component = u(walk.generator);
    lists.build(points(), support.data(), skin, {3, v.data(), 1.0, interval});
  }
  void follow() { lists.follow(points()); }
  Points points() const { return {walk.x.data(), walk.type.data(), owned, walk.n, 2}; }
  double inner_skin(int id, int t) { return lists.inner_skin(lists.slot(id - 1), t); }
  int total_inner_neighbors(int id, int t)
  {
    int n = 0;
    for (int i = id - 1; i < owned; i += 2) {
      lists.refresh(lists.slot(i));
      n += lists(lists.slot(i), t).n;
    }
    return n;
  }
  // the largest number of neighbors that the fronts hold, and whether none is missing
  int check(int every)
  {
    int longest = 0;
    for (int i = 0; i < owned; i += every) {
      lists.refresh(lists.slot(i));
      for (int t = 1; t <= 2; t++) {
        if (walk.type[i] == 2 && t == 2) continue;
        BOOST_CHECK(missing(lists, walk, i, t) == 0);
        longest = std::max(longest, lists(lists.slot(i), t).n);
      }
    }
    return longest;
  }
};

}    // namespace

BOOST_AUTO_TEST_SUITE(dual_lists)

BOOST_AUTO_TEST_CASE(inner_list_holds_all_within_the_support_while_particles_move)
{
  Watched w;
  for (int step = 0; step < 30; step++) {
    if (step) w.walk.move(5e-4);
    w.follow();
    w.check(1);
  }
  BOOST_CHECK(w.inner_skin(1, 1) > 0.0 && w.inner_skin(1, 1) < 0.5 * SKIN);
}

BOOST_AUTO_TEST_CASE(inner_list_leaves_out_what_is_outside_its_skin)
{
  constexpr double MOVE = 0.004;    // more than the first skin, so that lists are pruned
  Watched w;
  w.walk.move(MOVE);
  w.follow();
  int n = 0;
  for (int i = 0; i < w.owned; i++) {
    const int slot = w.lists.slot(i);
    w.lists.refresh(slot);
    const double reach = SUPPORT + w.lists.inner_skin(slot, 1) + 2 * std::sqrt(3.0) * MOVE;
    BOOST_CHECK(reach < SUPPORT + SKIN);
    const NeighborSpan front = w.lists(slot, 1);
    for (const int *j = front.of; j < front.of + front.n; j++, n++) {
      double r_sq = 0.0;
      for (int d = 0; d < 3; d++) r_sq += std::pow(w.walk.x[3 * i + d] - w.walk.x[3 * *j + d], 2);
      BOOST_CHECK(r_sq < reach * reach);
    }
  }
  BOOST_CHECK(n > 0);
}

BOOST_AUTO_TEST_CASE(a_list_that_is_pruned_late_is_as_good_as_one_pruned_at_once)
{
  Watched w;
  for (int step = 0; step < 40; step++) {
    if (step) w.walk.move(3e-4);
    w.follow();
    w.check(1 + step % 7);
  }
}

BOOST_AUTO_TEST_CASE(inner_skin_is_wider_the_slower_particles_move)
{
  double before = 1.0;
  for (double by : {8e-3, 1e-3, 1e-5}) {
    Watched w;
    for (int step = 0; step < 4; step++) {
      if (step) w.walk.move(by);
      w.follow();
    }
    BOOST_CHECK(w.inner_skin(1, 1) < before);
    w.check(1);
    before = by > 5e-3 ? 1.0 : w.inner_skin(1, 1);
    if (by > 5e-3) BOOST_CHECK(w.inner_skin(1, 1) == 0.0);
  }
}

BOOST_AUTO_TEST_CASE(types_that_do_not_interact_have_an_empty_inner_list)
{
  Watched w;
  w.follow();
  w.lists.refresh(w.lists.slot(1));
  BOOST_CHECK(w.walk.type[1] == 2);
  BOOST_CHECK(w.lists(w.lists.slot(1), 2).n == 0);
  BOOST_CHECK(w.lists(w.lists.slot(1), 1).n > 0);
}

// Types 3 and 30 of 32 instead of 1 and 2 of 2: the same lists, in as much memory.

BOOST_AUTO_TEST_CASE(types_without_particles_take_no_memory)
{
  constexpr int N = 300, OWNED = 200, TYPES = 32;
  const std::array<int, 3> among{0, 3, 30};
  Walk few(N), many(N);
  for (int &t : many.type) t = among[t];
  const std::vector<double> support{0, 0, 0, 0, SUPPORT, SUPPORT, 0, SUPPORT, 0};
  std::vector<double> of_many((TYPES + 1) * (TYPES + 1), SUPPORT);
  for (int t = 1; t <= 2; t++)
    for (int other = 1; other <= 2; other++)
      of_many[among[t] * (TYPES + 1) + among[other]] = support[3 * t + other];
  std::vector<double> interval(TYPES + 1, 7.0);
  interval[3] = interval[30] = 1.0;
  const auto points = [&](const Walk &w, int types) -> Points {
    return {w.x.data(), w.type.data(), OWNED, N, types};
  };
  DualLists lists, others;
  lists.build(points(few, 2), support.data(), SKIN, {3, nullptr, 1.0, {1.0, 1.0, 1.0}});
  others.build(points(many, TYPES), of_many.data(), SKIN, {3, nullptr, 1.0, interval});
  BOOST_CHECK(others.present_types() == (std::vector<int>{3, 30}));
  BOOST_CHECK(others.bytes() < 1.02 * lists.bytes());
  BOOST_CHECK(others.begin(1) == 0 && others.begin(4) == lists.begin(2));
  BOOST_CHECK(others.begin(TYPES + 1) == lists.begin(3));
  const std::vector<int> value(N, 5);
  for (int step = 0; step < 30; step++) {
    few.move(2e-3);
    many.x = few.x;
    lists.follow(points(few, 2));
    others.follow(points(many, TYPES));
    for (int i = 0; i < OWNED; i++) {
      const int slot = lists.slot(i);
      BOOST_REQUIRE(others.slot(i) == slot);
      lists.refresh(slot);
      others.refresh(slot);
      for (int t = 1; t <= 2; t++) {
        const NeighborSpan one = lists(slot, t), other = others(slot, among[t]);
        BOOST_REQUIRE(std::vector<int>(one.of, one.of + one.n) ==
                      std::vector<int>(other.of, other.of + other.n));
        BOOST_CHECK(others.inner_skin(slot, among[t]) == lists.inner_skin(slot, t));
      }
      BOOST_CHECK(others(slot, 17).n == 0 && !others.any_below(9, slot, 17, value.data(), false));
      BOOST_CHECK(!others.any_above(1, slot, 17, value.data(), false));
      BOOST_CHECK(others.any_above(1, slot, 3, value.data(), false) == (others(slot, 3).n > 0));
    }
  }
}

BOOST_AUTO_TEST_CASE(inner_list_is_right_as_soon_as_lists_are_built)
{
  Watched slow, fast;
  slow.build(1e-5, {1.0, 1.0, 1.0});
  fast.build(1e-3, {1.0, 1.0, 1.0});
  slow.check(1);
  BOOST_CHECK(slow.inner_skin(1, 1) > 0.0);
  BOOST_CHECK(fast.inner_skin(1, 1) > slow.inner_skin(1, 1));
  BOOST_CHECK(fast.total_inner_neighbors(1, 1) > slow.total_inner_neighbors(1, 1));
}

BOOST_AUTO_TEST_CASE(inner_skin_is_wider_for_particles_that_are_evaluated_seldom)
{
  Watched w;
  w.build(1e-4, {1.0, 4.0, 1.0});
  BOOST_CHECK(w.inner_skin(1, 1) > w.inner_skin(2, 1));
}

BOOST_AUTO_TEST_CASE(particles_that_move_together_keep_their_lists)
{
  Watched w(0.5 * SUPPORT);
  const double resting = w.inner_skin(1, 1);
  const int fronts = w.total_inner_neighbors(1, 1);
  for (int step = 0; step < 40; step++) {
    for (double &x : w.walk.x) x += 0.01;
    w.follow();
    w.check(5);
    BOOST_CHECK(w.total_inner_neighbors(1, 1) == fronts);
  }
  BOOST_CHECK(w.inner_skin(1, 1) == resting);
}

// No list is built anew from outside: particles go as far as they may, half the skin at most.
BOOST_AUTO_TEST_CASE(lists_are_rebuilt_where_particles_have_come_nearer)
{
  for (double by : {5e-3, 2e-2}) {
    Watched w(1.5 * SUPPORT);
    const double before = w.lists.bytes();
    for (double gone = 0.0; gone + by < 0.75 * SUPPORT / std::sqrt(3.0); gone += by) {
      w.walk.move(by);
      w.follow();
      w.check(1);
    }
    BOOST_CHECK(w.lists.bytes() > before);
  }
}

// In a long thin box stripes go towards each other: most particles have neighbors that move alike.
BOOST_AUTO_TEST_CASE(particles_from_a_block_beside_are_seen)
{
  constexpr double LENGTH = 12.0;
  for (double stripe : {0.55, 1.1, 1.3, 1.5, 1.7}) {
    const double skin = stripe < 1.0 ? SKIN : 0.75 * SUPPORT;
    Watched w(skin, 1500);
    for (int i = 0; i < w.walk.n; i++) {
      w.walk.x[3 * i] *= LENGTH;
      for (int d = 1; d < 3; d++) w.walk.x[3 * i + d] *= SUPPORT;
    }
    w.build(0.0, {1.0, 1.0, 1.0}, skin);
    const std::vector<double> start = w.walk.x;
    for (int step = 0; step < 30; step++) {
      for (int i = 0; i < w.walk.n; i++)
        w.walk.x[3 * i] +=
            (std::fmod(start[3 * i], 2.0 * stripe) < stripe ? 0.5 : -0.5) * skin / 30;
      w.follow();
      w.check(3);
    }
  }
}

BOOST_AUTO_TEST_CASE(particles_that_approach_along_one_axis_are_seen)
{
  for (int d = 0; d < 3; d++) {
    Watched w;
    for (int step = 0; step < 60; step++) {
      for (int i = 0; i < w.walk.n; i++) w.walk.x[3 * i + d] += i % 4 < 2 ? 4e-4 : -4e-4;
      w.follow();
      w.check(1 + step % 3);
    }
  }
}

// In a box that is a million supports wide: distances in single precision are rounded by a part
// of the support.

BOOST_AUTO_TEST_CASE(none_is_missing_where_distances_are_rounded)
{
  constexpr double APART = 1e6 * SUPPORT, WIDE = 1.5 * SUPPORT, BY = 5e-3;
  for (int d = 0; d < 3; d++) {
    Watched w(WIDE);
    for (int i = 0; i < w.walk.n; i += 3) w.walk.x[3 * i + (d + 1) % 3] += APART;
    w.build(0.0, {1.0, 1.0, 1.0}, WIDE);
    for (double gone = 0.0; gone + BY < 0.5 * WIDE; gone += BY) {
      for (int i = 0; i < w.walk.n; i++) w.walk.x[3 * i + d] += i % 4 < 2 ? BY : -BY;
      w.follow();
      w.check(1);
    }
  }
}

// A length in other units, where the support is 1: the same lists.

BOOST_AUTO_TEST_CASE(lists_do_not_depend_on_the_unit_of_length)
{
  constexpr double SMALL = 0.25;    // the support; a power of 2, so that nothing is rounded
  Walk small(300), large(300);
  const auto of = [](const Walk &w) -> Points { return {w.x.data(), w.type.data(), 200, 300, 2}; };
  const auto in_units = [&] {
    for (std::size_t k = 0; k < small.x.size(); k++) large.x[k] = small.x[k] / SMALL;
  };
  const std::vector<double> support(9, SMALL), one(9, 1.0);
  DualLists lists, others;
  in_units();
  lists.build(of(small), support.data(), 0.3 * SMALL, {3, nullptr, 1.0, {1.0, 1.0, 1.0}});
  others.build(of(large), one.data(), 0.3, {3, nullptr, 1.0, {1.0, 1.0, 1.0}});
  for (int step = 0; step < 20; step++) {
    small.move(2e-3);
    in_units();
    lists.follow(of(small));
    others.follow(of(large));
    for (int slot = 0; slot < 200; slot++) {
      lists.refresh(slot);
      others.refresh(slot);
      for (int t = 1; t <= 2; t++) BOOST_CHECK(lists(slot, t).n == others(slot, t).n);
    }
  }
}

// Type 2 moves on and on, type 1 rests.

BOOST_AUTO_TEST_CASE(inner_lists_of_particles_at_rest_stay_while_others_move)
{
  Watched w;
  const double resting = w.inner_skin(1, 1);
  const int among_each_other = w.total_inner_neighbors(1, 1);
  for (int step = 0; step < 60; step++) {
    if (step)
      for (int i = 1; i < w.walk.n; i += 2) w.walk.x[3 * i] += 4e-4;
    w.follow();
    w.check(1 + step % 3);
    BOOST_CHECK(w.total_inner_neighbors(1, 1) == among_each_other);
  }
  BOOST_CHECK(w.inner_skin(1, 1) == resting);
}

BOOST_AUTO_TEST_SUITE_END()
