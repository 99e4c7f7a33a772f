// SPDX-License-Identifier: GPL-2.0-or-later
// Segments of neighbors, in memory that stays from one list build to the next.

#ifndef SPHCLOTH_CORE_NEIGHBOR_NEIGHBOR_SPANS_H
#define SPHCLOTH_CORE_NEIGHBOR_NEIGHBOR_SPANS_H

#include "core/util/bytes.h"
#include "core/util/simd.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sphcloth {

// one group of neighbors; LANES indices past the end are readable and valid

struct NeighborSpan {
  const int *of = nullptr;
  int n = 0;
};

// For each slot and type a segment.  They lie one behind the other in a few long arrays, which stay
// from one build to the next; one that is replaced by a longer one moves behind the last.

class NeighborSpans {
 public:
  void start(std::size_t slots, int n_types)
  {
    types = n_types;
    current = used = 0;
    pieces.clear();
    pieces.reserve(slots * n_types);
  }
  NeighborSpan operator()(int slot, int type) const
  {
    const Piece &piece = pieces[number(slot, type)];
    return {piece.of, piece.n};
  }
  int *open(int slot, int type) { return pieces[number(slot, type)].of; }
  // room for at most n more entries and the slack behind them
  int *room(int n)
  {
    while (current < arrays.size() && left() < n + SLACK) {
      end_with_slack();
      current++;
      used = 0;
    }
    if (current == arrays.size()) arrays.emplace_back(std::max(ENTRIES, n + SLACK));
    return arrays[current].data() + used;
  }
  void close(int n)
  {
    pieces.push_back({room(0), n, n});
    used += n;
  }
  // all are closed
  void finish()
  {
    room(0);
    end_with_slack();
    arrays.resize(current + 1);
  }
  // by n in the room that was given last
  int *replace(int slot, int type, int n)
  {
    Piece &piece = pieces[number(slot, type)];
    piece.n = n;
    int *const given = room(0);
    if (n <= piece.room) return std::copy_n(given, n, piece.of) - n;
    piece.of = given;
    piece.room = std::min(n + n / 8, left() - SLACK);
    used += piece.room;
    end_with_slack();
    return given;
  }
  double bytes() const
  {
    double sum = bytes_of(pieces);
    for (const std::vector<int> &array : arrays) sum += bytes_of(array);
    return sum;
  }

 private:
  static constexpr int SLACK = 2 * LANES, ENTRIES = 1 << 17;
  struct Piece {
    int *of;
    int n, room;
  };
  int types = 0;
  std::vector<Piece> pieces;
  std::vector<std::vector<int>> arrays;
  std::size_t current = 0;    // the array that is being filled
  int used = 0;    // of it

  std::size_t number(int slot, int type) const
  {
    return static_cast<std::size_t>(slot) * types + type - 1;
  }
  int left() const { return static_cast<int>(arrays[current].size()) - used; }
  // what loops over whole groups read behind the last segment
  void end_with_slack() { std::fill_n(arrays[current].begin() + used, SLACK, 0); }
};

}    // namespace sphcloth

#endif
