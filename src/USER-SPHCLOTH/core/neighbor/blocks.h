// SPDX-License-Identifier: GPL-2.0-or-later
// Blocks of space, at least as wide as lists reach: the neighbors of a particle are in its block
// or in those around.  What all particles of a type in a block have in common is found once, and
// spread to the blocks around.

#ifndef SPHCLOTH_CORE_NEIGHBOR_BLOCKS_H
#define SPHCLOTH_CORE_NEIGHBOR_BLOCKS_H

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/geometry/buckets.h"
#include "core/neighbor/cell_lists.h"
#include "core/util/bytes.h"
#include "core/util/simd.h"

namespace sphcloth {

class Blocks {
 public:
  // at least so wide, and with many particles on average, so that blocks cost little
  void divide(const Points &p, double width)
  {
    const int n_all = p.n_all;
    types = p.n_types;
    cut(Bounds(p.x, n_all), n_all, width);
    block.resize(n_all);
    for (int i = 0; i < n_all; i++) block[i] = block_at(p.x + 3 * i);
    const auto for_each = [&](auto add) {
      for (int i = 0; i < n_all; i++) add(row(block[i], p.type[i]), i);
    };
    sort_into_buckets(static_cast<std::size_t>(types) * n_blocks, for_each, first, member);
  }

  int count() const { return n_blocks; }
  const int *of_particle() const { return block.data(); }    // [n_all]

  // a row for each type and block, and its particles
  std::size_t rows() const { return first.size() - 1; }
  std::size_t row(int b, int t) const { return static_cast<std::size_t>(t - 1) * n_blocks + b; }
  struct Members {
    const int *from, *to;
    const int *begin() const { return from; }
    const int *end() const { return to; }
    bool empty() const { return from == to; }
  };
  Members in(std::size_t r) const
  {
    return {member.data() + first[r], member.data() + first[r + 1]};
  }

  // What is found of a row: `single` takes in what particles have, `around` what the rows of its
  // type in the blocks around have, itself included.  take(T &, const T &)
  template <class T> struct Found {
    AlignedVector<T> single, around, spare;
    double bytes() const { return bytes_of(single, around, spare); }
  };
  template <class T, class Take> SPHCLOTH_INLINE void spread(Found<T> &found, Take take) const
  {
    found.around.resize(rows());
    found.spare.resize(n_blocks);
    for (int t = 1; t <= types; t++) {
      T *of = found.around.data() + row(0, t), *before = found.spare.data();
      std::copy_n(found.single.data() + row(0, t), n_blocks, of);
      for (int d = 0, stride = 1; d < 3; stride *= n[d++]) {    // along one axis after the other
        if (n[d] == 1) continue;
        std::copy_n(of, n_blocks, before);
        for (int b = 0; b < n_blocks; b++) {
          const int at = b / stride % n[d];
          if (at > 0) take(of[b], before[b - stride]);
          if (at < n[d] - 1) take(of[b], before[b + stride]);
        }
      }
    }
  }

  double bytes() const { return bytes_of(block, first, member); }

 private:
  int types = 0, n_blocks = 0;
  std::array<int, 3> n{1, 1, 1};
  std::array<double, 3> lo{}, inv_width{};
  std::vector<int> block, first, member;    // of a particle; of a row: its members

  void cut(const Extent &extent, int n_all, double width)
  {
    constexpr double PARTICLES = 32.0;    // in a block, on average over all space, or more
    n.fill(1);
    inv_width.fill(0.0);
    lo = extent.lo;
    const auto along = [&](int d) {
      const double blocks = std::floor((extent.hi[d] - extent.lo[d]) / width);
      return blocks > 1.0 ? blocks : 1.0;    // of what is no number 1
    };
    while (along(0) * along(1) * along(2) > n_all / PARTICLES + 1.0) width *= 1.1;
    for (int d = 0; d < 3; d++) {
      n[d] = static_cast<int>(along(d));
      if (n[d] > 1) inv_width[d] = n[d] / (extent.hi[d] - extent.lo[d]);
    }
    n_blocks = n[0] * n[1] * n[2];
  }

  int block_at(const double *x) const
  {
    std::array<int, 3> at;
    for (int d = 0; d < 3; d++)    // what is no number lies in the first
      at[d] = static_cast<int>(std::min(std::max(0.0, (x[d] - lo[d]) * inv_width[d]), n[d] - 1.0));
    return (at[2] * n[1] + at[1]) * n[0] + at[0];
  }
};

}    // namespace sphcloth

#endif
