// Uniform grid over axis-aligned boxes: which boxes may hold a point?  Boxes enter every cell
// that they overlap, so a query reads one cell.

#ifndef SPHCLOTH_CORE_BOX_GRID_H
#define SPHCLOTH_CORE_BOX_GRID_H

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace sphcloth {

using Box = Eigen::AlignedBox3d;

class BoxGrid {
 public:
  // Buffers are kept from build to build, nothing is allocated once they are large enough.

  void build(const std::vector<Box> &boxes)
  {
    bounds_.setEmpty();
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Box &box : boxes) {
      bounds_.extend(box);
      mean += box.sizes();
    }
    if (boxes.empty()) return;
    choose_cells(mean / static_cast<double>(boxes.size()), boxes.size());

    first_.assign(static_cast<std::size_t>(cells_.prod()) + 1, 0);
    for (const Box &box : boxes) for_cells(box, [&](std::size_t c) { first_[c + 1]++; });
    for (std::size_t c = 1; c < first_.size(); c++) first_[c] += first_[c - 1];
    items_.resize(first_.back());
    cursor_.assign(first_.begin(), first_.end() - 1);
    for (std::size_t b = 0; b < boxes.size(); b++)
      for_cells(boxes[b], [&](std::size_t c) { items_[cursor_[c]++] = static_cast<int>(b); });
  }

  const Box &bounds() const { return bounds_; }

  // calls visit(b) once for every box b in the cells that `probe` overlaps; the caller still
  // tests the box itself

  template <class Visit> void query(const Box &probe, Visit visit)
  {
    const Box clipped = probe.intersection(bounds_);
    if (bounds_.isEmpty() || clipped.isEmpty()) return;
    found_.clear();
    int cells = 0;
    for_cells(clipped, [&](std::size_t c) {
      found_.insert(found_.end(), items_.begin() + first_[c], items_.begin() + first_[c + 1]);
      cells++;
    });
    if (cells > 1) {
      std::sort(found_.begin(), found_.end());
      found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    }
    for (int b : found_) visit(b);
  }

 private:
  Box bounds_;
  Eigen::Vector3d inv_cell_;
  Eigen::Array3i cells_ = Eigen::Array3i::Zero();
  std::vector<int> first_, cursor_, items_, found_;

  // cells as large as the mean box, and not many more of them than boxes

  void choose_cells(Eigen::Vector3d cell, std::size_t n_boxes)
  {
    const Eigen::Vector3d extent = bounds_.sizes();
    const double floor = std::max(extent.maxCoeff() * 1e-3, 1e-300);
    cell = cell.cwiseMax(floor);
    const double limit = 4.0 * static_cast<double>(n_boxes) + 64.0;
    for (;;) {
      cells_ = (extent.array() / cell.array()).ceil().max(1.0).cast<int>();
      if (cells_.cast<double>().prod() <= limit) break;
      cell *= 1.26;
    }
    inv_cell_ = cells_.cast<double>() / extent.array().max(1e-300);
  }

  template <class Visit> void for_cells(const Box &box, Visit visit) const
  {
    const auto cell_of = [&](const Eigen::Vector3d &x) -> Eigen::Array3i {
      const Eigen::Array3d c = ((x - bounds_.min()).cwiseProduct(inv_cell_)).array().floor();
      return c.max(0.0).min((cells_ - 1).cast<double>()).template cast<int>();
    };
    const Eigen::Array3i lo = cell_of(box.min()), hi = cell_of(box.max());
    for (int k = lo[2]; k <= hi[2]; k++)
      for (int j = lo[1]; j <= hi[1]; j++)
        for (int i = lo[0]; i <= hi[0]; i++)
          visit((static_cast<std::size_t>(k) * cells_[1] + j) * cells_[0] + i);
  }
};

}    // namespace sphcloth

#endif
