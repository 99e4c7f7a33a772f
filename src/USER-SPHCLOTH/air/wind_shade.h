// SPDX-License-Identifier: GPL-2.0-or-later
// Keeps the wind off triangles that are in the lee of others, of all ranks.

#ifndef SPHCLOTH_AIR_WIND_SHADE_H
#define SPHCLOTH_AIR_WIND_SHADE_H

#include "core/air/wind_shadow.h"
#include "core/util/bytes.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {

class AirMesh;

class WindShade : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  explicit WindShade(LAMMPS *lmp_) : Pointers(lmp_) {}

  // Behind each list build, which renumbers triangles, and where a restart file is written: a run
  // that continues finds the lee anew, too.
  void forget() { found_with.setZero(); }

  // Of meshes whose motion and wind are known on ghosts, too; collective.  The wind is seen along
  // its mean over their vertices; without one there is no lee.  What was found stays until cloth
  // or wind have changed the picture by a part of a triangle.
  void find(const std::vector<AirMesh *> &meshes);
  double bytes() const
  {
    return shadow.bytes() + sphcloth::bytes_of(points_here, points, corners_here, corners);
  }

 private:
  using Point = sphcloth::WindShadow::Point;
  using Corners = sphcloth::WindShadow::Corners;

  Vec3 found_with = Vec3::Zero();    // direction of the wind; 0: the lee is not known
  std::vector<Point> points_here, points;    // vertices of this rank then, with ghosts; of all
  std::vector<Corners> corners_here, corners;    // of triangles
  sphcloth::WindShadow shadow;

  Vec3 mean_direction(const std::vector<AirMesh *> &) const;
  bool still_holds(const std::vector<AirMesh *> &, const Vec3 &direction) const;
  void gather(const std::vector<AirMesh *> &);
};

}    // namespace LAMMPS_NS

#endif
