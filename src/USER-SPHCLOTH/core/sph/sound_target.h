// SPDX-License-Identifier: GPL-2.0-or-later
// A speed of sound that follows the flow: the smallest at which nearly all of a fluid is slower
// than a Mach number and compressed by less than its square, within bounds.
//
// A particle of speed v and pressure p asks for c = sqrt(max(v^2, p/rho0))/Mach: a compression of
// Mach^2 for v^2 (Monaghan, J. Comput. Phys. 110, 399, 1994) and for p = rho0 c^2 Mach^2.

#ifndef SPHCLOTH_CORE_SPH_SOUND_TARGET_H
#define SPHCLOTH_CORE_SPH_SOUND_TARGET_H

#include "core/sph/tait.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace sphcloth {

struct SoundBounds {    // plain, for restart files; max 0: the speed of sound is constant
  double min = 0.0, max = 0.0, mach = 0.1;
  bool follows() const { return max > 0.0; }
};

// Particles by the speed of sound that they ask for, in equal ratios from min to max

class SoundCounts {
 public:
  static constexpr int N = 64;
  std::array<std::int64_t, N> counts{};

  // of a fluid whose speed of sound follows the flow
  explicit SoundCounts(const SoundBounds &bounds_) :
      bounds(bounds_), per_log(0.5 * N / std::log(bounds.max / bounds.min)),
      min_sq(std::pow(bounds.min * bounds.mach, 2))
  {
  }

  // of a particle: max(v^2, p/rho0)
  void add(double speed_sq)
  {
    const double at = speed_sq > min_sq ? per_log * std::log(speed_sq / min_sq) : 0.0;
    counts[static_cast<int>(std::min(at, N - 1.0))]++;
  }

  // what all but a hundredth of the particles ask for
  double wanted() const
  {
    constexpr double FASTER = 0.01;
    double n = 0.0, above = 0.0;
    for (const std::int64_t count : counts) n += static_cast<double>(count);
    int k = N;
    while (k > 0 && above + static_cast<double>(counts[k - 1]) <= FASTER * n)
      above += static_cast<double>(counts[--k]);
    return k == 0 ? bounds.min : bounds.min * std::pow(bounds.max / bounds.min, double(k) / N);
  }

 private:
  SoundBounds bounds;
  double per_log, min_sq;
};

// The next speed of sound, a time dt after it has become what it is.  It rises as fast as waves
// cross a smoothing length, and falls as slowly as they cross the fluid, each ten times.  Small
// changes wait.

inline double next_sound(double now, double wanted, double dt, double smoothing, double size)
{
  constexpr double TIMES = 10.0, SMALL = 0.01;
  const double next = wanted > now ? std::min(wanted, now * (1.0 + now * dt / (TIMES * smoothing)))
                                   : wanted + (now - wanted) * std::exp(-now * dt / (TIMES * size));
  return std::fabs(next / now - 1.0) < SMALL ? now : next;
}

// The share that is left, after dt, of how much the density of a particle differs from that of its
// position because the speed of sound has changed

inline double expansion_left(double sound, double dt, double size)
{
  constexpr double TIMES = 10.0;
  return std::exp(-sound * dt / (TIMES * size));
}

// The density with which another fluid has the pressure that this one has at rho.  A pressure below
// zero is beyond what a softer one can have at any density: then nearly none is left.

inline double density_of_same_pressure(const Tait &now, const Tait &next, double rho)
{
  constexpr double SMALLEST = 1e-3;
  const double excess = std::expm1(now.gamma * std::log(rho / now.rho0)) * now.k / next.k;
  return next.rho0 * std::pow(std::max(1.0 + excess, SMALLEST), 1.0 / next.gamma);
}

}    // namespace sphcloth

#endif
