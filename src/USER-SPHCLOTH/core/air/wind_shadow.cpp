// SPDX-License-Identifier: GPL-2.0-or-later
// Draws triangles as the wind sees them, and looks up what is in front of a point.

#include "core/air/wind_shadow.h"

#include "core/geometry/buckets.h"
#include "core/util/bytes.h"

#include <algorithm>
#include <cmath>

using namespace sphcloth;
using Eigen::Vector3d;

// of the size of a cell: what is in front by less is taken to touch
static constexpr double TOUCHES = 1e-6;

void WindShadow::build(const std::vector<Triangle> &triangles, const Vector3d &wind)
{
  axes.row(2) = wind.normalized();
  axes.row(0) = axes.row(2).transpose().unitOrthogonal();
  axes.row(1) = axes.row(2).transpose().cross(axes.row(0).transpose());
  pictures.clear();
  Box bounds;
  double mean_size = 0.0;
  for (const Triangle &t : triangles) {
    pictures.push_back({seen(t[0]), seen(t[1]), seen(t[2])});
    const auto &[a, b, c] = pictures.back();
    const Vector3d size = a.cwiseMax(b).cwiseMax(c) - a.cwiseMin(b).cwiseMin(c);
    mean_size += std::max(size[0], size[1]) / static_cast<double>(triangles.size());
    for (const Vector3d &corner : {a, b, c}) bounds.extend(Vector3d(corner[0], corner[1], 0.0));
  }
  tolerance = TOUCHES * mean_size;
  grid = CellGrid();
  if (pictures.empty()) return;
  grid.cut(bounds, Vector3d::Constant(mean_size), pictures.size());
  const auto for_each = [this](auto add) {
    for (std::size_t t = 0; t < pictures.size(); t++) {
      const auto &[a, b, c] = pictures[t];
      grid.for_cells(grid.of(a.cwiseMin(b).cwiseMin(c)), grid.of(a.cwiseMax(b).cwiseMax(c)),
                     [&](const auto &, std::size_t cell) { add(cell, static_cast<int>(t)); });
    }
  };
  sort_into_buckets(grid.size(), for_each, first, items);
}

double WindShadow::lee_share(const Triangle &t) const
{
  if (grid.empty()) return 0.0;
  const Vector3d middle = (t[0] + t[1] + t[2]) / 3.0;
  int n = 0;
  for (const Vector3d &corner : t) n += in_lee(seen(0.5 * (middle + corner)));
  return n / 3.0;
}

static double twice_area(const Vector3d &a, const Vector3d &b, const Vector3d &c)
{
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// A triangle that the wind sees edge-on hides nothing.

bool WindShadow::in_lee(const Vector3d &p) const
{
  const CellGrid::Cell cell = grid.of(p);
  const std::size_t number = grid.number(cell[0], cell[1], cell[2]);
  for (int k = first[number]; k < first[number + 1]; k++) {
    const auto &[a, b, c] = pictures[items[k]];
    if (std::min({a[2], b[2], c[2]}) >= p[2] - tolerance) continue;
    const double whole = twice_area(a, b, c);
    if (whole == 0.0) continue;
    const double of_a = twice_area(p, b, c) / whole, of_b = twice_area(a, p, c) / whole,
                 of_c = 1.0 - of_a - of_b;
    if (of_a < 0.0 || of_b < 0.0 || of_c < 0.0) continue;
    if (of_a * a[2] + of_b * b[2] + of_c * c[2] < p[2] - tolerance) return true;
  }
  return false;
}

double WindShadow::bytes() const { return bytes_of(pictures, first, items); }
