// SPDX-License-Identifier: GPL-2.0-or-later
// Do sheets lie in layers?  For the whole of them, before there are ghosts.

#ifndef SPHCLOTH_CONTACT_FIND_LAYERS_H
#define SPHCLOTH_CONTACT_FIND_LAYERS_H

#include "cloth/cloth_topology.h"

#include <vector>

namespace LAMMPS_NS {

// Collective: is any triangle nearer than this to another layer, of the same sheet or of another?
// Layers that face one another across a periodic face are not found.
bool have_layers(LAMMPS *, const std::vector<const ClothTopology *> &, double distance);

}    // namespace LAMMPS_NS

#endif
