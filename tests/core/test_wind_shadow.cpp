// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/air/wind_shadow.h"

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <random>
#include <vector>

using namespace sphcloth;
using Eigen::Vector3d;
using Triangle = WindShadow::Triangle;

BOOST_AUTO_TEST_SUITE(wind_shadow)

BOOST_AUTO_TEST_CASE(a_sheet_has_no_lee_in_itself)
{
  std::vector<Triangle> sheet;
  const auto at = [](int i, int j) { return Vector3d(0.1 * i, 0.1 * j, 0.05 * i); };
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++) {
      sheet.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      sheet.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  WindShadow shadow;
  for (const Vector3d &wind : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(3, 2, -1)}) {
    shadow.build(sheet, wind);
    for (const Triangle &t : sheet) BOOST_TEST(shadow.lee_share(t) == 0.0);
  }
}

BOOST_AUTO_TEST_CASE(what_is_behind_is_in_the_lee_and_what_is_before_or_beside_is_not)
{
  const Triangle front{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
  const auto moved = [&](const Vector3d &by) {
    return Triangle{front[0] + by, front[1] + by, front[2] + by};
  };
  WindShadow shadow;
  shadow.build({front}, Vector3d(0, 0, 2));
  BOOST_TEST(shadow.lee_share(moved({0, 0, 3})) == 1.0);
  BOOST_TEST(shadow.lee_share(moved({0, 0, -3})) == 0.0);
  BOOST_TEST(shadow.lee_share(moved({1.1, 0, 3})) == 0.0);
  BOOST_TEST(shadow.lee_share(front) == 0.0);
  // two of the three points, (2/3, 1/6) and (1/6, 2/3), are beyond the slanted side
  BOOST_TEST(shadow.lee_share(moved({0.25, 0, 3})) == 1.0 / 3.0);
  shadow.build({front}, Vector3d(0, 0, -1));
  BOOST_TEST(shadow.lee_share(moved({0, 0, 3})) == 0.0);
  // edge-on it hides nothing
  shadow.build({front}, Vector3d(0, -1, 0));
  BOOST_TEST(shadow.lee_share(moved({0, -3, 0})) == 0.0);
  shadow.build({}, Vector3d(1, 0, 0));
  BOOST_TEST(shadow.lee_share(front) == 0.0);
}

// the same by looking at every triangle, along an oblique wind

BOOST_AUTO_TEST_CASE(random_triangles_are_hidden_by_those_that_a_ray_meets)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> in(0.0, 1.0);
  const auto point = [&] { return Vector3d(in(random), in(random), in(random)); };
  std::vector<Triangle> all;
  for (int n = 0; n < 60; n++) {
    const Vector3d at = 3.0 * point();
    all.push_back({at + point(), at + point(), at + point()});
  }
  const Vector3d wind(1.0, -0.4, 0.7);
  WindShadow shadow;
  shadow.build(all, wind);
  const auto meets = [&](const Vector3d &from, const Triangle &t) {
    Eigen::Matrix3d of;    // from - s wind = a + u (b - a) + v (c - a)
    of << wind, t[1] - t[0], t[2] - t[0];
    const Vector3d s = of.fullPivLu().solve(from - t[0]);
    return s[0] > 1e-9 && s[1] >= 0.0 && s[2] >= 0.0 && s[1] + s[2] <= 1.0;
  };
  int hidden = 0;
  for (const Triangle &t : all) {
    int n = 0;
    for (const Vector3d &corner : t) {
      const Vector3d p = 0.5 * ((t[0] + t[1] + t[2]) / 3.0 + corner);
      bool any = false;
      for (const Triangle &other : all) any = any || (&other != &t && meets(p, other));
      n += any;
    }
    hidden += n;
    BOOST_TEST(shadow.lee_share(t) == n / 3.0);
  }
  BOOST_TEST(hidden > 10);
  BOOST_TEST(hidden < 150);
}

BOOST_AUTO_TEST_SUITE_END()
