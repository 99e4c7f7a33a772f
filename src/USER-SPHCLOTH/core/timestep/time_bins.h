// SPDX-License-Identifier: GPL-2.0-or-later
// Power-of-two steps on an integer time line.
//
// A base step is halved again and again: particles in time bin k take steps of base/2^k, which
// begin at multiples of their own length.  Where a step begins all shorter ones begin as well, and
// at the end of the base step all particles are synchronized: the next base step may be of any
// length.

#ifndef SPHCLOTH_CORE_TIMESTEP_TIME_BINS_H
#define SPHCLOTH_CORE_TIMESTEP_TIME_BINS_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/timestep/step_limits.h"

namespace sphcloth {

class TimeBins {
 public:
  static constexpr int DEEPEST = 30;

  double base = 0.0;    // 0: not begun
  long long now = 0;    // since the base step began, in ticks of base / 2^DEEPEST

  static long long ticks(int bin) { return 1LL << (DEEPEST - bin); }
  double step(int bin) const { return base * PARTS_OF_BASE[bin]; }
  bool begins(int bin) const { return now % ticks(bin) == 0; }
  bool ended() const { return now == ticks(0); }
  // to the end of the base step
  double remaining() const
  {
    return base * static_cast<double>(ticks(0) - now) / static_cast<double>(ticks(0));
  }

  // the longest step that may begin now
  int coarsest() const
  {
    int bin = 0;
    while (!begins(bin)) bin++;
    return bin;
  }

  // the longest step that is not above dt
  int bin_of(double dt) const
  {
    constexpr double ROUNDING = 1e-12;
    const double max_step = (1.0 + ROUNDING) * dt;
    int bin = 0;
    for (double step = base; bin < DEEPEST && step > max_step; step *= 0.5) bin++;
    return bin;
  }

 private:
  static constexpr std::array<double, DEEPEST + 1> PARTS_OF_BASE = [] {
    std::array<double, DEEPEST + 1> parts{1.0};
    for (int bin = 1; bin <= DEEPEST; bin++) parts[bin] = 0.5 * parts[bin - 1];
    return parts;
  }();
};

// The base step with which a population of wanted steps costs least, when every one of them is
// rounded down to base/2^k.  Wanted steps are counted by their ratio to the shortest of them in
// parts of an octave.

class WantedSteps {
 public:
  static constexpr int PARTS = 32;    // of an octave
  static constexpr int N = PARTS * TimeBins::DEEPEST;

  std::array<std::int64_t, N> count{};    // to be summed over ranks

  void add(double dt, double shortest)
  {
    constexpr float ROUNDING = 1e-4F;
    const float octaves = std::log2(static_cast<float>(dt / shortest));
    count[std::clamp(static_cast<int>(PARTS * octaves + ROUNDING), 0, N - 1)]++;
  }

  // One evaluation of all particles costs 1, so a smallest step costs the share that it updates,
  // and `overhead` for what is done for all.  It is below `min_step` by less than a half.  Unless
  // unequal steps cost less by a factor of `gain` the step is uniform.
  double best_base_step(double min_step, double overhead, double gain) const
  {
    const int end = end_of_counts();
    double best = min_step,
           best_cost = of_ladder(0, end, 0, overhead).per_shortest / (gain * min_step);
    for (int shift = 0; shift < PARTS; shift++) {
      const double shortest = min_step * std::exp2(-static_cast<double>(shift) / PARTS);
      const Work work = of_ladder(shift, end, TimeBins::DEEPEST, overhead);
      const double cost = work.per_shortest / shortest;
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = std::ldexp(shortest, work.longest);
    }
    return best;
  }

  // The same where a base step has to end `remaining` from now: the fewest equal base steps, or up
  // to twice as many, whichever cost least.  Far away any base step will do, and a uniform step
  // arrives as it does elsewhere.
  double base_step_towards(double remaining, double min_step, double overhead, double gain) const
  {
    constexpr int MAX_STEPS_AHEAD = 16;    // base steps
    constexpr double ROUNDING = 1e-9;
    const double best = best_base_step(min_step, overhead, gain), n_steps = remaining / best;
    if (best <= min_step) return step_towards(remaining, best);
    if (n_steps > MAX_STEPS_AHEAD) return best;
    const int fewest = std::max(1, static_cast<int>(std::ceil((1.0 - ROUNDING) * n_steps)));
    const int end = end_of_counts();
    double base = 0.0, min_cost = std::numeric_limits<double>::infinity();
    for (int n = fewest; n < 2 * fewest; n++) {
      const double cost = cost_of(remaining / n, min_step, end, overhead);
      if (cost >= min_cost) continue;
      min_cost = cost;
      base = remaining / n;
    }
    return base;
  }

 private:
  struct Work {
    double per_shortest = 0.0;    // step
    int longest = 0;    // octave of the longest step that is taken
  };

  // behind the longest wanted step
  int end_of_counts() const
  {
    int end = N;
    while (end > 0 && !count[end - 1]) end--;
    return end;
  }

  double cost_of(double base, double min_step, int end, double overhead) const
  {
    const TimeBins line{base};
    const int deepest = line.bin_of(min_step);
    const double above = std::log2(min_step / line.step(deepest));
    const int shift = std::max(0, static_cast<int>(std::ceil(PARTS * above)));
    return of_ladder(shift, end, deepest, overhead).per_shortest / line.step(deepest);
  }

  // of octaves up to `highest`, the first of which begins `shift` parts below the shortest wanted
  // step
  Work of_ladder(int shift, int end, int highest, double overhead) const
  {
    Work work;
    double particles = 0.0;
    for (int k = 0; k < end; k++) {
      if (!count[k]) continue;
      work.longest = std::min(highest, (k + shift) / PARTS);
      const auto wanting = static_cast<double>(count[k]);
      work.per_shortest += std::ldexp(wanting, -work.longest);
      particles += wanting;
    }
    work.per_shortest += overhead * particles;
    return work;
  }
};

}    // namespace sphcloth

#endif
