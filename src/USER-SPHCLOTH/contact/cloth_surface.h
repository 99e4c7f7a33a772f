// SPDX-License-Identifier: GPL-2.0-or-later
// Contact of one mesh with itself: its triangles and edges, and the phases of a step.

#ifndef SPHCLOTH_CONTACT_CLOTH_SURFACE_H
#define SPHCLOTH_CONTACT_CLOTH_SURFACE_H

#include "contact/cloth_candidates.h"
#include "contact/cloth_guarantee.h"
#include "contact/cloth_rows.h"
#include "contact/mesh_edges.h"
#include "contact/moving_triangles.h"

#include <string>

namespace LAMMPS_NS {

struct ClothSurface {
  ClothSurface(LAMMPS *lmp, ContactMesh *mesh, const std::string &label, const ContactRules &rules,
               ContactCounts &counts, const ParticleColumns &last_positions) :
      triangles(lmp, mesh, label, 0, rules, counts, last_positions),
      edges(lmp, triangles), candidates(lmp, triangles, edges),
      rows(lmp, triangles, edges, candidates), guarantee(lmp, triangles, candidates)
  {
  }
  ClothSurface(const ClothSurface &) = delete;    // phases refer to one another
  ClothSurface &operator=(const ClothSurface &) = delete;

  MovingTriangles triangles;
  MeshEdges edges;
  ClothCandidates candidates;
  ClothRows rows;
  ClothGuarantee guarantee;

  // after each list build
  void rebuild()
  {
    const double thickness = triangles.rules.thickness;
    triangles.rebuild(thickness);
    edges.rebuild();
    candidates.clear();
    rows.rebuild();
    guarantee.rebuild();
  }

  double memory_usage() const
  {
    return triangles.memory_usage() + edges.memory_usage() + candidates.memory_usage() +
        rows.memory_usage() + guarantee.memory_usage();
  }
};

}    // namespace LAMMPS_NS

#endif
