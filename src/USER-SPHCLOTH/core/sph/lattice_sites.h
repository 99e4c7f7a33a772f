// SPDX-License-Identifier: GPL-2.0-or-later
// The sites of a square or cubic lattice around one of them.

#ifndef SPHCLOTH_CORE_SPH_LATTICE_SITES_H
#define SPHCLOTH_CORE_SPH_LATTICE_SITES_H

#include <cmath>

namespace sphcloth {

// visit(i, j, k, r^2, q = r/support) for those within the support; lengths in spacings

template <class Visit> void for_lattice_sites(double support, int dim, Visit visit)
{
  const int reach = static_cast<int>(support), reach_z = dim == 3 ? reach : 0;
  for (int i = -reach; i <= reach; i++)
    for (int j = -reach; j <= reach; j++)
      for (int k = -reach_z; k <= reach_z; k++) {
        const double r_sq = i * i + j * j + k * k, q = std::sqrt(r_sq) / support;
        if (q < 1.0) visit(i, j, k, r_sq, q);
      }
}

}    // namespace sphcloth

#endif
