// SPDX-License-Identifier: GPL-2.0-or-later
// Behind the solver: the guarantee that no part of a cloth passes another in a step.  Most pairs
// are apart by more than they can approach, or stay on both sides of a plane.  Others are followed
// through the step; those that would meet are pushed apart, pass after pass, and lose their
// approach; what is still caught then moves as a rigid zone.

#ifndef SPHCLOTH_CONTACT_CLOTH_GUARANTEE_H
#define SPHCLOTH_CONTACT_CLOTH_GUARANTEE_H

#include "contact/cloth_candidates.h"
#include "contact/contact_row.h"

#include <algorithm>
#include <array>
#include <vector>

namespace LAMMPS_NS {

class ClothGuarantee : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  ClothGuarantee(LAMMPS *lmp_, MovingTriangles &mesh_, const MeshEdges &edges_,
                 ClothCandidates &candidates_) :
      Pointers(lmp_), mesh(mesh_), edges(edges_), candidates(candidates_), ghosts(lmp, mesh.label)
  {
  }

  // after each list build, collective
  void rebuild();

  // Of the motion from the last step's positions to the present ones.  Collective; was there any?
  bool resolve_collisions();

  // how far ghosts must reach for edges of such lengths: over that of the cloth, the gap, and what
  // borders on the other one
  static double reach(double longest_of_cloth, double longest_of_obstacles, double thickness)
  {
    return longest_of_cloth + thickness + std::max(longest_of_cloth, longest_of_obstacles);
  }

  double memory_usage() const
  {
    return masses.bytes() + sphcloth::bytes_of(rows, velocity, vertices_then);
  }

 private:
  MovingTriangles &mesh;
  const MeshEdges &edges;
  ClothCandidates &candidates;
  GhostReach ghosts;
  SplitMasses masses;
  std::vector<ContactRow> rows;    // of this pass
  std::vector<ContactRow> pushed;    // of all passes
  std::vector<Vec3> velocity, vertices_then;    // of owned vertices, at the list build
  std::array<double, 2> longest{};    // edge of cloth, and of obstacles

  void find_collisions();
  double missing(const ContactRow &) const;
  void push_apart();
  void solve_velocities();
  void freeze_zones();
  double max_displacement() const;
  void check_reach(double displacement) const;
};

}    // namespace LAMMPS_NS

#endif
