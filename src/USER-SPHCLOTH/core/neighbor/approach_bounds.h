// SPDX-License-Identifier: GPL-2.0-or-later
// How much nearer particles may have come to each other, from place to place.
//
// The displacements of the particles of a block of space lie in a box.  The farthest corners of the
// boxes of two blocks say how much nearer a particle of one may have come to one of the other, or
// the longest displacements of both if their sum is less: what moves together stays as it is,
// however fast it goes, and what is fast elsewhere does not matter.  Types have boxes of their own.

#ifndef SPHCLOTH_CORE_NEIGHBOR_APPROACH_BOUNDS_H
#define SPHCLOTH_CORE_NEIGHBOR_APPROACH_BOUNDS_H

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/neighbor/blocks.h"

namespace sphcloth {

class ApproachBounds {
 public:
  struct Position {
    float x, y, z;
  };

  explicit ApproachBounds(const Blocks &blocks_) : blocks(blocks_) {}

  // Takes in displacements: now - center - held; held may be
  // null.
  SPHCLOTH_MULTIVERSION void measure(const double *now, const std::array<double, 3> &center,
                                     const Position *held)
  {
    held ? measure_all<true>(now, center, held) : measure_all<false>(now, center, held);
    blocks.spread(boxes, [](Box &box, const Box &more) { take(box, more); });
  }

  // the most by which one of type t in a block may have come nearer to one of another type around;
  // of velocities: the fastest
  float between(int b, int t, int other) const
  {
    const Box &one = boxes.single[blocks.row(b, t)], &two = boxes.around[blocks.row(b, other)];
    const Lanes gap = larger(larger(one.hi - two.lo, two.hi - one.lo), Lanes{});
    const float corners = gap[0] * gap[0] + gap[1] * gap[1] + gap[2] * gap[2];
    const float longest_sq = std::max(one.hi[3], 0.0F), other_sq = std::max(two.hi[3], 0.0F);
    return std::min(std::sqrt(corners), std::sqrt(longest_sq) + std::sqrt(other_sq));
  }

  double bytes() const { return boxes.bytes(); }

 private:
  typedef float Lanes __attribute__((vector_size(16)));
  static constexpr float MAX = std::numeric_limits<float>::max();

  // x, y, z, and the squared length; empty at first
  struct Box {
    Lanes lo{MAX, MAX, MAX, 0.0F}, hi{-MAX, -MAX, -MAX, 0.0F};
  };

  const Blocks &blocks;
  Blocks::Found<Box> boxes;

  static SPHCLOTH_INLINE Lanes larger(const Lanes &a, const Lanes &b) { return a > b ? a : b; }
  static SPHCLOTH_INLINE Lanes smaller(const Lanes &a, const Lanes &b) { return a < b ? a : b; }
  static SPHCLOTH_INLINE void take(Box &box, const Box &more)
  {
    box.lo = smaller(box.lo, more.lo);
    box.hi = larger(box.hi, more.hi);
  }

  template <bool HELD>
  SPHCLOTH_INLINE void measure_all(const double *now, const std::array<double, 3> &center,
                                   const Position *held)
  {
    const double cx = center[0], cy = center[1], cz = center[2];
    boxes.single.resize(blocks.rows());
    for (std::size_t r = 0; r < blocks.rows(); r++) {
      Box box;
      for (const int i : blocks.in(r)) {
        const double *x = now + 3 * static_cast<std::ptrdiff_t>(i);
        Lanes at{static_cast<float>(x[0] - cx), static_cast<float>(x[1] - cy),
                 static_cast<float>(x[2] - cz), 0.0F};
        if (HELD) at -= Lanes{held[i].x, held[i].y, held[i].z, 0.0F};
        at[3] = at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
        take(box, {at, at});
      }
      boxes.single[r] = box;
    }
  }
};

}    // namespace sphcloth

#endif
