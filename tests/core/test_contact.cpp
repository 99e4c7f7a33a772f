#include "check.h"
#include "core/geometry/box_grid.h"
#include "core/contact/point_triangle.h"
#include "core/geometry/disc_grid.h"
#include "core/contact/sheet_sides.h"

#include <limits>
#include <random>
#include <set>

using namespace sphcloth;

namespace {

std::array<Sweep, 3> resting_triangle(double z = 0.0)
{
  const Vec3 a(0, 0, z), b(1, 0, z), c(0, 1, z);
  return {Sweep{a, a}, Sweep{b, b}, Sweep{c, c}};
}

}    // namespace

CASE("cubic: all roots in (0, 1], in order")
{
  // (t - .1)(t - .5)(t - .9)
  const Roots r = cubic_roots(-0.045, 0.59, -1.5, 1.0);
  CHECK(r.n == 3);
  CHECK_NEAR(r.t[0], 0.1, 1e-12);
  CHECK_NEAR(r.t[1], 0.5, 1e-12);
  CHECK_NEAR(r.t[2], 0.9, 1e-12);
  CHECK(cubic_roots(-0.5, 1.0, 0.0, 0.0).n == 1);
  CHECK_NEAR(cubic_roots(-0.5, 1.0, 0.0, 0.0).t[0], 0.5, 1e-14);
  CHECK(cubic_roots(1.0, 0.0, 0.0, 0.0).n == 0);
  CHECK(cubic_roots(0.25, -1.0, 0.0, 0.0).n == 1);
}

CASE("touch: through the middle, from both sides, at any speed")
{
  for (double side : {1.0, -1.0})
    for (double speed : {0.02, 1.0, 1000.0}) {
      const Sweep p{{0.3, 0.1, side * 0.01}, {0.3, 0.1, side * (0.01 - speed)}};
      const Touch t = touch(p, resting_triangle(), 1e-3);
      CHECK(t.hit);
      CHECK(t.through == (speed > 0.01));
      CHECK_NEAR(t.normal[2], side, 1e-15);
      CHECK_NEAR(t.depth, speed - 0.01 + 1e-3, 1e-9 * speed);
      CHECK_NEAR((t.weight - Vec3(0.6, 0.3, 0.1)).norm(), 0.0, 1e-9);
    }
}

CASE("touch: past the edge, away, along and short of it do not count")
{
  CHECK(!touch({{0.8, 0.8, 0.1}, {0.8, 0.8, -0.1}}, resting_triangle(), 1e-3).hit);
  CHECK(!touch({{0.2, 0.2, 0.1}, {0.2, 0.2, 0.3}}, resting_triangle(), 1e-3).hit);
  CHECK(!touch({{0.2, 0.2, 0.1}, {0.3, 0.2, 0.1}}, resting_triangle(), 1e-3).hit);
  CHECK(!touch({{0.2, 0.2, 0.1}, {0.2, 0.2, 0.01}}, resting_triangle(), 1e-3).hit);
}

CASE("touch: inside the thickness the gap may not shrink and is never widened")
{
  const Touch nearer = touch({{0.2, 0.2, 4e-4}, {0.2, 0.2, 3e-4}}, resting_triangle(), 1e-3);
  CHECK(nearer.hit);
  CHECK(!nearer.through);
  CHECK_NEAR(nearer.depth, 1e-4, 1e-12);
  CHECK(!touch({{0.2, 0.2, 4e-4}, {0.25, 0.2, 4e-4}}, resting_triangle(), 1e-3).hit);
  CHECK(!touch({{0.2, 0.2, 4e-4}, {0.2, 0.2, 5e-4}}, resting_triangle(), 1e-3).hit);
}

CASE("touch: a triangle that sweeps over a resting point, also one that turns")
{
  const Vec3 rest(0.2, 0.2, 0.0);
  std::array<Sweep, 3> falling = resting_triangle(0.5);
  for (Sweep &s : falling) s.end[2] = -0.5;
  CHECK(touch({rest, rest}, falling, 1e-3).hit);
  std::array<Sweep, 3> turning = resting_triangle(0.05);
  turning[1].end = Vec3(1, 0, -2);
  turning[2].end = Vec3(0, 1, -2);
  CHECK(touch({rest, rest}, turning, 1e-3).hit);
}

CASE("touch: no seam between two triangles")
{
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  const Vec3 a(0, 0, 0.1), b(1, 0, 0.3), c(1, 1, -0.2), d(0, 1, 0.4);
  const std::array<Sweep, 3> t1 = {Sweep{a, a}, Sweep{b, b}, Sweep{c, c}};
  const std::array<Sweep, 3> t2 = {Sweep{a, a}, Sweep{c, c}, Sweep{d, d}};
  for (int k = 0; k < 10000; k++) {
    const double s = u(generator);    // points right on the shared edge
    const Vec3 on_edge = a + s * (c - a);
    const Sweep p{on_edge + Vec3(0, 0, u(generator)), on_edge - Vec3(0, 0, u(generator))};
    CHECK(touch(p, t1, 1e-6).hit || touch(p, t2, 1e-6).hit);
  }
}

CASE("touch: edges and vertices keep their distance too")
{
  // beside the edge from (0, 0) to (1, 0), and off the corner at the origin
  const Touch edge = touch({{0.5, -0.02, 0.0}, {0.5, -0.005, 0.0}}, resting_triangle(), 0.01);
  CHECK(edge.hit && !edge.through);
  CHECK_NEAR(edge.depth, 0.005, 1e-12);
  CHECK_NEAR((edge.normal - Vec3(0, -1, 0)).norm(), 0.0, 1e-12);
  CHECK_NEAR((edge.weight - Vec3(0.5, 0.5, 0.0)).norm(), 0.0, 1e-12);
  const Touch corner = touch({{-0.3, -0.4, 0.0}, {-0.003, -0.004, 0.0}}, resting_triangle(), 0.01);
  CHECK(corner.hit);
  CHECK_NEAR(corner.depth, 0.005, 1e-12);
  CHECK_NEAR((corner.weight - Vec3(1, 0, 0)).norm(), 0.0, 1e-12);
}

CASE("nearest point: no point of a triangle is nearer")
{
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto vec = [&] { return Vec3(u(generator), u(generator), u(generator)); };
  for (int k = 0; k < 200; k++) {
    const Vec3 a = vec(), b = vec(), c = vec(), p = 2.0 * vec();
    Vec3 weight;
    const double distance = distance_vector(p, a, b, c, weight).norm();
    CHECK(weight.minCoeff() >= 0.0);
    CHECK_NEAR(weight.sum(), 1.0, 1e-14);
    for (int m = 0; m < 200; m++) {
      double r = 0.5 * (u(generator) + 1.0), s = 0.5 * (u(generator) + 1.0);
      if (r + s > 1.0) {
        r = 1.0 - r;
        s = 1.0 - s;
      }
      CHECK((p - a - r * (b - a) - s * (c - a)).norm() >= distance - 1e-12);
    }
  }
}

CASE("volume: never flat is never wrong")
{
  std::mt19937 generator(9);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  int never = 0;
  for (int k = 0; k < 20000; k++) {
    const Volume v{u(generator), u(generator), u(generator), u(generator)};
    if (!v.never_flat()) continue;
    never++;
    CHECK(cubic_roots(v.c0, v.c1, v.c2, v.c3).n == 0);
  }
  CHECK(never > 2000);
}

CASE("sides: parted by the same sheet only")
{
  const Sides above = side_of_sheet(0, true), below = side_of_sheet(0, false);
  const Sides other = side_of_sheet(7, false);
  CHECK(parted(above, below) && parted(below, above));
  CHECK(!parted(above, above) && !parted(above, 0) && !parted(above, other));
  CHECK(parted(static_cast<Sides>(above | other),
               static_cast<Sides>(above | side_of_sheet(7, true))));
}

CASE("grid: finds exactly the boxes that a brute force search finds")
{
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto vec = [&] { return Eigen::Vector3d(u(generator), u(generator), u(generator)); };
  std::vector<Box> boxes;
  for (int k = 0; k < 300; k++) {
    Box box(vec());
    box.extend(Eigen::Vector3d(box.min() + 0.1 * vec()));
    boxes.push_back(box);
  }
  BoxGrid grid;
  grid.build(boxes);
  for (int k = 0; k < 300; k++) {
    Box probe(vec());
    probe.extend(Eigen::Vector3d(probe.min() + 0.2 * vec()));
    std::set<int> found, expected;
    grid.query(probe, [&](int b) {
      if (boxes[b].intersects(probe)) CHECK(found.insert(b).second);
    });
    for (int b = 0; b < 300; b++)
      if (boxes[b].intersects(probe)) expected.insert(b);
    CHECK(found == expected);
  }
  grid.build({});
  grid.query(Box(vec()), [](int) { CHECK(false); });
}

CASE("grid: among discs of all sizes it finds the triangles near a point, and the nearest")
{
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto vec = [&] { return Eigen::Vector3d(u(generator), u(generator), u(generator)); };
  std::vector<std::array<Eigen::Vector3d, 3>> triangles;
  std::vector<Disc> discs, moving;
  for (int k = 0; k < 500; k++) {
    const Eigen::Vector3d at = vec();
    const double size = k % 50 == 0 ? 3.0 : 0.05;
    triangles.push_back({at, at + size * vec(), at + (k == 7 ? 0.0 : size) * vec()});
    discs.push_back(disc_around(triangles[k][0], triangles[k][1], triangles[k][2]));
  }
  const double far = 0.2, slack = 0.01, room = 0.1;
  for (const Disc &disc : discs) {
    moving.push_back(disc);
    moving.back().room = room;
  }
  DiscGrid grid, roomy;
  grid.build(discs, far);
  roomy.build(moving, far);
  int looked = 0, seen = 0;
  for (int k = 0; k < 500; k++) {
    const Eigen::Vector3d p = 1.3 * vec();
    std::vector<double> distance;
    for (const auto &[a, b, c] : triangles) {
      Eigen::Vector3d weight;
      distance.push_back(distance_vector(p, a, b, c, weight).norm());
    }
    const double nearest = *std::min_element(distance.begin(), distance.end());
    std::set<int> near, all, more;
    grid.nearest(p, far, slack, [&](int t) { CHECK(near.insert(t).second); });
    grid.within(p, far, [&](int t) { CHECK(all.insert(t).second); });
    roomy.within(p, far, [&](int t) { CHECK(more.insert(t).second); });
    for (int t = 0; t < 500; t++) {
      if (distance[t] <= std::min(far, nearest + slack)) CHECK(near.count(t) == 1);
      if (distance[t] <= far) CHECK(all.count(t) == 1);
      if (distance[t] <= far + room) CHECK(more.count(t) == 1);
    }
    if (nearest < far) looked++;
    seen += static_cast<int>(near.size());
  }
  CHECK(looked > 100);
  CHECK(seen < 6 * 500);    // hardly more than have to
  const double none = std::numeric_limits<double>::quiet_NaN(),
               infinite = std::numeric_limits<double>::infinity();
  grid.nearest(Eigen::Vector3d(none, 0, 0), far, slack, [](int) { CHECK(false); });
  grid.within(Eigen::Vector3d(none, 0, 0), none, [](int) { CHECK(false); });
  int everybody = 0;
  grid.within(Eigen::Vector3d(0, 0, infinite), infinite, [&](int) { everybody++; });
  CHECK(everybody <= 500);
  moving[3].centre[0] = infinite;
  roomy.build(moving, far);
  roomy.within(vec(), far, [](int t) { CHECK(t != 3); });
  grid.build({}, far);
  grid.nearest(vec(), far, slack, [](int) { CHECK(false); });
}
