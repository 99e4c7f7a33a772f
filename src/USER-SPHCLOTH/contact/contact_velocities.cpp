// SPDX-License-Identifier: GPL-2.0-or-later
// Velocities of contact rows at the end of a substep: restitution, and friction of what slides.

#include "contact/contact_rows.h"

using namespace LAMMPS_NS;
using namespace sphcloth;

void ContactRows::end_substep(Vertex *v, double dt)
{
  const WallTimer clock(mesh.counts.seconds);
  points.end_substep(dt);
  masses.share_loads(mesh.halo);
  load_velocities(v);
  masses.clear_impulses();
  for_ahead(active, [this](int k) {
    const ContactRow &row = rows[k];
    if (row.in_corner || !(row.normal_correction > 0.0)) return;
    ExchangedImpulse so_far = exchanged_by(k);
    masses.apply(row, velocity_impulse(k, row.relative(velocity), so_far));
  });
  for (const Corner &which : corners) solve_velocities(which);
  push_velocities(v);
  points.push_velocities(masses.impulse);
  for_ahead(active, [this](int k) { release(k); });
}

void ContactRows::load_velocities(const Vertex *v)
{
  points.store_velocities(velocity);
  for (int s = 0; s < mesh.halo.n_owned(); s++) velocity[s] = vector_of(v[s]) + mesh.drift_of(s);
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
