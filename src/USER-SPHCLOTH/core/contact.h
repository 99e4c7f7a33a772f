// Continuous contact of a moving point with a moving triangle.
//
// Both move on straight lines during the step.  The point meets the triangle's plane where
// (e1 x e2) . q = 0 with e1 = b - a, e2 = c - a, q = p - a: a cubic in time.
// Provot, Graphics Interface 1997; Bridson, Fedkiw & Anderson, ACM Trans. Graph. 21 (2002) 594.

#ifndef SPHCLOTH_CORE_CONTACT_H
#define SPHCLOTH_CORE_CONTACT_H

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace sphcloth {

using Vec3 = Eigen::Vector3d;

// positions at the start and at the end of the step

struct Sweep {
  Vec3 start, end;
};

struct Touch {
  bool hit = false;
  bool through = false;          // it passes through, not only too near
  Vec3 weight = Vec3::Zero();    // barycentric coordinates of the contact point
  Vec3 normal = Vec3::Zero();    // of the triangle at the end, towards the point's own side
  double depth = 0.0;            // how far the end position lacks of the gap to be kept, >= 0
  double kept = 0.0;             // that gap: the thickness, or the gap at the start if smaller
};

// The tolerance that closes the seams between neighbouring triangles in round-off.
inline constexpr double SEAM = 1e-9;

inline Vec3 barycentric(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  const Vec3 e1 = b - a, e2 = c - a, q = p - a;
  const Vec3 n = e1.cross(e2);
  const double area_sq = n.squaredNorm();
  const double w2 = q.cross(e2).dot(n) / area_sq;
  const double w3 = e1.cross(q).dot(n) / area_sq;
  return {1.0 - w2 - w3, w2, w3};
}

inline bool inside(const Vec3 &weight) { return weight.minCoeff() >= -SEAM; }

// Roots in (0, 1] of c0 + c1 t + c2 t^2 + c3 t^3, ascending: the interval is cut where the
// derivative vanishes and each monotone piece with a change of sign is bisected to round-off.

struct Roots {
  std::array<double, 3> t{};
  int n = 0;
};

inline Roots cubic_roots(double c0, double c1, double c2, double c3)
{
  const auto f = [=](double t) { return c0 + t * (c1 + t * (c2 + t * c3)); };
  std::array<double, 4> cut{0.0, 1.0, 1.0, 1.0};
  int n_cuts = 1;
  const double disc = c2 * c2 - 3.0 * c1 * c3;
  if (disc >= 0.0) {
    // both roots of c1 + 2 c2 t + 3 c3 t^2 without cancellation
    const double s = -(c2 + std::copysign(std::sqrt(disc), c2));
    const double r1 = c3 != 0.0 ? s / (3.0 * c3) : -1.0;
    const double r2 = s != 0.0 ? c1 / s : -1.0;
    for (double r : {std::min(r1, r2), std::max(r1, r2)})
      if (r > 0.0 && r < 1.0) cut[n_cuts++] = r;
  }
  cut[n_cuts] = 1.0;

  Roots roots;
  for (int k = 0; k < n_cuts; k++) {
    double lo = cut[k], hi = cut[k + 1];
    const double f_lo = f(lo), f_hi = f(hi);
    if ((f_lo < 0.0) == (f_hi < 0.0) && f_hi != 0.0) continue;
    if (f_lo == 0.0) continue;    // the start itself, or the end of the piece before
    for (int it = 0; it < 60 && hi - lo > 1e-15; it++) {
      const double mid = 0.5 * (lo + hi);
      ((f(mid) < 0.0) == (f_lo < 0.0) ? lo : hi) = mid;
    }
    roots.t[roots.n++] = hi;
  }
  return roots;
}

// Does point p pass through the triangle within the step, or end nearer to it than `thickness`
// on its own side?  A point that starts nearer than that keeps the gap it has: contact takes
// approaching motion away and never pushes, so it cannot add energy.  `slack` is the share of the
// gap that an iterative solver may leave open; passing through always counts.

inline Touch touch(const Sweep &p, const std::array<Sweep, 3> &tri, double thickness,
                   double slack = SEAM)
{
  Touch result;
  const Vec3 e1 = tri[1].start - tri[0].start, e2 = tri[2].start - tri[0].start;
  const Vec3 q = p.start - tri[0].start;
  const Vec3 normal_start = e1.cross(e2);
  const Vec3 normal_end = (tri[1].end - tri[0].end).cross(tri[2].end - tri[0].end);
  const double double_area = normal_start.norm();
  const double double_area_end = normal_end.norm();
  if (double_area == 0.0 || double_area_end == 0.0) return result;

  const double gap_start = normal_start.dot(q) / double_area;
  const double side = gap_start >= 0.0 ? 1.0 : -1.0;
  const Vec3 normal = side / double_area_end * normal_end;
  const double gap_end = normal.dot(p.end - tri[0].end);
  result.kept = std::min(thickness, std::fabs(gap_start));

  const auto touch_at = [&](const Vec3 &weight) {
    result.hit = true;
    result.weight = weight.cwiseMax(0.0);
    result.weight /= result.weight.sum();
    result.normal = normal;
    result.depth = std::max(0.0, result.kept - gap_end);
  };

  // passes through
  const Vec3 d1 = (tri[1].end - tri[0].end) - e1, d2 = (tri[2].end - tri[0].end) - e2;
  const Vec3 dq = (p.end - tri[0].end) - q;
  const Vec3 n1 = e1.cross(d2) + d1.cross(e2), n2 = d1.cross(d2);
  const Roots roots = cubic_roots(normal_start.dot(q), normal_start.dot(dq) + n1.dot(q),
                                  n1.dot(dq) + n2.dot(q), n2.dot(dq));
  for (int k = 0; k < roots.n; k++) {
    const double t = roots.t[k];
    const auto at = [t](const Sweep &s) -> Vec3 { return s.start + t * (s.end - s.start); };
    const Vec3 weight = barycentric(at(p), at(tri[0]), at(tri[1]), at(tri[2]));
    if (!inside(weight)) continue;
    touch_at(weight);
    result.through = true;
    return result;
  }

  // ends too near
  if (gap_end >= 0.0 && gap_end < result.kept * (1.0 - slack)) {
    const Vec3 weight = barycentric(p.end, tri[0].end, tri[1].end, tri[2].end);
    if (inside(weight)) touch_at(weight);
  }
  return result;
}

}    // namespace sphcloth

#endif
