// SPDX-License-Identifier: GPL-2.0-or-later
// Removes what is left of an approach behind the solver.

#include "contact/velocity_rows.h"

#include "atom.h"
#include "core/contact/contact_impulse.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

void VelocityRows::solve()
{
  load_velocities();
  masses.begin(velocity.size());
  for (const Pushed &pushed : rows) masses.count(pushed.row);
  masses.share(mesh.halo);
  masses.clear_impulses();
  for (const Pushed &pushed : rows) push(pushed);
  mesh.halo.reverse_add(0, masses.impulse.data());
  for (int s = 0; s < static_cast<int>(velocity.size()); s++) {
    const Vec3 &impulse = masses.impulse[s];
    if (impulse.isZero(0.0) || !mesh.is_owned(s)) continue;
    const int i = mesh.atom_of(s);
    for (int d = 0; d < 3; d++) atom->v[i][d] += mesh.w[s] * impulse[d];
    if (mesh.w[s] == 0.0) mesh.push_held(i, impulse);
  }
}

void VelocityRows::load_velocities()
{
  velocity.resize(mesh.start.size());
  for (int s = 0; s < static_cast<int>(velocity.size()); s++) {
    const double *v = atom->v[mesh.atom_of(s)];
    velocity[s] = Vec3(v[0], v[1], v[2]);
  }
  mesh.halo.forward_velocities(0, velocity.data());
}

void VelocityRows::push(const Pushed &pushed)
{
  const ContactRules &of_row = rules.of(pushed.row.meeting);
  const Vec3 relative = pushed.row.relative(velocity), &normal = pushed.row.normal;
  const double speed = relative.dot(normal), restitution = of_row.restitution;
  if (speed >= 0.0) return;
  const double removed = restitution > 0.0 ? -speed : std::min(-speed, pushed.max_approach),
               mass = masses.of(pushed.row, mesh.w), step = (1.0 + restitution) * removed * mass;
  const Vec3 sliding = mass * (relative - speed * normal);
  masses.apply(pushed.row, step * normal - clamp_length(sliding, of_row.friction * step));
}
