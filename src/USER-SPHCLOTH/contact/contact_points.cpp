// SPDX-License-Identifier: GPL-2.0-or-later
// Moves near particles from substep to substep.

#include "contact/contact_points.h"

using namespace LAMMPS_NS;

void ContactPoints::begin_step(double dt)
{
  points.clear();
  for (std::size_t s = mesh.halo.n_slots(); s < mesh.start.size(); s++) {
    Point point;
    point.velocity = point.velocity_before = (mesh.end[s] - mesh.start[s]) / dt;
    point.ahead = mesh.end[s];
    point.from = point.measured = mesh.end[s] = mesh.start[s];
    points.push_back(point);
  }
}

void ContactPoints::begin_substep(double dt)
{
  for_all([&](Point &point, int slot) {
    point.from = mesh.end[slot];
    point.displacement = dt * point.velocity;
    mesh.end[slot] = point.from + point.displacement;
    point.touched = false;
  });
}

void ContactPoints::store_velocities(std::vector<Vec3> &velocity) const
{
  velocity.resize(mesh.halo.n_slots());
  for (const Point &point : points) velocity.push_back(point.velocity);
}

void ContactPoints::push(const std::vector<Vec3> &impulse)
{
  for_all([&](Point &point, int slot) {
    if (impulse[slot].isZero(0.0)) return;
    point.displacement += mesh.w_solver[slot] * impulse[slot];
    mesh.end[slot] = point.from + point.displacement;
    point.touched = point.moved = true;
  });
}

void ContactPoints::end_substep(double dt)
{
  for_all([dt](Point &point, int) {
    if (point.touched) point.velocity = point.displacement / dt;
  });
}

void ContactPoints::push_velocities(const std::vector<Vec3> &impulse)
{
  for_all([&](Point &point, int slot) { point.velocity += mesh.w_solver[slot] * impulse[slot]; });
}

// Pores may have moved a particle, too: then both add what they do.  One that was pushed and leaves
// with its velocity of before has moved: its position keeps the push.

void ContactPoints::end_step(Atom *atom)
{
  const bool adds = mesh.has_pores();
  for_all([&](const Point &point, int slot) {
    const int i = mesh.atom_of(slot);
    if (point.moved) mesh.step_start.moved.push_back(i);
    for (int d = 0; d < 3; d++) {
      atom->v[i][d] += point.velocity[d] - point.velocity_before[d];
      atom->x[i][d] = adds ? atom->x[i][d] + (mesh.end[slot][d] - point.ahead[d])
                           : mesh.end[slot][d];
    }
  });
}

void ContactPoints::measure_paths(const Vec3 &together)
{
  for_all([&](Point &point, int slot) {
    point.path += (mesh.end[slot] - point.measured - together).norm();
    point.measured = mesh.end[slot];
  });
}
