// SPDX-License-Identifier: GPL-2.0-or-later
// Which triangles lie in the lee of others?  All are seen along the wind, as a flat picture with
// depths; a point of a triangle is in the lee if one of another is in front of it.

#ifndef SPHCLOTH_CORE_AIR_WIND_SHADOW_H
#define SPHCLOTH_CORE_AIR_WIND_SHADOW_H

#include "core/geometry/box_grid.h"

#include <Eigen/Core>

#include <array>
#include <limits>
#include <vector>

namespace sphcloth {

class WindShadow {
 public:
  using Point = std::array<double, 3>;
  using Corners = std::array<int, 3>;    // numbers of points

  // wind: any length but 0
  void build(const std::vector<Point> &points, const std::vector<Corners> &triangles,
             const Eigen::Vector3d &wind);

  // share of a triangle of these points that is in the lee: of three points of it, on the lines
  // from its middle to its corners
  double lee_share(const Corners &) const;

  // mean length of the edges of the triangles in the picture, and how far the points are apart
  // along the wind; 0 without triangles
  double mean_size() const { return size; }
  double depth() const { return range; }
  double bytes() const;

 private:
  // A triangle over the picture: of a place, relative to corner a, the shares of corners b and c
  // and the depth.
  struct Face {
    Eigen::Vector3d a;
    Eigen::Vector2d to_b, to_c;
    double depth_b, depth_c;
    double min_depth = std::numeric_limits<double>::infinity();

    bool hides(const Eigen::Vector3d &x) const
    {
      const Eigen::Vector2d at = (x - a).head<2>();
      const double b = at.dot(to_b), c = at.dot(to_c);
      return b >= 0.0 && c >= 0.0 && b + c <= 1.0 && a[2] + b * depth_b + c * depth_c < x[2];
    }
  };

  double size = 0.0, range = 0.0;
  std::vector<Eigen::Vector3d> seen;    // points: two coordinates across the wind, one along it
  std::vector<Face> faces;
  std::vector<Box> pictures;    // without depth
  BoxGrid grid;

  Face face_of(const Corners &) const;
};

}    // namespace sphcloth

#endif
