// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/air/wind_shadow.h"

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <random>
#include <vector>

using namespace sphcloth;
using Eigen::Vector3d;
using Triangle = std::array<Vector3d, 3>;

BOOST_AUTO_TEST_SUITE(wind_shadow)

// shares of triangles that have their corners for themselves

struct Seen {
  WindShadow shadow;
  std::vector<WindShadow::Corners> corners;

  Seen(const std::vector<Triangle> &triangles, const Vector3d &wind)
  {
    std::vector<WindShadow::Point> points;
    for (const Triangle &t : triangles) {
      const int first = static_cast<int>(points.size());
      corners.push_back({first, first + 1, first + 2});
      for (const Vector3d &x : t) points.push_back({x[0], x[1], x[2]});
    }
    shadow.build(points, corners, wind);
  }

  double lee_share(int t) const { return shadow.lee_share(corners[t]); }
};

BOOST_AUTO_TEST_CASE(a_sheet_has_no_lee_in_itself)
{
  std::vector<Triangle> sheet;
  const auto at = [](int i, int j) { return Vector3d(0.1 * i, 0.1 * j, 0.05 * i); };
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++) {
      sheet.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      sheet.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  for (const Vector3d &wind : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(3, 2, -1)}) {
    const Seen seen(sheet, wind);
    for (int t = 0; t < static_cast<int>(sheet.size()); t++) BOOST_TEST(seen.lee_share(t) == 0.0);
  }
}

BOOST_AUTO_TEST_CASE(what_is_behind_is_in_the_lee_and_what_is_before_or_beside_is_not)
{
  const Triangle front{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
  const auto share_of_moved = [&](const Vector3d &by, const Vector3d &wind) {
    return Seen({front, {front[0] + by, front[1] + by, front[2] + by}}, wind).lee_share(1);
  };
  const Vector3d up(0, 0, 2), down(0, 0, -1);
  BOOST_TEST(share_of_moved({0, 0, 3}, up) == 1.0);
  BOOST_TEST(share_of_moved({0, 0, -3}, up) == 0.0);
  BOOST_TEST(share_of_moved({1.1, 0, 3}, up) == 0.0);
  BOOST_TEST(share_of_moved({0, 0, 0}, up) == 0.0);
  // two of the three points, (2/3, 1/6) and (1/6, 2/3), are beyond the slanted side
  BOOST_TEST(share_of_moved({0.25, 0, 3}, up) == 1.0 / 3.0);
  BOOST_TEST(share_of_moved({0, 0, 3}, down) == 0.0);
  BOOST_TEST(share_of_moved({0, 0, -3}, down) == 1.0);
  // edge-on it hides nothing
  BOOST_TEST(share_of_moved({0, -3, 0}, {0, -1, 0}) == 0.0);
}

BOOST_AUTO_TEST_CASE(the_picture_has_a_depth_and_triangles_a_size_whatever_the_axes)
{
  const Triangle one{Vector3d(0, 0, 1), Vector3d(0.3, 0, 1), Vector3d(0, 0.4, 1)};
  const Triangle other{Vector3d(0, 0, 4), Vector3d(0.6, 0, 5), Vector3d(0, 0.8, 4)};
  Eigen::Matrix3d cyclic;
  cyclic << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  const Eigen::Matrix3d oblique(Eigen::AngleAxisd(0.5, Vector3d(1, 2, -3).normalized()));
  for (const Eigen::Matrix3d &turn :
       {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), cyclic, oblique}) {
    const auto turned = [&](const Triangle &t) {
      return Triangle{turn * t[0], turn * t[1], turn * t[2]};
    };
    const Seen seen({turned(one), turned(other)}, turn * Vector3d(0, 0, 5));
    BOOST_TEST(seen.shadow.mean_size() == 0.6, boost::test_tools::tolerance(1e-12));
    BOOST_TEST(seen.shadow.depth() == 4.0, boost::test_tools::tolerance(1e-12));
  }
  const Seen none({}, Vector3d(1, 0, 0));
  BOOST_TEST(none.shadow.mean_size() == 0.0);
  BOOST_TEST(none.shadow.depth() == 0.0);
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
  const Seen seen(all, wind);
  const auto meets = [&](const Vector3d &from, const Triangle &t) {
    Eigen::Matrix3d of;    // from - s wind = a + u (b - a) + v (c - a)
    of << wind, t[1] - t[0], t[2] - t[0];
    const Vector3d s = of.fullPivLu().solve(from - t[0]);
    return s[0] > 1e-9 && s[1] >= 0.0 && s[2] >= 0.0 && s[1] + s[2] <= 1.0;
  };
  int hidden = 0;
  for (int k = 0; k < static_cast<int>(all.size()); k++) {
    const Triangle &t = all[k];
    int n = 0;
    for (const Vector3d &corner : t) {
      const Vector3d p = 0.5 * ((t[0] + t[1] + t[2]) / 3.0 + corner);
      bool any = false;
      for (const Triangle &other : all) any = any || (&other != &t && meets(p, other));
      n += any;
    }
    hidden += n;
    BOOST_TEST(seen.lee_share(k) == n / 3.0);
  }
  BOOST_TEST(hidden > 10);
  BOOST_TEST(hidden < 150);
}

BOOST_AUTO_TEST_SUITE_END()
