// SPDX-License-Identifier: GPL-2.0-or-later
// Cloth that passes through cloth before a run begins.

#ifndef SPHCLOTH_CONTACT_TANGLES_H
#define SPHCLOTH_CONTACT_TANGLES_H

#include "contact/mesh_edges.h"
#include "contact/moving_triangles.h"
#include "core/contact/edge_through_triangle.h"
#include "core/geometry/box_grid.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Calls visit(edge, triangle) for each edge of this rank that passes through a triangle, where they
// are at the start of the step: cloth through obstacles and, if it meets cloth, through cloth.
template <class Visit>
void for_each_tangle(const MovingTriangles &mesh, const MeshEdges &edges, bool cloth_meets_cloth,
                     Visit visit)
{
  const std::vector<Eigen::Vector3d> &x = mesh.start;
  std::vector<sphcloth::Box> boxes(mesh.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); t++)
    for (const int s : mesh.triangles[t]) boxes[t].extend(x[s]);
  sphcloth::BoxGrid grid;
  grid.build(boxes);
  for (std::size_t e = 0; e < edges.edges.size(); e++) {
    if (mesh.halo.is_ghost(edges.vertex_of_lowest(static_cast<int>(e)))) continue;
    const auto &edge = edges.edges[e];
    const int p = edge[0], q = edge[1];
    sphcloth::Box box(x[p]);
    box.extend(x[q]);
    grid.query(box, [&](int t) {
      const auto &[a, b, c] = mesh.triangles[t];
      if (edges.is_obstacle(p) ? edges.is_obstacle(a) : !edges.is_obstacle(a) && !cloth_meets_cloth)
        return;
      if (p == a || p == b || p == c || q == a || q == b || q == c) return;
      if (sphcloth::passes_through(x[p], x[q], x[a], x[b], x[c])) visit(static_cast<int>(e), t);
    });
  }
}

// Collective: it is an error if edges pass through triangles.  The message names some of them, and
// the places, and ends with the remedy.
void check_tangles(LAMMPS *, const MovingTriangles &, const MeshEdges &, bool cloth_meets_cloth,
                   const std::string &remedy);

}    // namespace LAMMPS_NS

#endif
