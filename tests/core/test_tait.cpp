#include "check.h"
#include "core/sph/tait.h"

using namespace sphcloth;

CASE("Tait: rest, closed form, sound speed, energy")
{
  const Tait water{1000.0, 400.0, 7.0};
  CHECK(water.pressure(1000.0) == 0.0);
  // (1.01)^7 - 1 by hand
  CHECK_NEAR(water.pressure(1010.0), 400.0 * 1000.0 / 7.0 * 0.07213535210701, 1e-7);
  CHECK_NEAR(water.sound_speed(), 20.0, 1e-14);
  const double d = 1e-3;
  const double c2 = (water.pressure(1020.0 + d) - water.pressure(1020.0 - d)) / (2.0 * d);
  CHECK_NEAR(water.sound_speed(1020.0), std::sqrt(c2), 1e-6);
  const double de = (water.energy(1020.0 + d) - water.energy(1020.0 - d)) / (2.0 * d);
  CHECK_NEAR(de, water.pressure(1020.0) / (1020.0 * 1020.0), 1e-9);
  CHECK_NEAR(water.energy(1000.0), 0.0, 1e-12);
}

CASE("Tait: any exponent; a small fluctuation keeps its digits; stiffness from a goal")
{
  const Tait gas{1.2, 9.0, 1.4};
  CHECK_NEAR(gas.sound_speed(2.4), 3.0 * std::pow(2.0, 0.2), 1e-14);
  CHECK_NEAR(gas.pressure(2.4), 9.0 * 1.2 / 1.4 * (std::pow(2.0, 1.4) - 1.0), 1e-12);
  const Tait water{1000.0, 100.0, 7.0};
  CHECK_NEAR(water.pressure(1000.0 * (1.0 + 1e-9)) / (100.0 * 1000.0 * 1e-9), 1.0, 1e-6);
  CHECK_NEAR(Tait::stiffness_from_fluctuation(0.01, 3.0), 900.0, 1e-10);    // c0 = 10 v
}
