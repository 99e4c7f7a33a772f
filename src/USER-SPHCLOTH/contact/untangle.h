// SPDX-License-Identifier: GPL-2.0-or-later
// Cloth that passes through cloth before a run begins, pulled apart.

#ifndef SPHCLOTH_CONTACT_UNTANGLE_H
#define SPHCLOTH_CONTACT_UNTANGLE_H

#include "contact/mesh_edges.h"
#include "contact/moving_triangles.h"

namespace LAMMPS_NS {

constexpr int MAX_PASSES_OF_UNTANGLING = 400;

// Collective: moves free vertices, in passes that part edges and triangles by a step, until no edge
// passes through a triangle, and prints how far.  If no more passes are left, nothing has moved.
// Returns whether any vertex has: then ghosts are no longer where their owners are.
bool untangle(LAMMPS *, MovingTriangles &, const MeshEdges &, bool cloth_meets_cloth, double step);

}    // namespace LAMMPS_NS

#endif
