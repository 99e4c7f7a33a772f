// SPDX-License-Identifier: GPL-2.0-or-later
// Patches of neighboring vertices of a mesh, and by how much two of them may have come nearer: a
// bound for all pairs of triangles and edges of both at once.  How a patch moves and turns as a
// whole, together with the other one, does not count.

#ifndef SPHCLOTH_CORE_CONTACT_MESH_PATCHES_H
#define SPHCLOTH_CORE_CONTACT_MESH_PATCHES_H

#include "core/geometry/cell_grid.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace sphcloth {

class MeshPatches {
 public:
  using Vec3 = Eigen::Vector3d;
  using Triangles = std::vector<std::array<int, 3>>;

  // A triangle, and an edge of one, is of the patch of its first vertex.
  void build(const Triangles &, const std::vector<Vec3> &positions);
  int size() const { return first_member.empty() ? 0 : static_cast<int>(first_member.size()) - 1; }
  int patch_of(int vertex) const { return patch[vertex]; }
  // vertices of patch p: members[first_member[p] .. first_member[p+1])
  std::vector<int> first_member, members;
  // of all triangles of patch p
  Box box(int p, const std::vector<Vec3> &positions) const;

  // Bounds are of motion since here.
  void start_from(const std::vector<Vec3> &positions);

  // after each change: positions at the start and at the end of this step
  void measure(const std::vector<Vec3> &start, const std::vector<Vec3> &end);

  // By which the sides of any pair of two patches may have come nearer: until this step, and in it.
  // In a step turning counts.
  double approach_before(int p, int q) const;
  double approach_in_step(int p, int q) const { return approach(moves[p], moves[q]); }
  // The same between the start of the step that was measured before and that of this one.
  double approach_since(int p, int q) const { return approach(moves_since[p], moves_since[q]); }
  // The same of any two patches; in this step it is taken to be at most `limit`.
  double approach_of_any(double limit) const;

  double bytes() const;

 private:
  struct Motion {
    Vec3 mean = Vec3::Zero();
    double radius = 0.0;    // by which vertices depart from it
  };
  static double approach(const Motion &a, const Motion &b)
  {
    return (a.mean - b.mean).norm() + a.radius + b.radius;
  }
  struct Pose {
    Vec3 center = Vec3::Zero();
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  };
  struct Turned {    // since start_from()
    Pose pose;
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    double radius = 0.0;    // by which vertices depart from a rigid motion
  };

  std::vector<int> patch;    // of a vertex
  std::vector<int> first_foreign, foreign;    // vertices of other patches in its triangles
  std::vector<std::array<int, 3>> anchors;    // three vertices that tell how a patch has turned
  std::vector<Vec3> then;    // positions
  std::vector<Pose> poses_then;
  std::vector<double> extent_then;    // of a patch, from its center
  std::vector<Turned> turned;
  std::vector<Motion> moves, moves_since;    // in this step, and since the one before
  std::vector<Vec3> measured;    // positions at the start of the step that was measured last

  void assign(const Triangles &, int n_vertices);
  void find_foreign(const Triangles &);
  void choose_anchors(const std::vector<Vec3> &positions);
  Pose pose_of(int p, const std::vector<Vec3> &positions) const;
  Motion motion_of(int p, const std::vector<Vec3> &from, const std::vector<Vec3> &to) const;
  template <class Visit> void for_vertices(int p, Visit visit) const;
};

}    // namespace sphcloth

#endif
