// SPDX-License-Identifier: GPL-2.0-or-later
// Draws triangles as the wind sees them, and looks up what is in front of a point.

#include "core/air/wind_shadow.h"

#include "core/util/bytes.h"

#include <algorithm>
#include <limits>

using namespace sphcloth;
using Eigen::Vector2d;
using Eigen::Vector3d;

// of the mean length of an edge: what is in front by less is taken to touch
static constexpr double TOUCHES = 1e-6;

void WindShadow::build(const std::vector<Point> &points, const std::vector<Corners> &triangles,
                       const Vector3d &wind)
{
  Eigen::Matrix3d axes;
  axes.row(2) = wind.normalized();
  axes.row(0) = axes.row(2).transpose().unitOrthogonal();
  axes.row(1) = axes.row(2).transpose().cross(axes.row(0).transpose());
  seen.clear();
  for (const Point &x : points) seen.push_back(axes * Eigen::Map<const Vector3d>(x.data()));

  faces.clear();
  pictures.clear();
  size = 0.0;
  double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
  for (const Corners &t : triangles) {
    Box box(seen[t[0]]);
    box.extend(seen[t[1]]).extend(seen[t[2]]);
    for (int q = 0; q < 3; q++)
      size += (seen[t[q]] - seen[t[(q + 1) % 3]]).head<2>().norm() /
          (3.0 * static_cast<double>(triangles.size()));
    nearest = std::min(nearest, box.min()[2]);
    farthest = std::max(farthest, box.max()[2]);
    box.min()[2] = box.max()[2] = 0.0;
    pictures.push_back(box);
    faces.push_back(face_of(t));
  }
  range = triangles.empty() ? 0.0 : farthest - nearest;
  grid.build(pictures);
}

// A triangle that the wind sees edge-on hides nothing.

WindShadow::Face WindShadow::face_of(const Corners &t) const
{
  const Vector3d &a = seen[t[0]], b = seen[t[1]] - a, c = seen[t[2]] - a;
  const double whole = b[0] * c[1] - b[1] * c[0];
  Face face{a, Vector2d::Zero(), Vector2d::Zero(), b[2], c[2]};
  if (whole == 0.0) return face;
  face.to_b = Vector2d(c[1], -c[0]) / whole;
  face.to_c = Vector2d(-b[1], b[0]) / whole;
  face.min_depth = a[2] + std::min({0.0, b[2], c[2]});
  return face;
}

// A face is read once for the three points, which lie close together.

double WindShadow::lee_share(const Corners &t) const
{
  const Vector3d middle = (seen[t[0]] + seen[t[1]] + seen[t[2]]) / 3.0;
  std::array<Vector3d, 3> open;    // points in front of which nothing was found yet
  Box around;
  for (int k = 0; k < 3; k++) {
    open[k] = 0.5 * (middle + seen[t[k]]) - Vector3d(0.0, 0.0, TOUCHES * size);
    around.extend(Vector3d(open[k][0], open[k][1], 0.0));
  }
  const double depth = std::max({open[0][2], open[1][2], open[2][2]});
  int n = 3;
  grid.query(around, [&](int f) {
    const Face &face = faces[f];
    if (face.min_depth >= depth) return;
    for (int k = n - 1; k >= 0; k--)
      if (face.hides(open[k])) open[k] = open[--n];
  });
  return (3 - n) / 3.0;
}

double WindShadow::bytes() const { return bytes_of(seen, faces, pictures) + grid.bytes(); }
