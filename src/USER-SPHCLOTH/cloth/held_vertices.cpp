// SPDX-License-Identifier: GPL-2.0-or-later
// Velocities of pins.

#include "cloth/held_vertices.h"

#include "cloth/vertex_halo.h"
#include "modify.h"

#include <algorithm>

using namespace LAMMPS_NS;

void HeldVertices::stop_pins()
{
  if (options.pin_motion) return;
  int moved_by_others = 0;
  // null: one of this ID that the present one replaces
  for (const Fix *other : modify->get_fix_list())
    if (other && other != cloth && other->time_integrate) moved_by_others |= other->groupbit;
  for (int i = 0; i < atom->nlocal; i++)
    if (is_vertex(i) && is_pinned(i) && !(atom->mask[i] & moved_by_others))
      std::fill(atom->v[i], atom->v[i] + 3, 0.0);
}

void HeldVertices::move_pins(const VertexHalo &halo)
{
  if (!options.pin_motion) return;
  options.pin_motion.evaluate(options.pin_group);
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    if (!is_pinned(i)) continue;
    for (int d = 0; d < 3; d++) {
      atom->v[i][d] = options.pin_motion.velocity(i, d);
      atom->x[i][d] += update->dt * atom->v[i][d];
    }
  }
}
