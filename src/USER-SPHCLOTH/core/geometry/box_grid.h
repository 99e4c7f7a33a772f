// SPDX-License-Identifier: GPL-2.0-or-later
// Uniform grid over axis-aligned boxes: which boxes may hold a point?  Boxes enter every cell
// that they overlap, so a query reads one cell.

#ifndef SPHCLOTH_CORE_GEOMETRY_BOX_GRID_H
#define SPHCLOTH_CORE_GEOMETRY_BOX_GRID_H

#include "core/geometry/buckets.h"
#include "core/geometry/cell_grid.h"
#include "core/util/bytes.h"

#include <vector>

namespace sphcloth {

class BoxGrid {
 public:
  // Buffers are kept from build to build, nothing is allocated once they are large enough.

  void build(const std::vector<Box> &boxes)
  {
    Box bounds;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Box &box : boxes) {
      bounds.extend(box);
      mean += box.sizes();
    }
    grid.bounds = bounds;
    if (boxes.empty()) return;
    grid.cut(bounds, mean / static_cast<double>(boxes.size()), boxes.size());

    begin.resize(boxes.size());
    for (std::size_t b = 0; b < boxes.size(); b++) begin[b] = grid.of(boxes[b].min());
    const auto for_each = [&](auto add) {
      for (std::size_t b = 0; b < boxes.size(); b++)
        grid.for_cells(begin[b], grid.of(boxes[b].max()),
                       [&](const CellGrid::Cell &, std::size_t c) { add(c, static_cast<int>(b)); });
    };
    sort_into_buckets(grid.size(), for_each, first, items);
  }

  // calls visit(b) once for every box b in the cells that `probe` overlaps, in the order of the
  // cells; the caller still tests the box itself

  template <class Visit> void query(const Box &probe, Visit visit) const
  {
    const Box clipped = probe.intersection(grid.bounds);
    if (grid.empty() || clipped.isEmpty()) return;
    const CellGrid::Cell lo = grid.of(clipped.min()), hi = grid.of(clipped.max());
    grid.for_cells(lo, hi, [&](const CellGrid::Cell &cell, std::size_t c) {
      for (int n = first[c]; n < first[c + 1]; n++) {
        const int b = items[n];
        // one that lies in several of these cells is seen in the first of them
        if ((cell == lo || cell == begin[b]).all()) visit(b);
      }
    });
  }

  double bytes() const { return bytes_of(begin, first, items); }

 private:
  CellGrid grid;
  std::vector<CellGrid::Cell> begin;    // the first cell of each box
  std::vector<int> first, items;
};

}    // namespace sphcloth

#endif
