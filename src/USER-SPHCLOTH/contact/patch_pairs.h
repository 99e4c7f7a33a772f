// SPDX-License-Identifier: GPL-2.0-or-later
// Patches of neighboring vertices of a mesh, and by how much those that are near one another may
// have come nearer: a bound for all pairs of triangles and edges of two patches at once, in which
// what a patch moves as a whole does not count.

#ifndef SPHCLOTH_CONTACT_PATCH_PAIRS_H
#define SPHCLOTH_CONTACT_PATCH_PAIRS_H

#include "core/geometry/box_grid.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace LAMMPS_NS {

class PatchPairs {
 public:
  using Vec3 = Eigen::Vector3d;

  // A triangle, and an edge of one, is of the patches of its vertices.  Two patches are near if
  // their boxes are not farther apart than `max_distance`.
  void build(const std::vector<std::array<int, 3>> &triangles, const std::vector<Vec3> &positions,
             double max_distance);

  // The number of the pair of patches of two vertices; -1: they are not near.  A side of a pair of
  // primitives has the patch of any of its vertices.
  int size() const { return static_cast<int>(near.size()); }
  int pair_of(int vertex, int other) const;
  int patch_of(int vertex) const { return patch[vertex]; }

  // After each change: positions at the start and end of this step.  The motion in this step is
  // taken to bring two sides nearer by at most `limit`.
  void measure(const std::vector<Vec3> &start, const std::vector<Vec3> &end, double limit);

  // By which the sides of a pair may have come nearer since build(), with this step: of the pair,
  // and at most of patches that are not near.
  double approach(int pair) const { return bound[pair]; }
  double approach_of_others() const { return bound_of_others; }
  double distance(int pair) const { return apart[pair]; }    // of the boxes, in build()

  double bytes() const;

 private:
  struct Motion {    // of a patch
    Vec3 mean = Vec3::Zero();
    double radius = 0.0;    // by which vertices depart from it
  };

  std::vector<Vec3> then;    // positions
  std::vector<int> patch;    // of a vertex
  std::vector<int> member_first,
      members;    // vertices of patch p: members[member_first[p] .. member_first[p+1])
  std::vector<int> foreign_first, foreign;    // those of other patches in its triangles
  std::vector<sphcloth::Box> boxes;
  sphcloth::BoxGrid grid;
  std::vector<std::array<int, 2>> near;
  std::vector<int> near_first;    // pairs of patch p with later ones, ascending
  std::vector<Motion> moved, moves;    // since then; and in this step
  std::vector<double> bound, apart;
  double bound_of_others = 0.0;

  int n_patches() const { return static_cast<int>(boxes.size()); }
  void assign_patches(const std::vector<std::array<int, 3>> &triangles);
  void find_members(const std::vector<std::array<int, 3>> &triangles);
  void find_near(double max_distance);
  template <class Displacement> void measure(std::vector<Motion> &, Displacement) const;
};

}    // namespace LAMMPS_NS

#endif
