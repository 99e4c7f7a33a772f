// SPDX-License-Identifier: GPL-2.0-or-later
// Free flight: fluid that is thinner than at rest has no pressure, until it is compressed.

#ifndef SPHCLOTH_CORE_TIMESTEP_FREE_FLIGHT_H
#define SPHCLOTH_CORE_TIMESTEP_FREE_FLIGHT_H

#include "core/util/simd.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sphcloth {

// Is there no pressure, but for what rounding makes, which must not decide which step is taken?

SPHCLOTH_INLINE bool flies(double rho, double rest, double rounding)
{
  return rho <= rest + rounding;
}

// then how much denser fluid becomes before there is

SPHCLOTH_INLINE double gap_to_pressure(double rho, double rest, double rounding)
{
  return std::max(rest - rho, rounding);
}

// The time in which something that changes at a rate, and that rate by `growth`, crosses a gap:
// gap = rate t + growth t^2/2.

inline double time_to_cross(double gap, double rate, double growth)
{
  const double ahead = std::max(0.0, gap), root = std::sqrt(rate * rate + 2.0 * growth * ahead);
  if (rate > 0.0) return 2.0 * ahead / (rate + root);
  return growth > 0.0 ? (root - rate) / growth : std::numeric_limits<double>::infinity();
}

// the same of a rate that does not change

SPHCLOTH_INLINE double time_at_rate(double gap, double rate)
{
  return rate > 0.0 ? gap / rate : std::numeric_limits<double>::infinity();
}

// The rate at which a density that changes without effect over `gap` first, has the limit of one
// that changes by `tolerated` beyond.

SPHCLOTH_INLINE double rate_beyond(double gap, double rate, double tolerated)
{
  return rate > 0.0 ? rate * tolerated / (tolerated + gap) : 0.0;
}

}    // namespace sphcloth

#endif
