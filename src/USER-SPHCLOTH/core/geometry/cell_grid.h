// SPDX-License-Identifier: GPL-2.0-or-later
// A box cut into equal cells, which are numbered with x fastest.

#ifndef SPHCLOTH_CORE_GEOMETRY_CELL_GRID_H
#define SPHCLOTH_CORE_GEOMETRY_CELL_GRID_H

#include <Eigen/Geometry>

#include <cstddef>

namespace sphcloth {

using Box = Eigen::AlignedBox3d;

struct CellGrid {
  using Cell = Eigen::Array3i;

  Box bounds;
  Cell cells = Cell::Zero();

  bool empty() const { return bounds.isEmpty(); }

  // Cells of about this size, or larger, so that there are not many more of them than items.

  void cut(const Box &all, Eigen::Vector3d cell, std::size_t n_items)
  {
    bounds = all;
    const Eigen::Vector3d extent = bounds.sizes();
    if (!extent.allFinite()) {    // one cell for all
      cells.setOnes();
      inv_cell.setZero();
      return;
    }
    cell = cell.cwiseMax(std::max(extent.maxCoeff() * 1e-3, 1e-300));
    const double limit = 4.0 * static_cast<double>(n_items) + 64.0;
    for (;;) {
      cells = (extent.array() / cell.array()).ceil().max(1.0).cast<int>();
      if (cells.cast<double>().prod() <= limit) break;
      cell *= 1.26;
    }
    inv_cell = cells.cast<double>() / extent.array().max(1e-300);
  }

  std::size_t size() const { return static_cast<std::size_t>(cells.prod()); }

  // the cell of a place, or the nearest one; any cell of a place that is no number
  Cell of(const Eigen::Vector3d &x) const
  {
    Cell cell;
    for (int d = 0; d < 3; d++) {
      const double c = (x[d] - bounds.min()[d]) * inv_cell[d];
      const int last = cells[d] - 1;
      cell[d] = !(c > 0.0) ? 0 : c < last ? static_cast<int>(c) : last;
    }
    return cell;
  }

  std::size_t number(int i, int j, int k) const
  {
    return (static_cast<std::size_t>(k) * cells[1] + j) * cells[0] + i;
  }

  template <class Visit> void for_cells(const Cell &lo, const Cell &hi, Visit visit) const
  {
    for (int k = lo[2]; k <= hi[2]; k++)
      for (int j = lo[1]; j <= hi[1]; j++)
        for (int i = lo[0]; i <= hi[0]; i++) visit(Cell(i, j, k), number(i, j, k));
  }

 private:
  Eigen::Vector3d inv_cell = Eigen::Vector3d::Zero();
};

}    // namespace sphcloth

#endif
