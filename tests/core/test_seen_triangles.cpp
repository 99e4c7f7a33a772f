// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/seen_triangles.h"
#include "core/contact/sheet_layers.h"

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <random>
#include <vector>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(seen_triangles)

BOOST_AUTO_TEST_CASE(no_crossed_triangle_is_missed_and_hardly_any_other_is_found)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto vec = [&] { return Vec3(any(random), any(random), any(random)); };
  SeenTriangles seen;
  int crossed = 0, found = 0;
  for (int n = 0; n < 400; n++) {
    const Vec3 p = 0.5 * vec();
    std::vector<SheetLayers::Triangle> triangles;
    for (int t = 0; t < n % 30; t++) {
      const Vec3 at = vec();
      const double size = t % 7 == 0 ? 20.0 : 0.7;    // also slender and large ones
      triangles.push_back({at, at + size * vec(), at + (t % 5 == 0 ? 0.02 : 1.0) * vec()});
    }
    seen.clear();
    for (int t = 0; t < static_cast<int>(triangles.size()); t++) {
      const auto &[a, b, c] = triangles[t];
      seen.add(10 * t, a - p, b - p, c - p);
    }
    seen.fill_up();
    for (int k = 0; k < 50; k++) {
      Vec3 q = vec();
      const int through = triangles.empty() ? 0 : k % static_cast<int>(triangles.size());
      if (k % 2 && !triangles.empty()) {    // through an edge, or a corner
        const auto &[a, b, c] = triangles[through];
        q = p + 1.5 * ((k % 4 == 1 ? a : Vec3(0.3 * a + 0.7 * b)) - p);
      }
      const std::vector<int> may = seen.may_cross(q - p);
      BOOST_REQUIRE(std::is_sorted(may.begin(), may.end()));
      for (const int number : may) BOOST_REQUIRE(number % 10 == 0);
      for (int t = 0; t < static_cast<int>(triangles.size()); t++) {
        const auto &[a, b, c] = triangles[t];
        if (!crosses(p, q, a, b, c)) continue;
        crossed++;
        BOOST_REQUIRE(std::binary_search(may.begin(), may.end(), 10 * t));
      }
      found += static_cast<int>(may.size());
    }
  }
  BOOST_CHECK(crossed > 5000);
  BOOST_CHECK_LE(found, crossed + crossed / 1000);
}

BOOST_AUTO_TEST_CASE(a_line_in_the_plane_or_that_ends_on_it_crosses_nothing)
{
  SeenTriangles seen;
  BOOST_CHECK(seen.may_cross(Vec3(1, 0, 0)).empty() && seen.bytes() >= 0.0);
  seen.add(3, Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(3, 0, 0));
  seen.add(4, Vec3(1, -1, -1), Vec3(1, 1, -1), Vec3(1, 0, 2));
  seen.fill_up();
  BOOST_CHECK(seen.may_cross(Vec3(0.9, 0, 0)).empty());
  BOOST_CHECK(seen.may_cross(Vec3(1.1, 0, 0)) == std::vector<int>{4});
  BOOST_CHECK(seen.may_cross(Vec3(-5, 0, 0)).empty());
  seen.clear();
  seen.fill_up();
  BOOST_CHECK(seen.may_cross(Vec3(1.1, 0, 0)).empty());
}

BOOST_AUTO_TEST_SUITE_END()
