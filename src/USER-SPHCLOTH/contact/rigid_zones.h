// SPDX-License-Identifier: GPL-2.0-or-later
// The last resort of contact: what is caught moves as one.

#ifndef SPHCLOTH_CONTACT_RIGID_ZONES_H
#define SPHCLOTH_CONTACT_RIGID_ZONES_H

#include "contact/impact_zones.h"
#include "contact/moving_triangles.h"

namespace LAMMPS_NS {

// Collective.  A zone keeps the shape of the start of the step, where nothing was on a wrong side,
// and moves with its mean velocity: momentum is kept, energy lost.  Held vertices pull it along; it
// is an error if they move apart by more than the thickness.
void move_rigid_zones(LAMMPS *, MovingTriangles &, const ImpactZones &);

}    // namespace LAMMPS_NS

#endif
