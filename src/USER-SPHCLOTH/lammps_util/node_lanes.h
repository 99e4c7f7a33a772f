// SPDX-License-Identifier: GPL-2.0-or-later
// Which ranks share memory with this one, and lanes to and from them.  The environment variable
// SPHCLOTH_SHARED_MEMORY=no keeps a rank from sharing: then it sends messages.

#ifndef SPHCLOTH_LAMMPS_UTIL_NODE_LANES_H
#define SPHCLOTH_LAMMPS_UTIL_NODE_LANES_H

#include "core/util/shared_lane.h"
#include "lammps_util/shared_memory.h"
#include "pointers.h"

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace LAMMPS_NS {

class NodeLanes : protected Pointers {
 public:
  explicit NodeLanes(LAMMPS *lmp_) : Pointers(lmp_) {}

  // Collective.  By rank, the most numbers that it and this one send each other at once, either
  // way: both say the same.  Lanes that are long enough stay.
  void connect(const std::map<int, std::size_t> &needs);

  // null: they take messages
  sphcloth::SharedLane *to(int rank) { return lane_of(rank, &Pair::out); }
  sphcloth::SharedLane *from(int rank) { return lane_of(rank, &Pair::in); }

  double bytes() const;

 private:
  struct End {
    SharedMemory memory;
    std::optional<sphcloth::SharedLane> lane;    // where there is memory
  };
  struct Pair {
    End out, in;
    std::size_t capacity = 0;    // that was asked for, even where there are no lanes
  };
  std::map<int, Pair> pairs;    // by rank
  std::vector<bool> shares;    // by rank
  bool searched = false;
  sphcloth::SharedLane::Wait wait = sphcloth::SharedLane::Wait::AWAKE;

  void find_node();
  void open_lanes(const std::vector<int> &ranks);
  void begin_lane(End &, SharedMemory, std::size_t capacity) const;
  sphcloth::SharedLane *lane_of(int rank, End Pair::*which);
};

}    // namespace LAMMPS_NS

#endif
