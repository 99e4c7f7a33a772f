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
  // what this rank and another one send each other at once, in numbers; both say the same
  struct Need {
    int rank;
    std::size_t out, in;
  };

  explicit NodeLanes(LAMMPS *lmp_) : Pointers(lmp_) {}

  // Collective.  Lanes that are long enough stay.
  void connect(const std::vector<Need> &);

  // null: they take messages
  sphcloth::SharedLane *to(int rank) { return lane_of(rank, &Pair::out); }
  sphcloth::SharedLane *from(int rank) { return lane_of(rank, &Pair::in); }

  double bytes() const;

 private:
  struct End {
    SharedMemory memory;
    std::optional<sphcloth::SharedLane> lane;    // where there is memory
    std::size_t capacity = 0;    // that was asked for, even where there is none
  };
  struct Pair {
    End out, in;
  };
  std::map<int, Pair> pairs;    // by rank
  std::vector<bool> shares;    // by rank
  bool searched = false;
  sphcloth::SharedLane::Wait wait = sphcloth::SharedLane::Wait::AWAKE;

  void find_node();
  void open_lanes(const std::vector<int> &ranks);
  void begin_lane(End &, SharedMemory) const;
  sphcloth::SharedLane *lane_of(int rank, End Pair::*which);
};

}    // namespace LAMMPS_NS

#endif
