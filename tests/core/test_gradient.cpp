#include "check.h"
#include "core/sph/gradient.h"

#include <random>

using namespace sphcloth;

namespace {

constexpr double SLOPE[3] = {3.0, -2.0, 0.5};

// neighbours at d = x_j - x_i with weights; the field is linear

void add(Differences &s, double dx, double dy, double dz, double weight)
{
  const double more = SLOPE[0] * dx + SLOPE[1] * dy + SLOPE[2] * dz;
  s.xx += weight * dx * dx;
  s.yy += weight * dy * dy;
  s.zz += weight * dz * dz;
  s.xy += weight * dx * dy;
  s.xz += weight * dx * dz;
  s.yz += weight * dy * dz;
  s.x += weight * dx * more;
  s.y += weight * dy * more;
  s.z += weight * dz * more;
}

}    // namespace

CASE("gradient: exact for a linear field, all around and in a corner")
{
  std::mt19937 generator(5);
  std::uniform_real_distribution<> u(0.0, 1.0);
  for (int dim : {2, 3})
    for (double low : {-1.0, 0.0}) {
      Differences s;
      for (int k = 0; k < 40; k++) {
        const double x = low + (1.0 - low) * u(generator), y = low + (1.0 - low) * u(generator),
                     z = low + (1.0 - low) * u(generator);
        add(s, x, y, dim == 3 ? z : 0.0, 0.1 + u(generator));
      }
      const std::array<double, 3> g = s.gradient(dim);
      CHECK_NEAR(g[0], SLOPE[0], 1e-13);
      CHECK_NEAR(g[1], SLOPE[1], 1e-13);
      CHECK_NEAR(g[2], dim == 3 ? SLOPE[2] : 0.0, 1e-13);
    }
}

CASE("gradient: none for a lone particle, on a line, in a plane; nor does scale matter")
{
  const std::array<double, 3> none{0.0, 0.0, 0.0};
  for (int dim : {2, 3}) CHECK(Differences().gradient(dim) == none);
  Differences line, plane;
  for (double d : {-1.0, 0.3, 1.0}) {
    add(line, d, 0.7 * d, 0.0, 1.0);
    add(plane, d, d * d, 0.0, 1.0);
  }
  for (int dim : {2, 3}) CHECK(line.gradient(dim) == none);
  CHECK(plane.gradient(3) == none);
  CHECK_NEAR(plane.gradient(2)[1], SLOPE[1], 1e-13);
  for (double size : {1e-8, 1e8}) {
    Differences s;
    for (double d : {-1.0, 0.3, 1.0}) add(s, d, d * d, 0.0, size);
    CHECK_NEAR(s.gradient(2)[0], SLOPE[0], 1e-13);
  }
}

CASE("gradient: none from a layer that is nearly flat")
{
  for (double height : {0.05, 0.3}) {
    Differences s;
    for (int x : {-1, 0, 1})
      for (int y : {-1, 0, 1}) add(s, x, y, (x + y) % 2 ? -height : height, 1.0);
    CHECK((s.gradient(3)[0] != 0.0) == (height > 0.2));
  }
}
