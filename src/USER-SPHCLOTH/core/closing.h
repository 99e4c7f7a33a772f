// How much nearer particles may have come to each other, from place to place.
//
// Space is cut into blocks at least as wide as lists reach, so that the neighbours of a particle are in its
// block or in those around.  The displacements of the particles of a block lie in a box.  The farthest corners of the
// boxes of two blocks say how much nearer a particle of one may have come to one of the other, or the longest
// displacements of both if their sum is less: what moves together stays as it is, however fast it goes, and
// what is fast elsewhere does not matter.  Types have boxes of their own.

#ifndef SPHCLOTH_CORE_CLOSING_H
#define SPHCLOTH_CORE_CLOSING_H

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "bytes.h"
#include "neighbours.h"
#include "simd.h"

namespace sphcloth {

class Closing {
 public:
  struct Place {
    float x, y, z;
  };

  // x: [n_all][3]; at least so wide, and with many particles on average, so that blocks cost little
  void divide(const double *x, const int *type, int n_all, int n_types, double width)
  {
    types = n_types;
    cut(Bounds(x, n_all), n_all, width);
    block.resize(n_all);
    first.assign(static_cast<std::size_t>(types) * n_blocks + 1, 0);
    for (int i = 0; i < n_all; i++) {
      block[i] = block_at(x + 3 * i);
      first[row(block[i], type[i]) + 1]++;
    }
    for (std::size_t r = 1; r < first.size(); r++) first[r] += first[r - 1];
    member.resize(n_all);
    std::vector<int> next(first.begin(), first.end() - 1);
    for (int i = 0; i < n_all; i++) member[next[row(block[i], type[i])]++] = i;
    own.resize(first.size() - 1);
    around.resize(own.size());
    spare.resize(n_blocks);
  }

  int blocks() const { return n_blocks; }
  const int *block_of() const { return block.data(); }    // [n_all]
  bool any(int b, int t) const { return first[row(b, t)] < first[row(b, t) + 1]; }

  // Takes in how far all particles are from a place of theirs: now - centre - held; held may be null.
  SPHCLOTH_MULTIVERSION void measure(const double *now, const std::array<double, 3> &centre,
                                     const Place *held)
  {
    held ? measure_all<true>(now, centre, held) : measure_all<false>(now, centre, held);
    for (int t = 1; t <= types; t++) spread(t);
  }

  // the most by which one of type t in a block may have come nearer to one of another type around; of
  // velocities: the fastest
  float between(int b, int t, int other) const
  {
    const Box &one = own[row(b, t)], &two = around[row(b, other)];
    const Lanes gap = larger(larger(one.hi - two.lo, two.hi - one.lo), Lanes{});
    const float corners = gap[0] * gap[0] + gap[1] * gap[1] + gap[2] * gap[2];
    const float longest_sq = std::max(one.hi[3], 0.0F), other_sq = std::max(two.hi[3], 0.0F);
    return std::min(std::sqrt(corners), std::sqrt(longest_sq) + std::sqrt(other_sq));
  }

  double bytes() const { return bytes_of(block, first, member, own, around, spare); }

 private:
  typedef float Lanes __attribute__((vector_size(16)));
  static constexpr float FAR = std::numeric_limits<float>::max();

  // x, y, z, and the squared length; empty at first
  struct Box {
    Lanes lo{FAR, FAR, FAR, 0.0F}, hi{-FAR, -FAR, -FAR, 0.0F};
  };

  int types = 0, n_blocks = 0;
  std::array<int, 3> n{1, 1, 1};
  std::array<double, 3> lo{}, inv_width{};
  std::vector<int> block, first, member;    // of a particle; of [type][block], and who they are
  AlignedVector<Box> own, around, spare;    // [type][block]; of one type

  static SPHCLOTH_INLINE Lanes larger(const Lanes &a, const Lanes &b) { return a > b ? a : b; }
  static SPHCLOTH_INLINE Lanes smaller(const Lanes &a, const Lanes &b) { return a < b ? a : b; }
  static SPHCLOTH_INLINE void take(Box &box, const Box &more)
  {
    box.lo = smaller(box.lo, more.lo);
    box.hi = larger(box.hi, more.hi);
  }
  std::size_t row(int b, int t) const { return static_cast<std::size_t>(t - 1) * n_blocks + b; }

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

  template <bool HELD>
  SPHCLOTH_INLINE void measure_all(const double *now, const std::array<double, 3> &centre,
                                   const Place *held)
  {
    const double cx = centre[0], cy = centre[1], cz = centre[2];
    for (std::size_t r = 0; r < own.size(); r++) {
      Box box;
      for (int k = first[r]; k < first[r + 1]; k++) {
        const int i = member[k];
        const double *x = now + 3 * static_cast<std::ptrdiff_t>(i);
        Lanes at{static_cast<float>(x[0] - cx), static_cast<float>(x[1] - cy),
                 static_cast<float>(x[2] - cz), 0.0F};
        if (HELD) at -= Lanes{held[i].x, held[i].y, held[i].z, 0.0F};
        at[3] = at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
        take(box, {at, at});
      }
      own[r] = box;
    }
  }

  // boxes of a type, to the blocks around along one axis after the other
  SPHCLOTH_INLINE void spread(int t)
  {
    Box *of = around.data() + row(0, t);
    std::copy_n(own.data() + row(0, t), n_blocks, of);
    for (int d = 0, stride = 1; d < 3; stride *= n[d++]) {
      if (n[d] == 1) continue;
      std::copy_n(of, n_blocks, spare.data());
      for (int b = 0; b < n_blocks; b++) {
        const int at = b / stride % n[d];
        if (at > 0) take(of[b], spare[b - stride]);
        if (at < n[d] - 1) take(of[b], spare[b + stride]);
      }
    }
  }
};

}    // namespace sphcloth

#endif
