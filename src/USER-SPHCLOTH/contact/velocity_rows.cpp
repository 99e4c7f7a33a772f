// SPDX-License-Identifier: GPL-2.0-or-later
// Removes what is left of an approach behind the solver.

#include "contact/velocity_rows.h"

#include "atom.h"
#include "core/contact/contact_impulse.h"
#include "update.h"

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
  for (Pushed &pushed : rows) push(pushed);
  for (const Pushed &pushed : rows) take_back(pushed);
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

void VelocityRows::push(Pushed &pushed)
{
  const ContactRules &of_row = rules.of(pushed.row.meeting);
  const Vec3 relative = pushed.row.relative(velocity), &normal = pushed.row.normal;
  const double speed = relative.dot(normal), restitution = of_row.restitution;
  if (speed >= 0.0) return;
  const double removed = restitution > 0.0 ? -speed : std::min(-speed, pushed.max_approach),
               mass = masses.of(pushed.row, mesh.w), step = (1.0 + restitution) * removed * mass;
  const Vec3 sliding = mass * (relative - speed * normal);
  masses.apply(pushed.row, step * normal - clamp_length(sliding, of_row.friction * step));
  if (of_row.friction > 0.0 && pushed.too_near > 0.0)
    pushed.taken_back = slid_too_far(pushed, mass, -speed, of_row.friction * step);
}

// The velocity that friction removes was missing since the contact began.  It takes back no more
// than the sliding of this step, so that nothing gains energy.

VelocityRows::Vec3 VelocityRows::slid_too_far(const Pushed &pushed, double mass, double approach,
                                              double max_friction) const
{
  const ContactRow &row = pushed.row;
  const double dt = update->dt, duration = std::min(pushed.too_near / approach, dt);
  const Vec3 way = row.relative(mesh.end) - row.relative(mesh.start),
             slid = way - way.dot(row.normal) * row.normal;
  return mesh.w[row.slots[0]] * duration * clamp_length(mass / dt * slid, max_friction);
}

void VelocityRows::take_back(const Pushed &pushed)
{
  if (pushed.taken_back.isZero(0.0)) return;
  const int s = pushed.row.slots[0];
  mesh.end[s] -= pushed.taken_back;
  double *x = atom->x[mesh.atom_of(s)];
  for (int d = 0; d < 3; d++) x[d] -= pushed.taken_back[d];
  mesh.step_start.atoms_moved();
}
