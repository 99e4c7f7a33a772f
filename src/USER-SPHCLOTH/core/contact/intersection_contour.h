// SPDX-License-Identifier: GPL-2.0-or-later
// The curve in which two meshes meet, and which way they must move to make it shorter: Volino &
// Magnenat-Thalmann, ACM Trans. Graph. 25 (2006) 1154.

#ifndef SPHCLOTH_CORE_CONTACT_INTERSECTION_CONTOUR_H
#define SPHCLOTH_CORE_CONTACT_INTERSECTION_CONTOUR_H

#include "core/contact/edge_through_triangle.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sphcloth {

// The weights of p, q, and, negative, of a, b, c, where the edge pq passes through the triangle.

inline std::array<double, 5> weights_of_passing(const Vec3 &p, const Vec3 &q, const Vec3 &a,
                                                const Vec3 &b, const Vec3 &c)
{
  const double above = volume_of(a, b, c, p), below = volume_of(a, b, c, q);
  const double ab = volume_of(p, q, a, b), bc = volume_of(p, q, b, c), ca = volume_of(p, q, c, a);
  const double at = above / (above - below), all = ab + bc + ca;
  return {1.0 - at, at, -bc / all, -ca / all, -ab / all};
}

// Unit vector along the curve, from the edge pq, which passes through a plane, into a triangle at
// this edge whose third vertex is r; 0 if that triangle lies in the plane

inline Vec3 along_contour(const Vec3 &p, const Vec3 &q, const Vec3 &r, const Vec3 &plane_normal)
{
  const Vec3 line = (q - p).cross(r - p).cross(plane_normal);
  const double length = line.norm();
  if (!(length > 0.0)) return Vec3::Zero();
  const Vec3 edge = (q - p).normalized(), inward = (r - p) - edge.dot(r - p) * edge;
  return (line.dot(inward) < 0.0 ? -1.0 : 1.0) / length * line;
}

// The share of one end of the curve in minus the gradient of its length, by the displacement of the
// edge less that of the triangle: `along` is the sum of the directions of the curve from there.
// An edge along the triangle would have to move very far: the steepness is bounded.

inline Vec3 shortening(const Vec3 &p, const Vec3 &q, const Vec3 &normal, const Vec3 &along)
{
  constexpr double FLATTEST = 0.1;
  const Vec3 edge = (q - p).normalized();
  const double rise = edge.dot(normal);
  const double bounded = std::copysign(std::max(std::fabs(rise), FLATTEST), rise);
  return along - 2.0 * edge.dot(along) / bounded * normal;
}

}    // namespace sphcloth

#endif
