// SPDX-License-Identifier: GPL-2.0-or-later
// Where a rank knows all triangles of a mesh: around its sub-domain, as far as ghosts reached at
// the last list build.  A particle whose sweep leaves it might pass a triangle that is not here.

#ifndef SPHCLOTH_CONTACT_KNOWN_REGION_H
#define SPHCLOTH_CONTACT_KNOWN_REGION_H

#include "contact/moving_triangles.h"
#include "lammps_util/ghost_reach.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

class KnownRegion : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  KnownRegion(LAMMPS *lmp_, const MovingTriangles &mesh_) :
      Pointers(lmp_), mesh(mesh_), ghosts(lmp, mesh.label)
  {
  }

  // after each list build, collective
  void rebuild();

  // of owned vertices, from the list build to the end of this step
  double max_vertex_displacement() const;

  // The sweeps of this step; vertex_displacement: of all ranks.  It is an error if one leaves the
  // region where the mesh may be.
  void check(double vertex_displacement) const;

 private:
  struct Interval {
    double low, high;
  };

  const MovingTriangles &mesh;
  GhostReach ghosts;
  bool bounded = false;
  double longest_edge = 0.0, reach = 0.0;
  std::vector<Vec3> vertices_then;    // owned ones, at the list build
  // along each axis, in fractions of the box where it is tilted: what is known, where the mesh was,
  // the box, and a unit of length
  std::array<Interval, 3> known, occupied;
  std::array<double, 3> period, unit;

  Vec3 in_box(const Vec3 &) const;
  std::array<Interval, 3> around_sweeps() const;
  double missing(const Vec3 &low, const Vec3 &high, double margin) const;
  bool may_meet_mesh(const Vec3 &low, const Vec3 &high, double margin) const;
};

}    // namespace LAMMPS_NS

#endif
