// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/geometry/displacements.h"

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <limits>
#include <vector>

using namespace sphcloth;

namespace {

// points, and where they were: the one with a number has come by (3, 4, 12) times `factor`

struct Points {
  std::vector<double> x, x0, y0, z0;

  Points(int n, int longest, double factor)
  {
    for (int i = 0; i < n; i++) {
      const double by = i == longest ? factor : 0.5 * factor;
      x0.push_back(0.1 * i);
      y0.push_back(-0.2 * i);
      z0.push_back(1.0);
      x.insert(x.end(), {x0[i] + 3.0 * by, y0[i] - 4.0 * by, z0[i] + 12.0 * by});
    }
  }
  double longest() const
  {
    return longest_displacement(static_cast<int>(x0.size()), x.data(), x0.data(), y0.data(),
                                z0.data());
  }
};

}    // namespace

BOOST_AUTO_TEST_SUITE(displacements)

BOOST_AUTO_TEST_CASE(longest_of_all_wherever_it_is)
{
  for (int n : {1, 7, 8, 33})
    for (int longest = 0; longest < n; longest++)
      BOOST_TEST(Points(n, longest, 0.25).longest() == 13.0 * 0.25,
                 boost::test_tools::tolerance(1e-14));
  BOOST_TEST(Points(20, 3, 0.0).longest() == 0.0);
  BOOST_TEST(Points(0, -1, 1.0).longest() == 0.0);
}

BOOST_AUTO_TEST_CASE(infinite_with_what_is_no_number)
{
  for (double wrong :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200})
    for (int i : {0, 5, 16}) {
      Points points(17, 3, 0.25);
      points.x[3 * i + 1] = wrong;
      BOOST_TEST(std::isinf(points.longest()));
    }
}

BOOST_AUTO_TEST_SUITE_END()
