#include "check.h"
#include "core/box_grid.h"
#include "core/contact.h"

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
      const Sweep p{{0.2, 0.2, side * 0.01}, {0.2, 0.2, side * (0.01 - speed)}};
      const Touch t = touch(p, resting_triangle(), 1e-3);
      CHECK(t.hit);
      CHECK(t.through == (speed > 0.01));
      CHECK_NEAR(t.normal[2], side, 1e-15);
      CHECK_NEAR(t.depth, speed - 0.01 + 1e-3, 1e-9 * speed);
      CHECK_NEAR((t.weight - Vec3(0.6, 0.2, 0.2)).norm(), 0.0, 1e-9);
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
