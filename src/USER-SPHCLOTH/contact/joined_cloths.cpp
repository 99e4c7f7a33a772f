// SPDX-License-Identifier: GPL-2.0-or-later
// Copies vertices of cloths to those of all of them, and back.

#include "contact/joined_cloths.h"

#include "core/util/bytes.h"

using namespace LAMMPS_NS;
using sphcloth::Vertex;

SolverCoupling *JoinedCoupling::add_part(const ContactMesh *cloth)
{
  parts.push_back(std::make_unique<Part>(*this, cloth, parts.empty()));
  return parts.back().get();
}

// Owned vertices of each are in the order of atoms.

void JoinedCoupling::rebuild()
{
  for (auto &part : parts) {
    part->slots.clear();
    for (int s = 0; s < mesh.halo.n_owned(); s++)
      if (part->cloth->has_vertex(mesh.halo.atom_of(s))) part->slots.push_back(s);
  }
  moved.clear();
  for (int s = 0; s < mesh.halo.n_owned(); s++)
    if (edges.is_obstacle(s)) moved.push_back(s);
  start.resize(mesh.halo.n_owned());
  other.resize(mesh.halo.n_owned());
}

// At the start of the step, where they end it as `other`.  Those that rest are not moved again.

void JoinedCoupling::start_obstacles()
{
  obstacles_rest = true;
  for (const int s : moved) {
    const sphcloth::Sweep sweep = mesh.sweep_of(mesh.halo.atom_of(s));
    obstacles_rest = obstacles_rest && sweep.end == sweep.start;
    start[s] = {sweep.start[0], sweep.start[1], sweep.start[2], 0.0};
    other[s] = {sweep.end[0], sweep.end[1], sweep.end[2], 0.0};
  }
}

// Vertices of obstacles: start after a share of the step, and `other` as a multiple of their
// displacement in the step

void JoinedCoupling::move_obstacles(double passed, double multiple)
{
  if (obstacles_rest) return;
  for (const int s : moved) {
    const sphcloth::Sweep sweep = mesh.sweep_of(mesh.halo.atom_of(s));
    const Eigen::Vector3d by = sweep.end - sweep.start, at = sweep.start + passed * by;
    start[s] = {at[0], at[1], at[2], 0.0};
    other[s] = {multiple * by[0], multiple * by[1], multiple * by[2], 0.0};
  }
}

void JoinedCoupling::scatter()
{
  for (auto &part : parts)
    for (std::size_t s = 0; s < part->slots.size(); s++) {
      const double w = part->target[s].w;
      part->target[s] = other[part->slots[s]];
      part->target[s].w = w;
    }
}

void JoinedCoupling::Part::gather(const Vertex *from, std::vector<Vertex> &to) const
{
  for (std::size_t s = 0; s < slots.size(); s++) to[slots[s]] = from[s];
}

bool JoinedCoupling::Part::begin_step(const Vertex *from, const Vertex *end, double dt)
{
  gather(from, whole.start);
  gather(end, whole.other);
  if (!is_last()) return true;
  whole.step_dt = dt;
  whole.elapsed = 0.0;
  whole.start_obstacles();
  whole.present = whole.all.begin_step(whole.start.data(), whole.other.data(), dt);
  for (const int s : whole.moved) whole.other[s] = {0.0, 0.0, 0.0, 0.0};
  return true;
}

void JoinedCoupling::Part::begin_substep(const Vertex *from, const Vertex *v, double dt)
{
  if (!whole.present) return;
  gather(from, whole.start);
  gather(v, whole.other);
  if (!is_last()) return;
  whole.move_obstacles(whole.elapsed / whole.step_dt, 1.0 / whole.step_dt);
  whole.elapsed += dt;
  whole.all.begin_substep(whole.start.data(), whole.other.data(), dt);
  whole.substep_dt = dt;
}

void JoinedCoupling::Part::project(Vertex *displacement)
{
  if (!whole.present) return;
  target = displacement;
  gather(displacement, whole.other);
  if (!is_last()) return;
  whole.move_obstacles((whole.elapsed - whole.substep_dt) / whole.step_dt,
                       whole.substep_dt / whole.step_dt);
  whole.all.project(whole.other.data());
  whole.scatter();
}

void JoinedCoupling::Part::end_substep(Vertex *v, double dt)
{
  if (!whole.present) return;
  target = v;
  gather(v, whole.other);
  if (!is_last()) return;
  whole.move_obstacles(whole.elapsed / whole.step_dt, 1.0 / whole.step_dt);
  whole.all.end_substep(whole.other.data(), dt);
  whole.scatter();
}

void JoinedCoupling::Part::end_step()
{
  if (whole.present && is_last()) whole.all.end_step();
}

Eigen::Vector3d JoinedCoupling::Part::impulse_on(int slot) const
{
  return whole.present ? whole.all.impulse_on(slots[slot]) : Eigen::Vector3d::Zero();
}

double JoinedCoupling::memory_usage() const { return sphcloth::bytes_of(start, other, moved); }
