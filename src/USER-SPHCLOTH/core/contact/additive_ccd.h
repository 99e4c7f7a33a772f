// SPDX-License-Identifier: GPL-2.0-or-later
// Continuous collision detection by distances alone: a pair cannot meet before its points have
// moved as far as it is apart, so time advances by what that allows, until the step ends or the
// distance is used up.  Errors of rounding make it stop too early, never too late.
//
// Li, Kaufman & Jiang, ACM Trans. Graph. 40(4) (2021) 170, section 5.

#ifndef SPHCLOTH_CORE_CONTACT_ADDITIVE_CCD_H
#define SPHCLOTH_CORE_CONTACT_ADDITIVE_CCD_H

#include "core/contact/closest_points.h"

namespace sphcloth {

// positions at the start of the step, and how far they move in it

struct PairMotion {
  PairKind kind;
  FourPoints start, displacement;

  FourPoints at(double time) const    // 0 to 1
  {
    FourPoints x;
    for (int k = 0; k < 4; k++) x[k] = start[k] + time * displacement[k];
    return x;
  }
};

// by how much the distance may change: the motion of all four together does not matter

inline double max_approach(const PairMotion &pair)
{
  const FourPoints &u = pair.displacement;
  const Vec3 mean = 0.25 * (u[0] + u[1] + u[2] + u[3]);
  const int n = first_side(pair.kind);
  std::array<double, 2> longest{0.0, 0.0};
  for (int k = 0; k < 4; k++)
    longest[k >= n] = std::max(longest[k >= n], (u[k] - mean).squaredNorm());
  return std::sqrt(longest[0]) + std::sqrt(longest[1]);
}

// The same along a direction, from the second side to the first, in which they are apart: a plane
// between them that moves stays between them while this is less than the distance.

inline double max_approach_along(const Vec3 &direction, const PairMotion &pair)
{
  const int n = first_side(pair.kind);
  double slowest = direction.dot(pair.displacement[0]),
         fastest = direction.dot(pair.displacement[3]);
  for (int k = 1; k < n; k++) slowest = std::min(slowest, direction.dot(pair.displacement[k]));
  for (int k = n; k < 3; k++) fastest = std::max(fastest, direction.dot(pair.displacement[k]));
  return fastest - slowest;
}

struct SafeTime {
  double time;    // of the step, up to 1
  Vec3 vector;    // from the second side to the first, then
};

// For so long pairs that are farther apart than `keep` stay so.

inline SafeTime safe_time(const PairMotion &pair, double keep)
{
  // of the room: so much is left where time ends, and so much each advance takes
  constexpr double LEFT = 0.1, SHARE = 0.9;
  constexpr int MAX_ADVANCES = 1000;
  const double speed = max_approach(pair);
  double time = 0.0;
  Vec3 vector = closest_points(pair.kind, pair.start).vector;
  const double room_at_start = vector.norm() - keep;
  for (int n = 0; n < MAX_ADVANCES; n++) {
    const double room = vector.norm() - keep;
    if (room <= LEFT * room_at_start) break;
    const double next = speed > 0.0 ? time + SHARE * room / speed : 1.0;
    if (next >= 1.0) return {1.0, vector};
    time = next;
    vector = closest_points(pair.kind, pair.at(time)).vector;
  }
  return {time, vector};
}

// Does the distance stay above `keep` all the time?  The cheapest sufficient test first.

inline bool stays_apart(const PairMotion &pair, const Vec3 &vector_at_start, double keep)
{
  const double distance = vector_at_start.norm(), room = distance - keep;
  if (max_approach(pair) < room) return true;
  if (distance > 0.0 && max_approach_along(vector_at_start / distance, pair) < room) return true;
  return safe_time(pair, keep).time == 1.0;
}

}    // namespace sphcloth

#endif
