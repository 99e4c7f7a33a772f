// SPDX-License-Identifier: GPL-2.0-or-later
// Keeps the wind off triangles that are in the lee of others, of all ranks.

#ifndef SPHCLOTH_AIR_WIND_SHADE_H
#define SPHCLOTH_AIR_WIND_SHADE_H

#include "core/air/wind_shadow.h"
#include "core/util/bytes.h"
#include "pointers.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

class AirMesh;

class WindShade : protected Pointers {
 public:
  explicit WindShade(LAMMPS *lmp_) : Pointers(lmp_) {}

  // Of meshes whose motion and wind are known on ghosts, too; collective.  The wind is seen along
  // its mean over their vertices; without one there is no lee.
  void find(const std::vector<AirMesh *> &meshes);
  double bytes() const
  {
    return shadow.bytes() + sphcloth::bytes_of(corners_here, corners, triangles);
  }

 private:
  using Corners = std::array<double, 9>;
  std::vector<Corners> corners_here, corners;    // of this rank's triangles, and of all
  std::vector<sphcloth::WindShadow::Triangle> triangles;
  sphcloth::WindShadow shadow;
};

}    // namespace LAMMPS_NS

#endif
