// SPDX-License-Identifier: GPL-2.0-or-later
// The closest points of a point and a triangle, and of two edges, in one form: four positions with
// signed weights.  The weights of the first side (the point, or the first edge) sum up to 1, those
// of the second to -1, and the weighted sum of positions is the vector from the second side to the
// first.

#ifndef SPHCLOTH_CORE_CONTACT_CLOSEST_POINTS_H
#define SPHCLOTH_CORE_CONTACT_CLOSEST_POINTS_H

#include "core/contact/point_triangle.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sphcloth {

// of four positions: p, a, b, c, or two edges p, q and a, b

enum class PairKind { POINT_TRIANGLE, EDGE_EDGE };

using FourPoints = std::array<Vec3, 4>;

// how many of the four are the first side

inline int first_side(PairKind kind) { return kind == PairKind::POINT_TRIANGLE ? 1 : 2; }

// Where on two edges, 0 at their first and 1 at their second ends, are the closest points?
// Ericson, Real-Time Collision Detection, Morgan Kaufmann 2005, section 5.1.9.

struct OnEdges {
  double s, t;
};

inline OnEdges closest_on_edges(const Vec3 &p, const Vec3 &q, const Vec3 &a, const Vec3 &b)
{
  const Vec3 d1 = q - p, d2 = b - a, r = p - a;
  const double aa = d1.squaredNorm(), ee = d2.squaredNorm(), f = d2.dot(r);
  if (aa == 0.0) return {0.0, ee > 0.0 ? std::clamp(f / ee, 0.0, 1.0) : 0.0};
  const double c = d1.dot(r);
  if (ee == 0.0) return {std::clamp(-c / aa, 0.0, 1.0), 0.0};
  const double bb = d1.dot(d2), parallel = aa * ee - bb * bb;
  const double s = parallel > 0.0 ? std::clamp((bb * f - c * ee) / parallel, 0.0, 1.0) : 0.0;
  const double t = (bb * s + f) / ee;
  if (t < 0.0) return {std::clamp(-c / aa, 0.0, 1.0), 0.0};
  if (t > 1.0) return {std::clamp((bb - c) / aa, 0.0, 1.0), 1.0};
  return {s, t};
}

struct ClosestPoints {
  std::array<double, 4> weight;
  Vec3 vector;    // from the second side to the first
};

inline ClosestPoints closest_points(PairKind kind, const FourPoints &x)
{
  ClosestPoints at;
  if (kind == PairKind::POINT_TRIANGLE) {
    const Vec3 on = nearest_point(x[0], x[1], x[2], x[3]);
    at.weight = {1.0, -on[0], -on[1], -on[2]};
  } else {
    const OnEdges on = closest_on_edges(x[0], x[1], x[2], x[3]);
    at.weight = {1.0 - on.s, on.s, on.t - 1.0, -on.t};
  }
  at.vector = at.weight[0] * x[0] + at.weight[1] * x[1] + at.weight[2] * x[2] + at.weight[3] * x[3];
  return at;
}

// They are no nearer than this, without a branch: both sides are apart by no less than along the
// line between their centers.

inline double distance_along_centers(PairKind kind, const FourPoints &x)
{
  if (kind == PairKind::POINT_TRIANGLE) {
    const Vec3 center = (x[1] + x[2] + x[3]) / 3.0, line = x[0] - center;
    const double sq = line.squaredNorm();
    const double reach =
        std::max({line.dot(x[1] - center), line.dot(x[2] - center), line.dot(x[3] - center)});
    return sq > 0.0 ? (sq - reach) / std::sqrt(sq) : 0.0;
  }
  const Vec3 line = 0.5 * (x[0] + x[1] - x[2] - x[3]);
  const double sq = line.squaredNorm();
  const double reach = 0.5 * (std::fabs(line.dot(x[1] - x[0])) + std::fabs(line.dot(x[3] - x[2])));
  return sq > 0.0 ? (sq - reach) / std::sqrt(sq) : 0.0;
}

// Are the closest points inside both edges, or inside the triangle?  If not, another pair is as
// near.

inline bool inside_both(PairKind kind, const ClosestPoints &at)
{
  const std::array<double, 4> &w = at.weight;
  if (kind == PairKind::POINT_TRIANGLE) return w[1] < 0.0 && w[2] < 0.0 && w[3] < 0.0;
  return w[0] > 0.0 && w[1] > 0.0 && w[2] < 0.0 && w[3] < 0.0;
}

// How much two edges count as such: not at all where they are parallel, or where their closest
// points are at an end, which belong to points and triangles; and fully a little away from that.
// Parallel edges: Li et al., ACM Trans. Graph. 39(4) (2020) 49, section 5.

inline double share_of_edges(const FourPoints &x, const ClosestPoints &at)
{
  constexpr double FULL_SINE_SQ = 0.01, FULL_INSIDE = 0.05;
  const std::array<double, 4> &w = at.weight;
  const double inside = std::min({w[0], w[1], -w[2], -w[3]}) / FULL_INSIDE;
  if (inside <= 0.0) return 0.0;
  const Vec3 first = x[1] - x[0], second = x[3] - x[2];
  const double sine_sq =
      first.cross(second).squaredNorm() / (first.squaredNorm() * second.squaredNorm());
  return std::min(1.0, inside) * std::min(1.0, sine_sq / FULL_SINE_SQ);
}

inline constexpr double LEANS_AWAY = 0.1;    // from this cosine on a pair does not count

// The same of a pair that leans, from its closest points, into what borders on one of them, by this
// cosine: what borders is nearer.

inline double share_of_leaning(double cosine)
{
  return std::clamp(1.0 - cosine / LEANS_AWAY, 0.0, 1.0);
}

}    // namespace sphcloth

#endif
