// SPDX-License-Identifier: GPL-2.0-or-later
// Which triangles lie in the lee of others?  All are seen along the wind, as a flat picture with
// depths that is cut into cells; a point of a triangle is in the lee if one of another is in front
// of it.

#ifndef SPHCLOTH_CORE_AIR_WIND_SHADOW_H
#define SPHCLOTH_CORE_AIR_WIND_SHADOW_H

#include "core/geometry/cell_grid.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace sphcloth {

class WindShadow {
 public:
  using Triangle = std::array<Eigen::Vector3d, 3>;

  // wind: any length but 0
  void build(const std::vector<Triangle> &triangles, const Eigen::Vector3d &wind);

  // share of a triangle that is in the lee of those: of three points of it, on the lines from its
  // middle to its corners.  Without triangles none is.
  double lee_share(const Triangle &) const;

  double bytes() const;

 private:
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();    // rows: two across the wind, and along it
  double tolerance = 0.0;    // of depths
  CellGrid grid;
  std::vector<Triangle> pictures;
  std::vector<int> first, items;    // of each cell

  Eigen::Vector3d seen(const Eigen::Vector3d &x) const { return axes * x; }
  bool in_lee(const Eigen::Vector3d &seen_point) const;
};

}    // namespace sphcloth

#endif
