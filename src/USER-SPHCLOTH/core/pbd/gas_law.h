// SPDX-License-Identifier: GPL-2.0-or-later
// Gas in a chamber of volume V: p V^n = const, and its pressure in a step that is longer than the
// gas can be followed explicitly.
//
// The gas is counted by the volume G that it fills at the pressure p0 where it started: p = p0
// (G/V)^n.  As in Newmark's rule, J. Eng. Mech. Div. 85 (1959) 67, the pressure of a step is
// averaged over three volumes, (beta + delta) p(t + dt) + (1 - 2 beta) p(t) + (beta - delta) p(t -
// dt): stable for beta >= 1/4 - 1/K, where K = (omega dt)^2 of the breathing mode, of fourth order
// in dt for beta = 1/12, and without damping for delta = 0.

#ifndef SPHCLOTH_CORE_PBD_GAS_LAW_H
#define SPHCLOTH_CORE_PBD_GAS_LAW_H

#include <algorithm>
#include <cmath>
#include <limits>

namespace sphcloth {

struct GasLaw {
  double exponent = 1.0, start = 0.0, ambient = 0.0;    // n, p0 and the pressure outside
  double limit = std::numeric_limits<double>::infinity();    // of the excess over that outside

  double pressure(double gas, double volume) const
  {
    return start * std::pow(gas / volume, exponent);
  }
  double excess(double gas, double volume) const
  {
    return std::min(pressure(gas, volume) - ambient, limit);
  }
  // -dp/dV, without a limit
  double stiffness(double gas, double volume) const
  {
    return exponent * pressure(gas, volume) / volume;
  }
  // gas that has this excess in this volume
  double gas_at(double excess_pressure, double volume) const
  {
    return volume * std::pow((excess_pressure + ambient) / start, 1.0 / exponent);
  }
  // of the gas and of what is outside: minus its derivative by V is the excess
  double energy(double gas, double volume) const
  {
    const double outside = ambient * volume;
    if (exponent == 1.0) return outside - start * gas * std::log(volume / gas);
    return outside + pressure(gas, volume) * volume / (exponent - 1.0);
  }
};

// The last volumes of a chamber, and what its pressure does to the next one.

struct ChamberMotion {
  double volume;
  double excess_before;    // by the law, a step ago, with the gas that was there then
  double expected;    // after the next step, if the pressure stays as it was
  double last_excess;    // that pressure
  double volume_by_excess;    // change of the next volume by the pressure, dt^2 sum |dV/dx|^2 / m
  double inflow = 0.0;    // of gas until then
};

// By K of the breathing mode.  Where steps are long that mode is damped, and beta allows for walls
// that are stiff themselves, whose motion is only known from the last step.

struct PressureWeights {
  double next, now, before;
  explicit PressureWeights(double omega_dt_sq)
  {
    constexpr double FOURTH_ORDER = 1.0 / 12.0, LONG_STEPS = 1.0, BETWEEN = 4.0, DAMPING = 0.25;
    const double share = omega_dt_sq / (omega_dt_sq + BETWEEN);
    const double beta = FOURTH_ORDER + (LONG_STEPS - FOURTH_ORDER) * share;
    const double delta = DAMPING * share * share;
    next = beta + delta;
    now = 1.0 - 2.0 * beta;
    before = beta - delta;
  }
};

// Excess pressure of the next step: with q = a + b p(V), V = expected + c (q - last_excess), V is
// the root of h(V) = V - expected - c (a + b p(V) - last_excess), which rises, with a bend where a
// valve opens: Newton's iterations, between bounds.

inline double implicit_excess(const GasLaw &law, double gas, const ChamberMotion &motion)
{
  const double c = motion.volume_by_excess;
  const double now = law.excess(gas, motion.volume);
  if (!(c > 0.0)) return now;
  const PressureWeights weights(c * law.stiffness(gas, motion.volume));
  const double next_gas = gas + motion.inflow;
  const double known = weights.now * now + weights.before * motion.excess_before;
  const auto averaged = [&](double volume) {
    return std::min(known + weights.next * law.excess(next_gas, volume), law.limit);
  };
  const auto h = [&](double volume) {
    return volume - motion.expected - c * (averaged(volume) - motion.last_excess);
  };

  constexpr int MAX_HALVINGS = 200, MAX_ITERATIONS = 200;
  double low = motion.volume;
  for (int k = 0; k < MAX_HALVINGS && h(low) > 0.0; k++) low *= 0.5;
  double high = low - h(low), volume = low;    // h rises by 1 at least
  for (int k = 0; k < MAX_ITERATIONS; k++) {
    const double error = h(volume);
    (error > 0.0 ? high : low) = volume;
    const bool limited = law.pressure(next_gas, volume) - law.ambient > law.limit;
    const double slope = limited ? 0.0 : c * weights.next * law.stiffness(next_gas, volume);
    const double newton = volume - error / (1.0 + slope), last = volume;
    volume = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (std::abs(volume - last) <= std::numeric_limits<double>::epsilon() * volume) break;
  }
  return averaged(volume);
}

}    // namespace sphcloth

#endif
