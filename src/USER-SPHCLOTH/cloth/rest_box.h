// SPDX-License-Identifier: GPL-2.0-or-later
// The periodic box in which a cloth has its rest positions.  Rest lengths across a periodic face
// are measured in it, whatever the box becomes.

#ifndef SPHCLOTH_CLOTH_REST_BOX_H
#define SPHCLOTH_CLOTH_REST_BOX_H

#include "domain.h"

#include <Eigen/Core>

#include <cmath>

namespace LAMMPS_NS {

struct RestBox {    // plain and without gaps, for the restart file
  double side[3];    // 0: not periodic
  double xy, xz, yz;

  static RestBox of(const Domain *domain)
  {
    return {{domain->xperiodic ? domain->xprd : 0.0, domain->yperiodic ? domain->yprd : 0.0,
             domain->zperiodic ? domain->zprd : 0.0},
            domain->xy, domain->xz, domain->yz};
  }

  Eigen::Vector3d nearest_image(Eigen::Vector3d d) const
  {
    const Eigen::Vector3d edges[3] = {{side[0], 0.0, 0.0}, {xy, side[1], 0.0}, {xz, yz, side[2]}};
    for (int k : {2, 1, 0})
      if (side[k] > 0.0) d -= std::round(d[k] / side[k]) * edges[k];
    return d;
  }
};

}    // namespace LAMMPS_NS

#endif
