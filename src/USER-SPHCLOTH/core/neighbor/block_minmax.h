// SPDX-License-Identifier: GPL-2.0-or-later
// Minimum and maximum of a value of the particles around a block of space: where all have the same,
// no neighbor needs to be tested.

#ifndef SPHCLOTH_CORE_NEIGHBOR_BLOCK_MINMAX_H
#define SPHCLOTH_CORE_NEIGHBOR_BLOCK_MINMAX_H

#include <algorithm>
#include <limits>

#include "core/neighbor/blocks.h"

namespace sphcloth {

class BlockMinMax {
 public:
  explicit BlockMinMax(const Blocks &blocks_) : blocks(blocks_) {}

  // value: of each particle, owned and ghost
  void take(const int *value)
  {
    ranges.single.resize(blocks.rows());
    for (std::size_t r = 0; r < blocks.rows(); r++) {
      Range range;
      for (const int i : blocks.in(r)) widen(range, {value[i], value[i]});
      ranges.single[r] = range;
    }
    blocks.spread(ranges, [](Range &range, const Range &more) { widen(range, more); });
  }

  // the maximum of a type in a block and around; the smallest int where there is none
  int greatest(int b, int t) const { return ranges.around[blocks.row(b, t)].max; }
  // the minimum; the largest int where there is none
  int smallest(int b, int t) const { return ranges.around[blocks.row(b, t)].min; }

  double bytes() const { return ranges.bytes(); }

 private:
  struct Range {
    int min = std::numeric_limits<int>::max(), max = std::numeric_limits<int>::min();
  };

  const Blocks &blocks;
  Blocks::Found<Range> ranges;

  static void widen(Range &range, const Range &more)
  {
    range.min = std::min(range.min, more.min);
    range.max = std::max(range.max, more.max);
  }
};

}    // namespace sphcloth

#endif
