// SPDX-License-Identifier: GPL-2.0-or-later
// Contact of particles with one mesh: its triangles, and the phases of a step.
// Phases: candidates (broad phase), solver (between the sweeps over the constraints of a cloth),
// stabilization (behind the solver), and, at list builds, sides.

#ifndef SPHCLOTH_CONTACT_CONTACT_SURFACE_H
#define SPHCLOTH_CONTACT_CONTACT_SURFACE_H

#include "contact/candidate_pairs.h"
#include "contact/moving_triangles.h"
#include "contact/post_stabilization.h"
#include "contact/sheet_sides.h"
#include "contact/solver_contact.h"

#include <string>

namespace LAMMPS_NS {

struct ContactSurface {
  // see MovingTriangles
  ContactSurface(LAMMPS *lmp, ContactMesh *mesh, const std::string &label, int groupbits,
                 const ContactRules &rules, ContactCounts &counts,
                 const ParticleColumns &last_positions) :
      triangles(lmp, mesh, label, groupbits, rules, counts, last_positions),
      candidates(lmp, triangles), solver(lmp, triangles, candidates),
      stabilization(lmp, triangles, candidates), sides(lmp, triangles)
  {
  }
  ContactSurface(const ContactSurface &) = delete;    // phases refer to one another
  ContactSurface &operator=(const ContactSurface &) = delete;

  MovingTriangles triangles;
  CandidatePairs candidates;
  SolverContact solver;
  PostStabilization stabilization;
  SheetSides sides;

  // after each list build; whole triangles are seen as far as this
  void rebuild(double max_distance)
  {
    triangles.rebuild(max_distance);
    candidates.clear();
    solver.rebuild();
    stabilization.rebuild();
  }

  double memory_usage() const
  {
    return triangles.memory_usage() + candidates.memory_usage() + solver.memory_usage() +
        stabilization.memory_usage() + sides.memory_usage();
  }
};

}    // namespace LAMMPS_NS

#endif
