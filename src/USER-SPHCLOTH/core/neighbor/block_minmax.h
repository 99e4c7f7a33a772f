// Which values particles have around a block of space: where all have the same, nobody has to look
// at neighbour after neighbour.

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
    ranges.own.resize(blocks.rows());
    for (std::size_t r = 0; r < blocks.rows(); r++) {
      Range range;
      for (const int i : blocks.in(r)) widen(range, {value[i], value[i]});
      ranges.own[r] = range;
    }
    blocks.spread(ranges, [](Range &range, const Range &more) { widen(range, more); });
  }

  // the greatest of a type in a block and around; least int where there is none
  int greatest(int b, int t) const { return ranges.around[blocks.row(b, t)].greatest; }
  // has nobody of that type another?
  bool all_have(int same, int b, int t) const
  {
    const Range &range = ranges.around[blocks.row(b, t)];
    return range.least >= same && range.greatest <= same;
  }

  double bytes() const { return ranges.bytes(); }

 private:
  struct Range {
    int least = std::numeric_limits<int>::max(), greatest = std::numeric_limits<int>::min();
  };

  const Blocks &blocks;
  Blocks::Found<Range> ranges;

  static void widen(Range &range, const Range &more)
  {
    range.least = std::min(range.least, more.least);
    range.greatest = std::max(range.greatest, more.greatest);
  }
};

}    // namespace sphcloth

#endif
