// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pbd/substep_groups.h"

#include <boost/test/unit_test.hpp>

#include <limits>
#include <vector>

using sphcloth::SubstepGroups;

namespace {

std::vector<int> done(const SubstepGroups &groups)
{
  std::vector<int> of;
  for (int n = 0; n < groups.substeps; n++) of.push_back(groups.done_in(n));
  return of;
}

void check(int substeps, double dt, double longest, const std::vector<int> &expected)
{
  const std::vector<int> found = done({substeps, dt, longest});
  BOOST_CHECK_EQUAL_COLLECTIONS(found.begin(), found.end(), expected.begin(), expected.end());
}

}    // namespace

BOOST_AUTO_TEST_SUITE(test_substep_groups)

BOOST_AUTO_TEST_CASE(the_middle_substep_of_a_group_stands_for_all)
{
  check(5, 1.0, 1.0, {0, 0, 5, 0, 0});
  check(6, 1.0, 0.5, {0, 3, 0, 0, 3, 0});
  check(5, 1.0, 0.5, {2, 0, 0, 3, 0});
  check(3, 1.0, 0.2, {1, 1, 1});
}

BOOST_AUTO_TEST_CASE(no_group_is_longer_than_allowed_but_for_one_substep)
{
  constexpr double INFINITE = std::numeric_limits<double>::infinity();
  check(4, 2.0, INFINITE, {0, 4, 0, 0});
  check(4, 2.0, 2.0, {0, 4, 0, 0});
  check(4, 2.0, 1.99, {2, 0, 2, 0});
  check(4, 2.0, 0.51, {1, 1, 1, 1});
  check(4, 2.0, 0.0, {1, 1, 1, 1});
  check(1, 2.0, 0.0, {1});
  check(4, 0.0, 1.0, {0, 4, 0, 0});    // nothing decays
}

BOOST_AUTO_TEST_CASE(every_substep_is_in_one_group)
{
  for (int substeps = 1; substeps < 60; substeps++)
    for (int groups = 1; groups <= substeps; groups++) {
      SubstepGroups some;
      some.substeps = substeps;
      some.groups = groups;
      int sum = 0, count = 0, shortest = substeps, longest = 0;
      for (const int size : done(some)) {
        if (!size) continue;
        sum += size;
        count++;
        shortest = std::min(shortest, size);
        longest = std::max(longest, size);
      }
      BOOST_TEST(sum == substeps);
      BOOST_TEST(count == groups);
      BOOST_TEST(longest - shortest <= 1);
      BOOST_TEST(some.are_single() == (groups == substeps));
      BOOST_TEST((some.last_size() == shortest || some.last_size() == longest));
    }
}

BOOST_AUTO_TEST_SUITE_END()
