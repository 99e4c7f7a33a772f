// SPDX-License-Identifier: GPL-2.0-or-later
// Does an edge pass through a triangle?  By the signs of five volumes: Möller & Trumbore, J.
// Graphics Tools 2(1) (1997) 21, without a division.

#ifndef SPHCLOTH_CORE_CONTACT_EDGE_THROUGH_TRIANGLE_H
#define SPHCLOTH_CORE_CONTACT_EDGE_THROUGH_TRIANGLE_H

#include "core/contact/point_triangle.h"

namespace sphcloth {

// of four points, times 6

inline double volume_of(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d)
{
  return (b - a).cross(c - a).dot(d - a);
}

// What only touches does not count, nor does an edge in the plane of the triangle.

inline bool passes_through(const Vec3 &p, const Vec3 &q, const Vec3 &a, const Vec3 &b,
                           const Vec3 &c)
{
  const double above = volume_of(a, b, c, p), below = volume_of(a, b, c, q);
  if (!(above * below < 0.0)) return false;
  const double in_plane = SEAM * (b - a).cross(c - a).norm() * (q - p).norm();
  if (std::fabs(above) < in_plane || std::fabs(below) < in_plane) return false;
  const double ab = volume_of(p, q, a, b), bc = volume_of(p, q, b, c), ca = volume_of(p, q, c, a);
  return (ab > 0.0 && bc > 0.0 && ca > 0.0) || (ab < 0.0 && bc < 0.0 && ca < 0.0);
}

// where it does, from the heights of both ends

inline Vec3 point_of_passing(const Vec3 &p, const Vec3 &q, const Vec3 &a, const Vec3 &b,
                             const Vec3 &c)
{
  const double above = volume_of(a, b, c, p), below = volume_of(a, b, c, q);
  return p + above / (above - below) * (q - p);
}

}    // namespace sphcloth

#endif
