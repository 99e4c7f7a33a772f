// SPDX-License-Identifier: GPL-2.0-or-later
// Contact with one mesh, or with several that are joined to one: with particles, and of cloth with
// itself, other cloth and obstacles.  Phases of a step: candidates (broad phase), rows (between the
// sweeps over the constraints of a cloth), and behind the solver gaps of particles and a guarantee.

#ifndef SPHCLOTH_CONTACT_MESH_CONTACT_H
#define SPHCLOTH_CONTACT_MESH_CONTACT_H

#include "contact/candidate_pairs.h"
#include "contact/cloth_candidates.h"
#include "contact/contact_guarantee.h"
#include "contact/contact_rows.h"
#include "contact/mesh_edges.h"
#include "contact/moving_triangles.h"
#include "contact/particle_gaps.h"

namespace LAMMPS_NS {

class MeshContact : protected Pointers {
 public:
  // meets_cloth: cloth meets cloth or obstacles; obstacle_bits: groups of its vertices that are of
  // obstacles
  MeshContact(LAMMPS *, MovingTriangles &, bool meets_cloth, int obstacle_bits,
              const MeetingRules &);
  MeshContact(const MeshContact &) = delete;    // phases refer to one another
  MeshContact &operator=(const MeshContact &) = delete;

  ContactRows &rows() { return contact_rows; }
  const MeshEdges &edges() const { return mesh_edges; }

  void rebuild();    // after each list build, behind the triangles
  // Before the first list build of a run, collective: moves vertices until no edge passes through a
  // triangle, and then atoms to their ranks.
  void untangle();
  // At the start of a run, behind the list build, collective.  Errors: a thickness above the height
  // of a triangle; edges that pass through triangles.
  void check_start(bool untangled);

  // Behind the solver.  Collective; was there anything to resolve?
  bool resolve();

  // act(particle), some repeated: of triangles whose vertices have moved by more in this step
  template <class Act> void for_particles_at_moving_triangles(double displacement, Act act) const
  {
    if (of_particles.none()) return;
    of_particles.for_near(of_particles.max_reach(), [&](int particle, int triangle, const auto &) {
      for (const int s : triangles.triangles[triangle])
        if ((triangles.end[s] - triangles.start[s]).norm() > displacement) return act(particle);
    });
  }

  double memory_usage() const;

 private:
  MovingTriangles &triangles;
  const MeetingRules rules;
  MeshEdges mesh_edges;
  CandidatePairs of_particles;
  ClothCandidates of_cloth;
  ContactRows contact_rows;
  ParticleGaps gaps;
  ContactGuarantee guarantee;

  void move_to_owners() const;
  void check_heights() const;
  void warn_of_too_near();
};

}    // namespace LAMMPS_NS

#endif
