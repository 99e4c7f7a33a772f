// SPDX-License-Identifier: GPL-2.0-or-later
// How far a rank knows atoms of other ranks and periodic images, and the request for more.

#ifndef SPHCLOTH_LAMMPS_UTIL_GHOST_REACH_H
#define SPHCLOTH_LAMMPS_UTIL_GHOST_REACH_H

#include "pointers.h"

#include <array>
#include <string>

namespace LAMMPS_NS {

class GhostReach : protected Pointers {
 public:
  // owner: the style that asks, for messages
  GhostReach(LAMMPS *lmp_, std::string owner_) : Pointers(lmp_), owner(std::move(owner_)) {}

  // Are there ghosts?
  bool matters() const;
  double reach() const;

  // From init(), and from pre_exchange(), when LAMMPS is about to look for ghosts: they must reach
  // as far as `needed`, and should as far as `wanted`.  The same on all ranks.
  void require(double needed, double wanted);
  void require_in_run(double needed, double wanted);

  // the shortest distance of an atom from its own image; the box where nothing is periodic
  double size_of_box() const;

 private:
  std::string owner;

  std::array<double, 3> periods() const;    // infinite where the box is not periodic
  double shortest_period() const;
  double images(double reach) const;    // of each atom, itself among them
  bool raise(double needed, double wanted);
};

}    // namespace LAMMPS_NS

#endif
