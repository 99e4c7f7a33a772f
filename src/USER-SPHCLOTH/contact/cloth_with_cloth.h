// SPDX-License-Identifier: GPL-2.0-or-later
// Contact of cloths with themselves, one another and obstacles: one mesh of all, and the phases of
// a step.

#ifndef SPHCLOTH_CONTACT_CLOTH_WITH_CLOTH_H
#define SPHCLOTH_CONTACT_CLOTH_WITH_CLOTH_H

#include "contact/cloth_candidates.h"
#include "contact/cloth_guarantee.h"
#include "contact/cloth_rows.h"
#include "contact/joined_cloths.h"
#include "contact/mesh_edges.h"
#include "contact/moving_triangles.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class ClothWithCloth : protected Pointers {
 public:
  struct Meshes {
    std::vector<ContactMesh *> cloths, obstacles;
    int cloth_bits, obstacle_bits;    // group bits of their vertices
  };

  // see MovingTriangles for the others
  ClothWithCloth(LAMMPS *, const Meshes &, const std::string &label, const ClothRules &,
                 ContactCounts &counts, const ParticleColumns &last_positions);
  ClothWithCloth(const ClothWithCloth &) = delete;    // phases refer to one another
  ClothWithCloth &operator=(const ClothWithCloth &) = delete;

  // what takes part in the solver of each cloth
  const std::vector<SolverCoupling *> &couplings() const { return parts; }

  void rebuild();    // after each list build
  // Before the first list build of a run, collective: moves vertices until no edge passes through a
  // triangle, and then atoms to their ranks.
  void untangle();
  // At the start of a run, behind the list build, collective.  Errors: a thickness above the height
  // of a triangle; edges that pass through triangles.
  void check_start(bool untangled);

  bool resolve_collisions() { return guarantee.resolve_collisions(); }

  double memory_usage() const;

 private:
  std::unique_ptr<JoinedCloths> joined;    // if it is more than one mesh
  MovingTriangles triangles;
  MeshEdges edges;
  ClothCandidates candidates;
  ClothRows rows;
  ClothGuarantee guarantee;
  std::unique_ptr<JoinedCoupling> coupling;    // the same
  std::vector<SolverCoupling *> parts;

  void move_to_owners() const;
  void check_heights() const;
  void warn_of_too_near() const;
};

}    // namespace LAMMPS_NS

#endif
