// SPDX-License-Identifier: GPL-2.0-or-later
// Velocities of contact rows at the end of a substep: restitution, and friction of what slides.

#include "contact/contact_rows.h"

#include "contact/pass_changes.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

void ContactRows::end_substep(Vertex *v, double dt)
{
  const WallTimer clock(mesh.counts.seconds);
  points.end_substep(dt);
  masses.share_loads(mesh.halo);
  exchanged.clear();
  PassChanges changes;
  for (int pass = 1;; pass++) {
    double largest = 0.0;
    load_velocities(v);
    masses.clear_impulses();
    std::size_t n = 0;
    for_ahead(active, [&](int k) {
      if (pass == 1) exchanged.push_back(exchanged_by(k));
      largest = std::max(largest, solve_velocity(k, exchanged[n++]));
    });
    push_velocities(v);
    points.push_velocities(masses.impulse);
    if (pass == passes_of_velocities || changes.are_small(largest, world)) break;
  }
  for_ahead(active, [this](int k) { release(k); });
}

// The change of the speed

double ContactRows::solve_velocity(int k, ExchangedImpulse &so_far)
{
  const ContactRow &row = rows[k];
  const ContactRules &of_row = rules_of(row);
  if (!(row.normal_correction > 0.0)) return 0.0;
  ContactMotion motion{row.relative(velocity), row.normal, 0.0, masses.by_load(row, mesh.w_solver)};
  if (of_row.restitution > 0.0) motion.speed_before = details[k].speed_before;
  const Vec3 impulse = contact_impulse(motion, so_far, of_row.restitution, of_row.friction);
  masses.apply(row, impulse);
  return motion.mass > 0.0 ? impulse.norm() / motion.mass : 0.0;
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
