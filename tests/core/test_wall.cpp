#include "check.h"
#include "core/sph/plane_wall.h"

#include <array>
#include <limits>

using namespace sphcloth;

namespace {

constexpr double DELTAS[] = {0.0, 0.013, 0.2, 0.331, 0.5, 0.77, 0.96};

// Midpoint rule over the slab between delta and 1, rings of radius t around its axis; in two
// dimensions a ring is two points.  Uses nothing of core/sph/plane_wall.h.
template <class Term> double behind(double delta, int dim, const Term &term)
{
  const int n = 1000;
  const double dz = (1.0 - delta) / n, dt = 1.0 / n;
  double sum = 0.0;
  for (int a = 0; a < n; a++)
    for (int b = 0; b < n; b++) {
      const double z = delta + (a + 0.5) * dz, t = (b + 0.5) * dt, q = std::sqrt(z * z + t * t);
      if (q < 1.0) sum += term(q, z) * (dim == 3 ? 2.0 * PI * t : 2.0) * dz * dt;
    }
  return sum;
}

template <class K> void check_wall()
{
  for (int dim : {2, 3}) {
    const WallTable table = wall_table<K>(dim);
    const double norm = K::norm(dim);
    CHECK_NEAR(table(0.0).lambda, 0.5, 1e-12);
    CHECK_NEAR(table(1.0 - 1e-9).lambda, 0.0, 1e-15);
    CHECK(table(1.0).lambda == 0.0 && table(1.0).slope == 0.0);
    CHECK(table(-1.0).lambda == 1.0 && table(-1.5).slope == 0.0);
    for (double delta : DELTAS) {
      const WallTable::Value value = table(delta);
      const auto density = [&](double q, double) { return norm * K::shape(q); };
      CHECK_NEAR(value.lambda, behind(delta, dim, density), 2e-6);
      CHECK_NEAR(table(-delta).lambda, 1.0 - value.lambda, 1e-14);
      CHECK(table(-delta).slope == value.slope);

      // the slope is that of what the table returns, not only of what it approximates
      const double h = 1e-6;
      const double rise = table(delta + h).lambda - table(delta - h).lambda;
      CHECK_NEAR(value.slope, rise / (2.0 * h), 1e-8);

      // friction: the linear continuation, integrated
      if (delta < NEAREST_FRICTION) continue;
      const auto viscous = [&](double q, double z) {
        return -norm * K::slope_over_q(q) * (1.0 + (z - delta) / delta);
      };
      const double support = 0.37;
      const double rate = wall_friction(value, delta, support) * support * support;
      CHECK_NEAR(rate, behind(delta, dim, viscous), 3e-5);
    }
    // as fine as round-off in the force asks for: exact in the middle of a piece too
    const double middle = 0.3 + 0.5 / 480.0;
    const auto density = [&](double q, double) { return norm * K::shape(q); };
    CHECK_NEAR(table(middle).lambda, behind(middle, dim, density), 2e-6);
    CHECK(std::isfinite(wall_friction(table(0.0), 0.0, 1.0)));
  }
}

// the three quadrants behind one or both of two walls at right angles
double exact_corner(double a, double b)
{
  const int n = 400;
  double sum = 0.0;
  for (int i = 0; i < 2 * n; i++)
    for (int j = 0; j < 2 * n; j++) {
      const double x = (i + 0.5) / n - 1.0, y = (j + 0.5) / n - 1.0, q = std::sqrt(x * x + y * y);
      if (q < 1.0 && (x > a || y > b)) sum += WendlandC2::shape(q) / (n * n);
    }
  return WendlandC2::norm(2) * sum;
}

}    // namespace

CASE("wall, every kernel: half-space integral, slope, friction")
{
  for (KernelName name : ALL_KERNELS)
    with_kernel(name, [](auto kernel) { check_wall<decltype(kernel)>(); });
}

CASE("Wendland C2 in three dimensions: lambda in closed form")
{
  // 21 int_delta^1 (1-q)^4 (1+4q) q (q-delta) dq, integrated by parts
  const WallTable table = wall_table<WendlandC2>(3);
  for (double d : {0.0, 0.1, 0.2511, 0.5, 0.9}) {
    const double u = 1.0 - d;
    // in powers of u: q = 1 - p, p from 0 to u
    const auto power = [&](int n) { return std::pow(u, n + 1) / (n + 1); };
    // p^4 (5-4p) (1-p) (u-p)
    const double sum =
        5 * u * power(4) - (9 * u + 5) * power(5) + (4 * u + 9) * power(6) - 4 * power(7);
    CHECK_NEAR(table(d).lambda, 21.0 * sum, 1e-11);
  }
}

CASE("two walls at right angles: the product and its error")
{
  const WallTable table = wall_table<WendlandC2>(2);
  double worst = 0.0;
  for (double a = 0.0; a < 1.0; a += 0.1)
    for (double b = 0.0; b < 1.0; b += 0.1) {
      const std::array<WallTable::Value, 2> walls = {table(a), table(b)};
      worst = std::max(worst, std::fabs(joint_lambda(walls) - exact_corner(a, b)));
    }
  std::printf("  corner of two walls: largest error of lambda %.4f\n", worst);
  CHECK(worst < 0.002);
  const std::array<WallTable::Value, 2> edge = {table(0.0), table(0.0)};
  CHECK_NEAR(joint_lambda(edge), 0.75, 1e-12);

  // the shares are the derivatives
  const double h = 1e-6;
  const std::array<WallTable::Value, 2> at = {table(0.3), table(0.4)};
  std::array<WallTable::Value, 2> more = at, less = at;
  more[1].lambda += h;
  less[1].lambda -= h;
  CHECK_NEAR((joint_lambda(more) - joint_lambda(less)) / (2.0 * h), joint_share(at, 1), 1e-9);
}

CASE("a distance that is no number meets no wall")
{
  const WallTable table = wall_table<WendlandC2>(3);
  CHECK(table(std::numeric_limits<double>::quiet_NaN()).lambda == 0.0);
  CHECK(table(std::numeric_limits<double>::infinity()).lambda == 0.0);
}

CASE("a particle behind the wall is stopped within half the support")
{
  CHECK(stop_strain(0.1) == 0.0);
  CHECK_NEAR(stop_strain(-STOPPING_DEPTH), 1.0, 1e-15);
}
