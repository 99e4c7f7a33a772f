// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/mesh_patches.h"

#include "core/contact/closest_points.h"

#include <Eigen/Geometry>
#include <boost/test/unit_test.hpp>

#include <limits>
#include <random>

using namespace sphcloth;

namespace {

constexpr int ACROSS = 12, LAYERS = 2;

// two square sheets, one above the other

struct Sheets {
  std::vector<Vec3> x;
  MeshPatches::Triangles triangles;

  explicit Sheets(double gap)
  {
    for (int layer = 0; layer < LAYERS; layer++) {
      const int first = static_cast<int>(x.size());
      for (int j = 0; j <= ACROSS; j++)
        for (int i = 0; i <= ACROSS; i++) x.emplace_back(i, j, layer * gap);
      for (int j = 0; j < ACROSS; j++)
        for (int i = 0; i < ACROSS; i++) {
          const int a = first + j * (ACROSS + 1) + i, b = a + 1, c = a + ACROSS + 1;
          triangles.push_back({a, b, c});
          triangles.push_back({b, c + 1, c});
        }
    }
  }
};

double distance(const Sheets &sheets, const std::vector<Vec3> &x, int vertex, int triangle)
{
  const auto &[a, b, c] = sheets.triangles[triangle];
  return closest_points(PairKind::POINT_TRIANGLE, {x[vertex], x[a], x[b], x[c]}).vector.norm();
}

std::vector<Vec3> moved(const std::vector<Vec3> &x, double angle, const Vec3 &shift)
{
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(angle, Vec3(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
  std::vector<Vec3> result;
  for (const Vec3 &at : x) result.emplace_back(turn * at + shift);
  return result;
}

}    // namespace

BOOST_AUTO_TEST_SUITE(mesh_patches)

BOOST_AUTO_TEST_CASE(layers_have_patches_of_their_own)
{
  const Sheets sheets(0.01);
  MeshPatches patches;
  patches.build(sheets.triangles, sheets.x);
  BOOST_TEST(patches.size() >= 2 * 4);
  BOOST_TEST(patches.size() <= static_cast<int>(sheets.x.size()) / 16);
  const int half = static_cast<int>(sheets.x.size()) / 2;
  for (int s = 0; s < half; s++)
    for (int other = half; other < 2 * half; other++)
      BOOST_REQUIRE(patches.patch_of(s) != patches.patch_of(other));
}

BOOST_AUTO_TEST_CASE(how_all_move_and_turn_does_not_count)
{
  const Sheets sheets(1.5);
  MeshPatches patches;
  patches.build(sheets.triangles, sheets.x);
  const std::vector<Vec3> there = moved(sheets.x, 2.0, {5.0, -3.0, 1.0});
  patches.measure(there, there);
  for (int p = 0; p < patches.size(); p++)
    for (int q = 0; q < patches.size(); q++) {
      BOOST_TEST(patches.approach_before(p, q) < 1e-12);
      BOOST_TEST(patches.approach_in_step(p, q) == 0.0);
    }
  BOOST_TEST(patches.approach_of_any(1.0) > 1.0);
}

BOOST_AUTO_TEST_CASE(nothing_comes_nearer_than_the_bounds)
{
  std::mt19937 random_numbers(3);
  std::normal_distribution<double> normal;
  const auto random = [&] {
    return Vec3(normal(random_numbers), normal(random_numbers), normal(random_numbers));
  };
  const Sheets sheets(1.5);
  MeshPatches patches;
  patches.build(sheets.triangles, sheets.x);
  double used = 0.0;
  for (const double noise : {0.0, 0.01, 0.3}) {
    // each sheet turns by another angle, and all vertices by some noise
    std::vector<Vec3> start = moved(sheets.x, 0.2, {1.0, 0.0, 0.0}), end;
    const std::vector<Vec3> other = moved(sheets.x, -0.1, {1.0, 0.5, -1.0});
    for (std::size_t s = start.size() / 2; s < start.size(); s++) start[s] = other[s];
    for (Vec3 &at : start) at += noise * random();
    for (const Vec3 &at : start) end.emplace_back(at + Vec3(0.1, 0, 0) + noise * random());
    patches.measure(start, end);
    for (int s = 0; s < static_cast<int>(start.size()); s += 5)
      for (int t = 0; t < static_cast<int>(sheets.triangles.size()); t++) {
        const int p = patches.patch_of(s), q = patches.patch_of(sheets.triangles[t][0]);
        const double then = distance(sheets, sheets.x, s, t),
                     before = then - distance(sheets, start, s, t),
                     now = then - distance(sheets, end, s, t),
                     bound = patches.approach_before(p, q),
                     bound_now = bound + patches.approach_in_step(p, q);
        BOOST_REQUIRE(before <= bound + 1e-12);
        BOOST_REQUIRE(now <= bound_now + 1e-12);
        BOOST_REQUIRE(now <= patches.approach_of_any(std::numeric_limits<double>::infinity()));
        if (bound > 0.0) used = std::max(used, before / bound);
      }
  }
  BOOST_TEST(used > 0.3);    // they are near
}

BOOST_AUTO_TEST_CASE(from_step_to_step_nothing_comes_nearer_than_the_path)
{
  std::mt19937 random_numbers(5);
  std::normal_distribution<double> normal;
  const Sheets sheets(1.5);
  MeshPatches patches;
  patches.build(sheets.triangles, sheets.x);
  std::vector<Vec3> start = sheets.x;
  std::vector<double> path(patches.size() * patches.size(), 0.0);
  double used = 0.0;
  for (int step = 0; step < 5; step++) {
    for (Vec3 &at : start)
      at += 0.02 * Vec3(normal(random_numbers), normal(random_numbers), normal(random_numbers));
    for (std::size_t s = start.size() / 2; s < start.size(); s++) start[s] -= Vec3(0.0, 0.0, 0.1);
    patches.measure(start, start);
    for (int p = 0; p < patches.size(); p++)
      for (int q = 0; q < patches.size(); q++)
        path[p * patches.size() + q] += patches.approach_since(p, q);
    for (int s = 0; s < static_cast<int>(start.size()); s += 5)
      for (int t = 0; t < static_cast<int>(sheets.triangles.size()); t++) {
        const int p = patches.patch_of(s), q = patches.patch_of(sheets.triangles[t][0]);
        const double nearer = distance(sheets, sheets.x, s, t) - distance(sheets, start, s, t);
        BOOST_REQUIRE(nearer <= path[p * patches.size() + q] + 1e-12);
        used = std::max(used, nearer / path[p * patches.size() + q]);
      }
  }
  BOOST_TEST(used > 0.5);
  // at the same place again nothing is added
  patches.measure(start, start);
  for (int p = 0; p < patches.size(); p++)
    for (int q = 0; q < patches.size(); q++) BOOST_TEST(patches.approach_since(p, q) == 0.0);
}

BOOST_AUTO_TEST_CASE(boxes_hold_whole_triangles)
{
  const Sheets sheets(0.5);
  MeshPatches patches;
  patches.build(sheets.triangles, sheets.x);
  const std::vector<Vec3> there = moved(sheets.x, 0.7, {5.0, -3.0, 1.0});
  patches.start_from(there);
  for (const std::array<int, 3> &t : sheets.triangles)
    for (const int s : t)
      for (const int other : t)
        BOOST_TEST(patches.box(patches.patch_of(s), there).contains(there[other]));
  patches.measure(there, there);
  BOOST_TEST(patches.approach_of_any(1.0) < 1e-12);
}

BOOST_AUTO_TEST_SUITE_END()
