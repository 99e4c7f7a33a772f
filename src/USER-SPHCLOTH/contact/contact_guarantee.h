// SPDX-License-Identifier: GPL-2.0-or-later
// Behind the solver: the guarantee that no particle and no part of a cloth passes cloth or an
// obstacle in a step.  Most pairs are apart by more than they can approach, or stay on both sides
// of a plane.  Others are followed through the step; those that would meet are pushed apart, pass
// after pass, and lose their approach; what is still caught then moves as a rigid zone.

#ifndef SPHCLOTH_CONTACT_CONTACT_GUARANTEE_H
#define SPHCLOTH_CONTACT_CONTACT_GUARANTEE_H

#include "contact/candidate_pairs.h"
#include "contact/cloth_candidates.h"
#include "contact/velocity_rows.h"

#include <algorithm>
#include <array>
#include <vector>

namespace LAMMPS_NS {

class ContactGuarantee : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  ContactGuarantee(LAMMPS *lmp_, MovingTriangles &mesh_, const MeshEdges &edges_,
                   CandidatePairs &of_particles_, ClothCandidates &of_cloth_,
                   const MeetingRules &rules_) :
      Pointers(lmp_), mesh(mesh_), edges(edges_), of_particles(of_particles_), of_cloth(of_cloth_),
      rules(rules_), ghosts(lmp, mesh.label), velocities(lmp, mesh, rules_)
  {
  }

  // after each list build, collective
  void rebuild();

  // Behind the gaps of particles: of the motion from the last step's positions to the present ones.
  // Collective; was there any?
  bool resolve_collisions();

  // how far ghosts must reach for edges of such lengths: over that of the cloth, the gap, and what
  // borders on the other one
  static double reach(double longest_of_cloth, double longest_of_obstacles, double thickness)
  {
    return longest_of_cloth + thickness + std::max(longest_of_cloth, longest_of_obstacles);
  }

  double memory_usage() const
  {
    return masses.bytes() + velocities.bytes() + sphcloth::bytes_of(rows, vertices_then);
  }

 private:
  MovingTriangles &mesh;
  const MeshEdges &edges;
  CandidatePairs &of_particles;
  ClothCandidates &of_cloth;
  const MeetingRules rules;
  GhostReach ghosts;
  SplitMasses masses;
  std::vector<ContactRow> rows;    // of this pass
  VelocityRows velocities;    // of all passes
  std::vector<Vec3> vertices_then;    // owned ones, at the list build
  std::array<double, 2> longest{};    // edge of cloth, and of obstacles

  void find_collisions(bool triangles_moved);
  void find_collisions_of_particles();
  bool follow(const ContactPair &, const sphcloth::ClosestPoints &at_start);
  double missing(const ContactRow &) const;
  void push_apart();
  void freeze_zones();
  double max_displacement() const;
  void check_reach(double displacement) const;
};

}    // namespace LAMMPS_NS

#endif
