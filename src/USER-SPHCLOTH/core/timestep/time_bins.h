// Power-of-two steps on an integer time line.
//
// A root step is halved again and again: level k takes steps of root/2^k, and they begin at
// multiples of their own length.  Whoever begins a step is met by all who take shorter ones, and at
// the end of a root step by everybody: the next root may then be of any length.

#ifndef SPHCLOTH_CORE_TIMESTEP_TIME_BINS_H
#define SPHCLOTH_CORE_TIMESTEP_TIME_BINS_H

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/timestep/step_limits.h"

namespace sphcloth {

class TimeBins {
 public:
  static constexpr int DEEPEST = 30;

  double root = 0.0;    // 0: not begun
  long long now = 0;    // since the root step began, in ticks of root / 2^DEEPEST

  static long long ticks(int level) { return 1LL << (DEEPEST - level); }
  double step(int level) const { return root * PARTS_OF_ROOT[level]; }
  bool begins(int level) const { return now % ticks(level) == 0; }
  bool ended() const { return now == ticks(0); }

  // the longest step that may begin now
  int coarsest() const
  {
    int level = 0;
    while (!begins(level)) level++;
    return level;
  }

  // the longest step that is not above dt
  int level_of(double dt) const
  {
    constexpr double ROUNDING = 1e-12;
    const double most = (1.0 + ROUNDING) * dt;
    int level = 0;
    for (double step = root; level < DEEPEST && step > most; step *= 0.5) level++;
    return level;
  }

 private:
  static constexpr std::array<double, DEEPEST + 1> PARTS_OF_ROOT = [] {
    std::array<double, DEEPEST + 1> parts{1.0};
    for (int level = 1; level <= DEEPEST; level++) parts[level] = 0.5 * parts[level - 1];
    return parts;
  }();
};

// The root step with which a population of wanted steps costs least, when every one of them is
// rounded down to root/2^k.  Wanted steps are counted by their ratio to the least of them in parts
// of an octave.

class WantedSteps {
 public:
  static constexpr int PARTS = 32;    // of an octave
  static constexpr int N = PARTS * TimeBins::DEEPEST;

  std::array<int, N> count{};    // to be summed over ranks

  void add(double dt, double least)
  {
    constexpr float ROUNDING = 1e-4F;
    const float octaves = std::log2(static_cast<float>(dt / least));
    count[std::clamp(static_cast<int>(PARTS * octaves + ROUNDING), 0, N - 1)]++;
  }

  // What one evaluation of everybody's neighbours costs is 1, so a step costs what it updates and
  // `overhead` for the rest of the scene.  The shortest step is below `least` by less than a
  // half.  Unless unequal steps cost less by a factor of `gain` it is one for all.
  double best_root(double least, double overhead, double gain) const
  {
    const int end = end_of_counts();
    double best = least, best_cost = of_ladder(0, end, 0, overhead).per_shortest / (gain * least);
    for (int shift = 0; shift < PARTS; shift++) {
      const double shortest = least * std::exp2(-static_cast<double>(shift) / PARTS);
      const Work work = of_ladder(shift, end, TimeBins::DEEPEST, overhead);
      const double cost = work.per_shortest / shortest;
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = std::ldexp(shortest, work.longest);
    }
    return best;
  }

  // The same where a root has to end `remaining` from now: that and up to twice as many equal
  // roots, whichever cost least.  Far away any root will do, and one step for all arrives as it
  // does elsewhere.
  double root_towards(double remaining, double least, double overhead, double gain) const
  {
    constexpr int FAR = 16;    // roots
    constexpr double ROUNDING = 1e-9;
    const double best = best_root(least, overhead, gain), roots = remaining / best;
    if (best <= least) return step_towards(remaining, best);
    if (roots > FAR) return best;
    const int fewest = std::max(1, static_cast<int>(std::ceil((1.0 - ROUNDING) * roots)));
    const int end = end_of_counts();
    double root = 0.0, least_cost = std::numeric_limits<double>::infinity();
    for (int n = fewest; n < 2 * fewest; n++) {
      const double cost = cost_of(remaining / n, least, end, overhead);
      if (cost >= least_cost) continue;
      least_cost = cost;
      root = remaining / n;
    }
    return root;
  }

 private:
  struct Work {
    double per_shortest = 0.0;    // step
    int longest = 0;    // octave of a step that somebody takes
  };

  // nobody wants longer steps
  int end_of_counts() const
  {
    int end = N;
    while (end > 0 && !count[end - 1]) end--;
    return end;
  }

  double cost_of(double root, double least, int end, double overhead) const
  {
    const TimeBins line{root};
    const int deepest = line.level_of(least);
    const double above = std::log2(least / line.step(deepest));
    const int shift = std::max(0, static_cast<int>(std::ceil(PARTS * above)));
    return of_ladder(shift, end, deepest, overhead).per_shortest / line.step(deepest);
  }

  // of octaves up to `highest`, the first of which begins `shift` parts below the least wanted step
  Work of_ladder(int shift, int end, int highest, double overhead) const
  {
    Work work;
    double particles = 0.0;
    for (int k = 0; k < end; k++) {
      if (!count[k]) continue;
      work.longest = std::min(highest, (k + shift) / PARTS);
      work.per_shortest += std::ldexp(count[k], -work.longest);
      particles += count[k];
    }
    work.per_shortest += overhead * particles;
    return work;
  }
};

}    // namespace sphcloth

#endif
