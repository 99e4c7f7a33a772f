// SPDX-License-Identifier: GPL-2.0-or-later
// Passes over rows that share masses are repeated until they hardly change a speed any more.

#ifndef SPHCLOTH_CONTACT_PASS_CHANGES_H
#define SPHCLOTH_CONTACT_PASS_CHANGES_H

#include <mpi.h>

#include <algorithm>

namespace LAMMPS_NS {

class PassChanges {
 public:
  // Collective: the largest change in a pass on any rank, beside those of the passes before.
  bool are_small(double mine, MPI_Comm world)
  {
    double all;
    MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_MAX, world);
    largest = std::max(largest, all);
    return all <= SMALL * largest;
  }

 private:
  static constexpr double SMALL = 1e-4;
  double largest = 0.0;
};

}    // namespace LAMMPS_NS

#endif
