// SPDX-License-Identifier: GPL-2.0-or-later
// Velocities of contact rows at the end of a substep: restitution, and friction of what slides.

#include "contact/contact_rows.h"

#include "core/contact/contact_impulse.h"

using namespace LAMMPS_NS;
using namespace sphcloth;

void ContactRows::end_substep(Vertex *v, double dt)
{
  const WallTimer clock(mesh.counts.seconds);
  points.end_substep(dt);
  masses.share_loads(mesh.halo);
  load_velocities(v);
  masses.clear_impulses();
  for_ahead(active, [&](int k) { solve_velocity(k, dt); });
  push_velocities(v);
  points.push_velocities(masses.impulse);
}

void ContactRows::solve_velocity(int k, double dt)
{
  ContactRow &row = rows[k];
  const ContactRules &of_row = rules_of(row);
  if (row.normal_correction > 0.0) {
    ContactMotion motion{row.relative(velocity), row.normal, 0.0,
                         masses.by_load(row, mesh.w_solver)};
    ExchangedImpulse so_far{row.normal_correction / dt};
    if (row.meeting == Meeting::PARTICLE) mesh.counts.passed_on += so_far.normal;
    if (of_row.restitution > 0.0) motion.speed_before = details[k].speed_before;
    if (of_row.friction > 0.0) so_far.friction = details[k].friction_correction / dt;
    masses.apply(row, contact_impulse(motion, so_far, of_row.restitution, of_row.friction));
  }
  row.active = false;
  row.normal_correction = 0.0;
  if (of_row.friction > 0.0) details[k].friction_correction.setZero();
}

void ContactRows::load_velocities(const Vertex *v)
{
  points.store_velocities(velocity);
  for (int s = 0; s < mesh.halo.n_owned(); s++) velocity[s] = Vec3(v[s].x, v[s].y, v[s].z);
  mesh.halo.forward_velocities(0, velocity.data());
}

void ContactRows::push_velocities(Vertex *v)
{
  mesh.halo.reverse_add(0, masses.impulse.data());
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    if (masses.impulse[s].isZero(0.0)) continue;
    add(v[s], mesh.w_solver[s] * masses.impulse[s]);
    received[s] += masses.impulse[s];
  }
}
