// SPDX-License-Identifier: GPL-2.0-or-later
// The triangles of one cloth that feel the air, each on the rank of its first vertex.

#ifndef SPHCLOTH_AIR_AIR_MESH_H
#define SPHCLOTH_AIR_AIR_MESH_H

#include "cloth/vertex_halo.h"
#include "contact/contact_mesh.h"
#include "core/air/air_loads.h"
#include "pointers.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace LAMMPS_NS {

class AirMesh : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  // in_fix: IDs of the atoms of the fix, ascending
  AirMesh(LAMMPS *, ContactMesh *, const std::vector<tagint> &in_fix);

  ContactMesh *const mesh;
  VertexHalo halo;
  // by slot: motion of owned vertices, to be set; impulses, 0 before they are added
  std::vector<Vec3> x, v, gain, impulse;
  std::vector<Vec3> wind;    // of owned vertices, to be set; empty: there is no lee
  // water beside owned vertices, to be set: the share of space that it fills, and the mean of its
  // directions times this.  Empty: there is none.
  std::vector<double> water;
  std::vector<Vec3> water_side;

  bool empty() const { return n_felt == 0; }
  // after each list build
  void rebuild();
  // to ghosts
  void forward_motion();
  void forward_positions(std::vector<Vec3> &by_slot);
  // collective; returns the area that takes air, of this rank's triangles
  double add_loads(const sphcloth::AirDrag &, double dt);
  // by slot, of owned vertices: a third of each triangle, as far as no water covers it; collective
  void find_dry_areas(std::vector<Vec3> &);

  // of this rank
  int n_triangles_here() const { return triangles.size(); }
  std::array<int, 3> corners(int t) const    // slots
  {
    return {triangles.slot[0][t], triangles.slot[1][t], triangles.slot[2][t]};
  }
  void set_lee_share(int t, double share) { triangles.lee_share[t] = share; }
  double bytes() const;

 private:
  std::vector<bool> feels;    // of each element
  std::vector<int> n_triangles;    // of each vertex
  int n_felt = 0;
  sphcloth::AirTriangles triangles;

  void find_inverse_mass();
  void find_open_share();
};

}    // namespace LAMMPS_NS

#endif
