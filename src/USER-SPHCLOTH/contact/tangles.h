// SPDX-License-Identifier: GPL-2.0-or-later
// Cloth that passes through cloth before a run begins.

#ifndef SPHCLOTH_CONTACT_TANGLES_H
#define SPHCLOTH_CONTACT_TANGLES_H

#include "contact/mesh_edges.h"
#include "contact/moving_triangles.h"

namespace LAMMPS_NS {

// Collective: it is an error if edges pass through triangles, where they are at the start of the
// step: cloth through obstacles and, if it meets cloth, through cloth.  The message names some of
// them, and the places.
void check_tangles(LAMMPS *, const MovingTriangles &, const MeshEdges &, bool cloth_meets_cloth);

}    // namespace LAMMPS_NS

#endif
