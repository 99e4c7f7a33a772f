// SPDX-License-Identifier: GPL-2.0-or-later
// Contact behind the solver of a cloth: the guarantee that no particle passes a triangle.
// What still crosses, or is too near, is put back pass after pass, and loses its approach; what is
// caught between moving triangles moves with them as a rigid zone.

#ifndef SPHCLOTH_CONTACT_POST_STABILIZATION_H
#define SPHCLOTH_CONTACT_POST_STABILIZATION_H

#include "contact/candidate_pairs.h"
#include "contact/contact_pairs.h"
#include "contact/known_region.h"

namespace LAMMPS_NS {

class PostStabilization : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  PostStabilization(LAMMPS *lmp_, MovingTriangles &mesh_, CandidatePairs &candidates_) :
      Pointers(lmp_), mesh(mesh_), candidates(candidates_), contacts(lmp, mesh), region(lmp, mesh)
  {
  }

  // after each list build
  void rebuild() { region.rebuild(); }

  // Of the sweeps from the last step's positions to the present ones.  Collective; was there any?
  bool resolve_penetrations();

  // of particles that are nearer than the thickness now.  Collective.
  void warn_of_too_near();

  double memory_usage() const { return contacts.memory_usage(); }

 private:
  MovingTriangles &mesh;
  CandidatePairs &candidates;
  ContactPairs contacts;
  KnownRegion region;

  template <class Visit> void for_near(Visit visit) const
  {
    candidates.for_near(mesh.rules.thickness,
                        [&visit](int i, int t, const sphcloth::Sweep &sweep,
                                 const sphcloth::ContactStart &) { visit(i, t, sweep); });
  }
  bool resolve_deepest(bool first);
  bool recover_gap(sphcloth::ContactResult &, const Vec3 &p, int t) const;
  void solve_velocities();
  void load_velocities();
  void apply_velocity_changes();
  void freeze_zones();
};

}    // namespace LAMMPS_NS

#endif
