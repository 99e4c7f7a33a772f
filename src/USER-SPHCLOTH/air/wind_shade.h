// SPDX-License-Identifier: GPL-2.0-or-later
// Keeps the wind off triangles that are in the lee of others, of all ranks.

#ifndef SPHCLOTH_AIR_WIND_SHADE_H
#define SPHCLOTH_AIR_WIND_SHADE_H

#include "core/air/wind_shadow.h"
#include "core/util/bytes.h"
#include "lammps_util/particle_columns.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {

class AirMesh;

class WindShade : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  // In three columns, from the first on, the fix keeps of each vertex where it was when the lee was
  // found.
  WindShade(LAMMPS *lmp_, ParticleColumns &columns_, int first_) :
      Pointers(lmp_), columns(columns_), first(first_)
  {
  }

  // after each list build, which renumbers triangles
  void lists_have_changed() { is_known = false; }

  // Of meshes whose motion and wind are known on ghosts, too; collective.  The wind is seen along
  // its mean over their vertices; without one there is no lee.  What was found stays until cloth
  // or wind have changed the picture by a part of a triangle.
  void find(const std::vector<AirMesh *> &meshes);

  // the direction of the wind with which it was found, for restart files; 0: the lee is not known
  const Vec3 &direction() const { return found_with; }
  void restore(const Vec3 &direction) { found_with = direction; }
  double bytes() const
  {
    return shadow.bytes() + sphcloth::bytes_of(seen, points_here, points, corners_here, corners);
  }

 private:
  using Point = sphcloth::WindShadow::Point;
  using Corners = sphcloth::WindShadow::Corners;

  ParticleColumns &columns;
  const int first;
  Vec3 found_with = Vec3::Zero();
  bool is_known = false;    // with the present lists
  std::vector<Vec3> seen;    // of a mesh, by slot
  std::vector<Point> points_here, points;    // vertices of this rank then, with ghosts; of all
  std::vector<Corners> corners_here, corners;    // of triangles
  sphcloth::WindShadow shadow;

  Vec3 mean_direction(const std::vector<AirMesh *> &) const;
  bool still_holds(const std::vector<AirMesh *> &, const Vec3 &direction) const;
  void record(const std::vector<AirMesh *> &);
  Vec3 displacement(const AirMesh &, int slot) const;
  void find_shares(const std::vector<AirMesh *> &);
  void gather(const std::vector<AirMesh *> &);
};

}    // namespace LAMMPS_NS

#endif
