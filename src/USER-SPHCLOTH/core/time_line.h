// Power-of-two steps on an integer time line.
//
// A root step is halved again and again: level k takes steps of root/2^k, and they begin at multiples
// of their own length.  Whoever begins a step is met by all who take shorter ones, and at the end of
// a root step by everybody: the next root may then be of any length.

#ifndef SPHCLOTH_CORE_TIME_LINE_H
#define SPHCLOTH_CORE_TIME_LINE_H

#include <algorithm>
#include <array>
#include <cmath>

namespace sphcloth {

class TimeLine {
 public:
  static constexpr int DEEPEST = 30;

  double root = 0.0;    // 0: not begun
  long long now = 0;    // since the root step began, in ticks of root / 2^DEEPEST

  static long long ticks(int level) { return 1LL << (DEEPEST - level); }
  double step(int level) const { return root / static_cast<double>(1LL << level); }
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
};

// The root step with which a population of wanted steps costs least, when every one of them is
// rounded down to root/2^k.  Wanted steps are counted by their ratio to the least of them in parts of
// an octave.

class WantedSteps {
 public:
  static constexpr int PARTS = 32;    // of an octave
  static constexpr int N = PARTS * TimeLine::DEEPEST;

  std::array<int, N> count{};    // to be summed over ranks

  void add(double dt, double least)
  {
    constexpr float ROUNDING = 1e-4F;
    const float octaves = std::log2(static_cast<float>(dt / least));
    count[std::clamp(static_cast<int>(PARTS * octaves + ROUNDING), 0, N - 1)]++;
  }

  // What one evaluation of everybody's neighbours costs is 1, so a step costs what it updates and
  // `overhead` for the rest of the scene.  The shortest step is below `least` by less than a half.
  double best_root(double least, double overhead) const
  {
    double best = 0.0, best_cost = 0.0;
    int end = N;
    while (end > 0 && !count[end - 1]) end--;
    for (int shift = 0; shift < PARTS; shift++) {
      const double shortest = least * std::exp2(-static_cast<double>(shift) / PARTS);
      int longest = 0;
      const double cost = work_per_time(shift, end, overhead, longest) / shortest;
      if (shift > 0 && cost >= best_cost) continue;
      best_cost = cost;
      best = std::ldexp(shortest, longest);
    }
    return best;
  }

 private:
  // of the counts before `end`, in units of the shortest step; longest: the octave of the longest step
  double work_per_time(int shift, int end, double overhead, int &longest) const
  {
    double updates = 0.0, particles = 0.0;
    for (int k = 0; k < end; k++) {
      if (!count[k]) continue;
      const int octave = (k + shift) / PARTS;
      updates += std::ldexp(count[k], -octave);
      particles += count[k];
      longest = octave;
    }
    return updates + overhead * particles;
  }
};

}    // namespace sphcloth

#endif
