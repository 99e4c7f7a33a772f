// SPDX-License-Identifier: GPL-2.0-or-later
// Continuous contact of a moving point with a moving triangle.
//
// Both move on straight lines during the step.  The point crosses the triangle's plane where
// (e1 x e2) . q = 0 with e1 = b - a, e2 = c - a, q = p - a: a cubic in time.
// Provot, Graphics Interface 1997; Bridson, Fedkiw & Anderson, ACM Trans. Graph. 21 (2002) 594.

#ifndef SPHCLOTH_CORE_CONTACT_POINT_TRIANGLE_H
#define SPHCLOTH_CORE_CONTACT_POINT_TRIANGLE_H

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

struct ContactResult {
  bool hit = false;
  bool through = false;          // it passes through, not only too near
  Vec3 weight = Vec3::Zero();    // barycentric coordinates of the contact point
  Vec3 normal = Vec3::Zero();    // at the end, from the triangle towards the point's own side
  double depth = 0.0;            // what the end position lacks of the gap to be kept, >= 0
  double gap = 0.0;              // that gap: the thickness, or the gap at the start if smaller
  double clearance = 0.0;        // without a hit: at least so much farther away than that
};

// The tolerance that closes the seams between neighboring triangles in round-off.
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

// Barycentric coordinates of the point of a triangle that is nearest to p: inside, on an edge or a
// vertex.  Ericson, Real-Time Collision Detection, Morgan Kaufmann 2005, section 5.1.5.

inline Vec3 nearest_point(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0.0 && d2 <= 0.0) return {1.0, 0.0, 0.0};
  if (d3 >= 0.0 && d4 <= d3) return {0.0, 1.0, 0.0};
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 0.0, 1.0};
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {d3 / (d3 - d1), d1 / (d1 - d3), 0.0};
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {d6 / (d6 - d2), 0.0, d2 / (d2 - d6)};
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0.0, 1.0 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

// from the nearest point of the triangle to p

inline Vec3 distance_vector(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c,
                            Vec3 &weight)
{
  weight = nearest_point(p, a, b, c);
  return p - weight[0] * a - weight[1] * b - weight[2] * c;
}

// Does the line to a point, from the nearest point of an edge or a vertex, lean towards what begins
// there and runs in a direction?  The cosine between the two, times the length of that line: above
// SEAM the nearest point of all is not on that edge or vertex.

inline double leaning(const Vec3 &direction, const Vec3 &from_nearest)
{
  const double length = direction.norm();
  return length > 0.0 ? from_nearest.dot(direction) / length : 0.0;
}

// The signed volume of point and triangle in the course of the step, times 6:
// c0 + c1 t + c2 t^2 + c3 t^3.

struct SignedVolume {
  double c0, c1, c2, c3;
  bool never_zero() const    // it lies between its Bernstein coefficients
  {
    const double b1 = c0 + c1 / 3.0, b2 = c0 + (2.0 * c1 + c2) / 3.0, b3 = c0 + c1 + c2 + c3;
    return std::min({c0, b1, b2, b3}) > 0.0 || std::max({c0, b1, b2, b3}) < 0.0;
  }
};

inline SignedVolume signed_volume(const Sweep &p, const std::array<Sweep, 3> &tri)
{
  const Vec3 e1 = tri[1].start - tri[0].start, e2 = tri[2].start - tri[0].start;
  const Vec3 q = p.start - tri[0].start;
  const Vec3 d1 = (tri[1].end - tri[0].end) - e1, d2 = (tri[2].end - tri[0].end) - e2;
  const Vec3 dq = (p.end - tri[0].end) - q;
  const Vec3 n0 = e1.cross(e2), n1 = e1.cross(d2) + d1.cross(e2), n2 = d1.cross(d2);
  return {n0.dot(q), n0.dot(dq) + n1.dot(q), n1.dot(dq) + n2.dot(q), n2.dot(dq)};
}

// Where point and triangle are

struct PointAndTriangle {
  const Vec3 &p, &a, &b, &c;
  Vec3 normal;    // twice the area long
  double height;    // of the point above the plane, times twice the area

  PointAndTriangle(const Vec3 &p_, const Vec3 &a_, const Vec3 &b_, const Vec3 &c_) :
      p(p_), a(a_), b(b_), c(c_), normal((b - a).cross(c - a)), height(normal.dot(p - a))
  {
  }
};

// What contact at any later moment of the step needs to know of its start

struct ContactStart {
  double side = 1.0;    // of the triangle's plane: 1 where its normal points, or -1
  double distance = 0.0;

  // to be kept: the thickness, or the distance if that is smaller
  double gap(double thickness) const { return std::min(thickness, distance); }
};

inline ContactStart contact_start(const PointAndTriangle &at)
{
  Vec3 weight;
  return {at.height >= 0.0 ? 1.0 : -1.0, distance_vector(at.p, at.a, at.b, at.c, weight).norm()};
}

// From the nearest point of the triangle to the point.  Above its inside the direction is that of
// the triangle, whatever the distance.

struct Nearness {
  Vec3 weight, direction;
  double distance;
};

inline Nearness nearness(const PointAndTriangle &at, double side)
{
  Nearness near;
  const Vec3 vector = distance_vector(at.p, at.a, at.b, at.c, near.weight);
  near.distance = vector.norm();
  if (near.weight.minCoeff() > 0.0 || near.distance == 0.0)
    near.direction =
        (at.height != 0.0 ? std::copysign(1.0, at.height) : side) / at.normal.norm() * at.normal;
  else
    near.direction = vector / near.distance;
  return near;
}

// Is a point nearer to the inside, the edges or the vertices of the triangle than the gap, by more
// than a share `slack` of it?

inline ContactResult point_triangle_nearness(const PointAndTriangle &at, double side, double gap,
                                             double slack)
{
  ContactResult result;
  const double area_sq = at.normal.squaredNorm();
  result.gap = gap;
  if (at.height * at.height >= gap * gap * area_sq) {
    result.clearance = std::fabs(at.height) / std::sqrt(area_sq) - gap;
    return result;
  }
  const Nearness near = nearness(at, side);
  if (near.distance >= gap * (1.0 - slack)) {
    result.clearance = near.distance - gap;
    return result;
  }
  result.hit = true;
  result.weight = near.weight;
  result.normal = near.direction;
  result.depth = gap - near.distance;
  return result;
}

// Does point p pass through the triangle within the step, or end too near?  A point that starts
// nearer than the thickness keeps the gap it has: contact removes approaching motion and never
// pushes, so it cannot add energy.  Passing through always counts.

inline ContactResult point_triangle_contact(const Sweep &p, const std::array<Sweep, 3> &tri,
                                            double thickness, double slack = SEAM)
{
  ContactResult result;
  const PointAndTriangle start{p.start, tri[0].start, tri[1].start, tri[2].start},
      end{p.end, tri[0].end, tri[1].end, tri[2].end};
  const double double_area = start.normal.norm();
  const double double_area_end = end.normal.norm();
  if (double_area == 0.0 || double_area_end == 0.0) return result;

  const double gap_start = start.height / double_area;
  const double side = gap_start >= 0.0 ? 1.0 : -1.0;

  // passes through: put back to the side where it was, along the normal
  const SignedVolume volume = signed_volume(p, tri);
  const Roots roots = volume.never_zero() ? Roots()
                                          : cubic_roots(volume.c0, volume.c1, volume.c2, volume.c3);
  for (int k = 0; k < roots.n; k++) {
    const double t = roots.t[k];
    const auto at = [t](const Sweep &s) -> Vec3 { return s.start + t * (s.end - s.start); };
    const Vec3 weight = barycentric(at(p), at(tri[0]), at(tri[1]), at(tri[2]));
    if (!inside(weight)) continue;
    result.hit = result.through = true;
    result.weight = weight.cwiseMax(0.0);
    result.weight /= result.weight.sum();
    result.normal = side / double_area_end * end.normal;
    result.gap = std::min(thickness, std::fabs(gap_start));
    result.depth = std::max(0.0, result.gap - result.normal.dot(p.end - tri[0].end));
    return result;
  }
  if (std::fabs(end.height) >= thickness * double_area_end) return result;
  return point_triangle_nearness(end, side, contact_start(start).gap(thickness), slack);
}

}    // namespace sphcloth

#endif
