// SPDX-License-Identifier: GPL-2.0-or-later
// A point and a triangle: coordinates in it, and what of it is nearest to the point.

#ifndef SPHCLOTH_CORE_CONTACT_POINT_TRIANGLE_H
#define SPHCLOTH_CORE_CONTACT_POINT_TRIANGLE_H

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sphcloth {

using Vec3 = Eigen::Vector3d;

// positions at the start and at the end of the step

struct Sweep {
  Vec3 start, end;
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
  // two corners in one place are no edge
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3) return {d3 / (d3 - d1), d1 / (d1 - d3), 0.0};
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

}    // namespace sphcloth

#endif
