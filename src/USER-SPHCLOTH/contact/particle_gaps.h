// SPDX-License-Identifier: GPL-2.0-or-later
// Particles behind the solver of a cloth: one that has passed a triangle, or is nearer than the
// solver should have left it, is put back, the triangle stays, and both lose the approach.

#ifndef SPHCLOTH_CONTACT_PARTICLE_GAPS_H
#define SPHCLOTH_CONTACT_PARTICLE_GAPS_H

#include "contact/candidate_pairs.h"
#include "contact/known_region.h"
#include "contact/velocity_rows.h"

#include <vector>

namespace LAMMPS_NS {

class ParticleGaps : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  ParticleGaps(LAMMPS *lmp_, MovingTriangles &mesh_, CandidatePairs &candidates_,
               const MeetingRules &rules) :
      Pointers(lmp_), mesh(mesh_), candidates(candidates_), velocities(lmp, mesh, rules),
      region(lmp, mesh)
  {
  }

  // after each list build
  void rebuild()
  {
    if (!candidates.none()) region.rebuild();
  }

  // Of the motion from the last step's positions to the present ones.  Collective; was there any?
  bool keep();

  // of particles that are nearer than the thickness now.  Collective.
  void warn_of_too_near();

  double memory_usage() const { return velocities.bytes() + sphcloth::bytes_of(near); }

 private:
  struct Near {
    int triangle;
    double distance;    // at the start of the step
  };
  struct Gap {    // what a particle lacks, and where
    int triangle = -1;
    bool hit = false;    // not only too near since before the step
    Vec3 weight = Vec3::Zero(), normal = Vec3::Zero();
    double depth = 0.0;
    double too_near = 0.0, max_approach = 0.0;    // see VelocityRows
  };

  MovingTriangles &mesh;
  CandidatePairs &candidates;
  VelocityRows velocities;
  KnownRegion region;
  std::vector<Near> near;    // of one particle

  // calls visit(particle) with its triangles in `near`
  template <class Visit> void for_particles(Visit visit);
  bool put_back(int particle);
  double approach_left(int particle, const Gap &) const;
  Gap deepest(const sphcloth::Sweep &, bool first) const;
  Gap gap_over(const sphcloth::Sweep &, const Near &) const;
  bool recover(Gap &, const Vec3 &p, int triangle) const;
  bool is_deeper(const Gap &, const Gap &than) const;
};

}    // namespace LAMMPS_NS

#endif
