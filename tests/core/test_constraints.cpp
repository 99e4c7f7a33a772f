#include "check.h"
#include "core/constraints.h"

#include <random>

using namespace sphcloth;

namespace {

std::mt19937 generator(7);

Vec3 random_vec()
{
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  return {u(generator), u(generator), u(generator)};
}

// a hinge of the given angle between two triangles at the edge (0,0,0) - (1,0,0)
std::array<Vec3, 4> folded(double angle)
{
  return {Vec3(0.4, 0.9, 0.0), Vec3(0.0, 0.0, 0.0), Vec3(1.0, 0.0, 0.0),
          Vec3(0.6, -0.8 * std::cos(angle), 0.8 * std::sin(angle))};
}

}    // namespace

CASE("stiffness per iteration, equation (9)")
{
  for (int n : {1, 2, 7, 1000})
    for (double k : {1e-12, 0.3, 0.999})
      CHECK_NEAR(std::pow(1.0 - stiffness_per_iteration(k, n), n), 1.0 - k, 1e-12);
  CHECK(stiffness_per_iteration(0.0, 10) == 0.0);
  CHECK(stiffness_per_iteration(1.0, 10) == 1.0);
  CHECK(stiffness_per_iteration(0.3, 1) == 0.3 ||
        std::fabs(stiffness_per_iteration(0.3, 1) - 0.3) < 1e-16);
}

CASE("distance: projected exactly, mass-weighted, momentum and pins kept")
{
  for (int trial = 0; trial < 100; trial++) {
    const Vec3 a0 = random_vec(), b0 = random_vec();
    const double wa = 0.5, wb = 3.0;
    Vec3 a = a0, b = b0;
    CHECK_NEAR(project_distance(a, b, wa, wb, 0.7, 1.0), (a0 - b0).norm() - 0.7, 1e-14);
    CHECK_NEAR((a - b).norm(), 0.7, 1e-14);
    CHECK_NEAR(((a - a0) / wa + (b - b0) / wb).norm(), 0.0, 1e-14);
    CHECK_NEAR((a0.cross(a - a0) / wa + b0.cross(b - b0) / wb).norm(), 0.0, 1e-13);
  }
  Vec3 a(0, 0, 0), b(2, 0, 0);
  project_distance(a, b, 0.0, 1.0, 1.0, 1.0);
  CHECK(a == Vec3(0, 0, 0) && b == Vec3(1, 0, 0));
}

CASE("distance: k = 0 is bitwise nothing; coincident and doubly pinned ends stay finite")
{
  const Vec3 a0 = random_vec(), b0 = random_vec();
  Vec3 a = a0, b = b0;
  project_distance(a, b, 1.0, 2.0, 0.7, 0.0);
  CHECK(a == a0 && b == b0);
  b = a;
  project_distance(a, b, 1.0, 1.0, 0.7, 1.0);
  CHECK(a == a0 && b == a0);
  b = b0;
  project_distance(a, b, 0.0, 0.0, 0.7, 1.0);
  CHECK(a == a0 && b == b0);
}

CASE("hinge: the angle has a sign and every digit near flat")
{
  for (double angle : {-2.6, -1.0, -1e-10, 0.0, 1e-12, 0.5, 2.6}) {
    const auto [a, e1, e2, b] = folded(angle);
    CHECK(hinge(a, e1, e2, b).valid);
    CHECK_NEAR(std::fabs(hinge(a, e1, e2, b).angle), std::fabs(angle),
               1e-12 * std::fabs(angle) + 1e-17);
    CHECK_NEAR(hinge(b, e2, e1, a).angle, hinge(a, e1, e2, b).angle, 1e-15);
  }
  const auto p = folded(0.3), m = folded(-0.3);
  CHECK(hinge(p[0], p[1], p[2], p[3]).angle * hinge(m[0], m[1], m[2], m[3]).angle < 0.0);
}

CASE("hinge: gradients against finite differences, and no net force or torque")
{
  for (int trial = 0; trial < 100; trial++) {
    std::array<Vec3, 4> x = folded(trial % 2 ? 0.0 : -2.4 + 0.05 * trial);
    for (Vec3 &v : x) v += 0.1 * random_vec();
    const Hinge h = hinge(x[0], x[1], x[2], x[3]);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (int i = 0; i < 4; i++) {
      force += h.grad[i];
      torque += x[i].cross(h.grad[i]);
      for (int d = 0; d < 3; d++) {
        const double step = 1e-6;
        auto hi = x, lo = x;
        hi[i][d] += step;
        lo[i][d] -= step;
        const double slope = angle_difference(hinge(hi[0], hi[1], hi[2], hi[3]).angle,
                                              hinge(lo[0], lo[1], lo[2], lo[3]).angle) /
            (2.0 * step);
        CHECK_NEAR(h.grad[i][d], slope, 1e-7);
      }
    }
    CHECK_NEAR(force.norm(), 0.0, 1e-12);
    CHECK_NEAR(torque.norm(), 0.0, 1e-12);
  }
}

CASE("hinge: projection reaches the rest angle from -150 to 150 degrees")
{
  for (double degrees : {-150.0, -90.0, -10.0, 0.0, 30.0, 120.0, 150.0}) {
    const double rest = degrees * PI / 180.0;
    std::array<Vec3, 4> x = folded(0.2);
    for (int n = 0; n < 200; n++)
      project_hinge(x[0], x[1], x[2], x[3], {1.0, 2.0, 1.0, 0.5}, rest, 1.0);
    CHECK_NEAR(hinge(x[0], x[1], x[2], x[3]).angle, rest, 1e-9);
  }
}

CASE("hinge: degenerate triangles are left alone")
{
  std::array<Vec3, 4> x = folded(0.3);
  x[0] = Vec3(0.5, 0.0, 0.0);    // on the edge
  const auto before = x;
  CHECK(project_hinge(x[0], x[1], x[2], x[3], {1.0, 1.0, 1.0, 1.0}, 0.0, 1.0) == 0.0);
  CHECK(x == before);
}

CASE("hinge: a vertex without lever is not thrown away when the others are pinned")
{
  // right angles at e1: moving e1 does not turn the hinge to first order
  std::array<Vec3, 4> x = {Vec3(1e-17, 1, 1e-3), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, -1, 0)};
  const Vec3 before = x[2];
  project_hinge(x[0], x[1], x[2], x[3], {0.0, 0.0, 1.0, 0.0}, 0.0, 1.0);
  CHECK((x[2] - before).norm() < 0.1);
}

CASE("edge damping: takes stretching motion, keeps momentum and rigid motion")
{
  const Vec3 p1 = random_vec(), p2 = random_vec();
  Vec3 v1 = random_vec(), v2 = random_vec();
  const Vec3 momentum = v1 / 0.5 + v2 / 2.0;
  damp_edge(p1, p2, v1, v2, 0.5, 2.0, 1.0);
  CHECK_NEAR((v1 - v2).dot(p1 - p2), 0.0, 1e-15);
  CHECK_NEAR((v1 / 0.5 + v2 / 2.0 - momentum).norm(), 0.0, 1e-14);
  const Vec3 fall(0.0, 0.0, -3.0);
  v1 = v2 = fall;
  damp_edge(p1, p2, v1, v2, 0.5, 2.0, 0.7);
  CHECK(v1 == fall && v2 == fall);
}
