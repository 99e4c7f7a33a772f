// SPDX-License-Identifier: GPL-2.0-or-later
// Projects contacts after each sweep: the constraint of no penetration in lines 24 to 28 of
// Algorithm 1.

#include "contact/solver_contact.h"

#include "atom.h"
#include "core/contact/contact_impulse.h"
#include "core/util/bytes.h"
#include "force.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

// of the thickness: by which vertices are expected to move in a step.  Without their constraints
// they may go anywhere.
static constexpr double MAX_STRIDE = 0.25;

void SolverContact::rebuild() { received.assign(mesh.halo.n_owned(), Vec3::Zero()); }

bool SolverContact::begin_step(const Vertex *step_start, const Vertex *step_end, double dt)
{
  if (!mesh.groupbits) return false;
  const WallTimer clock(mesh.counts.seconds);
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    mesh.start[s] = Vec3(step_start[s].x, step_start[s].y, step_start[s].z);
    mesh.end[s] = Vec3(step_end[s].x, step_end[s].y, step_end[s].z);
  }
  remaining = dt;
  mesh.halo.forward_positions(0, mesh.start.data(), remaining);
  mesh.halo.forward_positions(0, mesh.end.data());
  candidates.update(MAX_STRIDE * mesh.rules.thickness);
  find_pairs();
  int mine = !contacts.pairs.empty(), any = 0;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (!any) return false;
  contacts.share_evenly();

  for (ContactParticle &p : contacts.particles)
    p.velocity = p.velocity_before = (p.end - p.start) / dt;
  for (ContactParticle &p : contacts.particles) p.end = p.start;
  mesh.end = mesh.start;
  vertex_path = 0.0;
  std::fill(received.begin(), received.end(), Vec3::Zero());
  return true;
}

// with room for what the constraints of the cloth add to the motion

void SolverContact::find_pairs()
{
  contacts.clear();
  candidates.for_near(candidates.max_reach(),
                      [this](int i, int t, const Sweep &sweep, const ContactStart &start) {
                        ContactPair &pair = contacts.add(i, t, ContactResult());
                        pair.start = start;
                        pair.awake_from = start.distance - start.gap(mesh.rules.thickness);
                        ContactParticle &p = contacts.particle_of(pair);
                        p.start = sweep.start;
                        p.end = sweep.end;
                      });
}

void SolverContact::begin_substep(const Vertex *vertices, const Vertex *v, double dt)
{
  const WallTimer clock(mesh.counts.seconds);
  substep_dt = dt;
  substep_start = vertices;
  const double before = remaining;
  remaining -= dt;
  for (ContactParticle &p : contacts.particles) {
    p.from = p.end;
    p.displacement = dt * p.velocity;
    p.end = p.from + p.displacement;
    p.path += p.displacement.norm();
    p.touched = false;
  }
  for (int k : contacts.active) {
    ContactPair &pair = contacts.pairs[k];
    pair.in_contact = false;
    pair.normal_correction = 0.0;
    pair.friction_correction.setZero();
  }
  contacts.active.clear();
  if (mesh.rules.restitution > 0.0) load_velocities(v);
  if (mesh.rules.friction == 0.0) return;
  from.resize(mesh.halo.n_slots());
  for (int s = 0; s < mesh.halo.n_owned(); s++)
    from[s] = Vec3(vertices[s].x, vertices[s].y, vertices[s].z);
  mesh.halo.forward_positions(0, from.data(), before);
}

void SolverContact::project(Vertex *displacement)
{
  const WallTimer clock(mesh.counts.seconds);
  move_vertices(displacement);
  contacts.clear_impulses();
  for (int k = 0; k < static_cast<int>(contacts.pairs.size()); k++) {
    ContactPair &pair = contacts.pairs[k];
    if (sleeps(pair)) continue;
    project_normal(k);
    if (mesh.rules.friction > 0.0 && pair.in_contact) project_friction(pair);
  }
  move_particles();
  mesh.halo.reverse_add(0, contacts.impulse.data());
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    const Vec3 &impulse = contacts.impulse[s];
    displacement[s].x += mesh.w_solver[s] * impulse[0];
    displacement[s].y += mesh.w_solver[s] * impulse[1];
    displacement[s].z += mesh.w_solver[s] * impulse[2];
    received[s] += impulse / substep_dt;
  }
}

void SolverContact::move_vertices(const Vertex *displacement)
{
  end_before = mesh.end;
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    const Vertex &start = substep_start[s];
    mesh.end[s] =
        Vec3(start.x + displacement[s].x, start.y + displacement[s].y, start.z + displacement[s].z);
  }
  mesh.halo.forward_positions(0, mesh.end.data(), remaining);
  double max_sq = 0.0;
  for (std::size_t s = 0; s < end_before.size(); s++)
    max_sq = std::max(max_sq, (mesh.end[s] - end_before[s]).squaredNorm());
  vertex_path += std::sqrt(max_sq);
}

void SolverContact::move_particles()
{
  for (ContactParticle &p : contacts.particles) {
    if (!p.touched) continue;
    const Vec3 by = p.w * p.impulse;
    p.displacement += by;
    p.end = p.from + p.displacement;
    p.path += by.norm();
  }
}

// Distances change by no more than what both sides move.

bool SolverContact::sleeps(const ContactPair &pair) const
{
  return pair.awake_from > vertex_path + contacts.particle_of(pair).path;
}

// Closes what is missing of the gap.  What was corrected too far before is taken back, but a pair
// never pulls, and what was corrected where another triangle has become the nearest is taken back
// whole.  All of this is continuous in the positions: whether a gap that is just closed
// counts as a hit is round-off, and makes no difference.

void SolverContact::project_normal(int k)
{
  ContactPair &pair = contacts.pairs[k];
  const ContactParticle &p = contacts.particle_of(pair);
  const std::array<int, 3> &slots = mesh.triangles[pair.triangle];
  const ContactResult contact = mesh.contact_since(pair.start, {p.start, p.end}, pair.triangle);
  double missing = contact.depth;
  if (contact.hit) {
    pair.weight = contact.weight;
    pair.normal = contact.normal;
    if (!pair.in_contact && mesh.rules.restitution > 0.0)
      pair.speed_before = contacts.relative_velocity(pair).dot(pair.normal);
    if (!pair.in_contact) contacts.active.push_back(k);
    pair.in_contact = true;
    pair.gap = contact.gap;
    mesh.counts.contacts++;
    mesh.counts.deepest = std::max(mesh.counts.deepest, contact.depth);
  } else if (pair.normal_correction > 0.0) {
    const PointAndTriangle now{p.end, mesh.end[slots[0]], mesh.end[slots[1]], mesh.end[slots[2]]};
    const Nearness near = nearness(now, pair.start.side);
    missing = pair.gap - near.distance;
    if (mesh.is_nearer_to_another(pair.triangle, near.weight, near.distance * near.direction))
      missing = -std::numeric_limits<double>::max();
    else {
      pair.weight = near.weight;
      if (near.distance > 0.0) pair.normal = near.direction;
    }
  } else {
    pair.awake_from = vertex_path + p.path + contact.clearance;
    return;
  }
  const double step =
      std::max(missing * contacts.split_mass(pair, mesh.w_solver), -pair.normal_correction);
  pair.normal_correction += step;
  contacts.apply_impulse(pair, step * pair.normal);
}

// Coulomb friction against the sliding of this substep

void SolverContact::project_friction(ContactPair &pair)
{
  const ContactParticle &p = contacts.particle_of(pair);
  Vec3 slip = p.end - p.from;
  for (int q = 0; q < 3; q++) {
    const int s = mesh.triangles[pair.triangle][q];
    slip -= pair.weight[q] * (mesh.end[s] - from[s]);
  }
  slip -= slip.dot(pair.normal) * pair.normal;
  const Vec3 target =
      clamp_length(pair.friction_correction - contacts.split_mass(pair, mesh.w_solver) * slip,
                   mesh.rules.friction * pair.normal_correction);
  contacts.apply_impulse(pair, target - pair.friction_correction);
  pair.friction_correction = target;
}

void SolverContact::end_substep(Vertex *v, double dt)
{
  const WallTimer clock(mesh.counts.seconds);
  for (ContactParticle &p : contacts.particles)
    if (p.touched) p.velocity = p.displacement / dt;
  contacts.share_by_load();
  load_velocities(v);
  contacts.clear_impulses();
  for (int k : contacts.active)
    if (contacts.pairs[k].normal_correction > 0.0) solve_velocity(contacts.pairs[k], dt);
  for (ContactParticle &p : contacts.particles) p.velocity += p.w * p.impulse;
  mesh.halo.reverse_add(0, contacts.impulse.data());
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    const Vec3 &impulse = contacts.impulse[s];
    v[s].x += mesh.w_solver[s] * impulse[0];
    v[s].y += mesh.w_solver[s] * impulse[1];
    v[s].z += mesh.w_solver[s] * impulse[2];
    received[s] += impulse;
  }
}

void SolverContact::solve_velocity(const ContactPair &pair, double dt)
{
  const ContactMotion motion{contacts.relative_velocity(pair), pair.normal, pair.speed_before,
                             contacts.loaded_mass(pair)};
  const ExchangedImpulse so_far{pair.normal_correction / dt, pair.friction_correction / dt};
  contacts.apply_impulse(
      pair, contact_impulse(motion, so_far, mesh.rules.restitution, mesh.rules.friction));
}

void SolverContact::load_velocities(const Vertex *v)
{
  contacts.velocity.resize(mesh.halo.n_slots());
  for (int s = 0; s < mesh.halo.n_owned(); s++) contacts.velocity[s] = Vec3(v[s].x, v[s].y, v[s].z);
  mesh.halo.forward_velocities(0, contacts.velocity.data());
}

void SolverContact::end_step()
{
  const WallTimer clock(mesh.counts.seconds);
  for (const ContactParticle &p : contacts.particles) {
    if (p.velocity != p.velocity_before) mesh.moved.push_back(p.atom);
    for (int d = 0; d < 3; d++) {
      atom->v[p.atom][d] += p.velocity[d] - p.velocity_before[d];
      atom->x[p.atom][d] = p.end[d];
    }
  }
  for (int s = 0; s < mesh.halo.n_owned(); s++)
    if (mesh.w[s] == 0.0)
      for (int d = 0; d < 3; d++) mesh.counts.impulse[d] += received[s][d] / force->ftm2v;
}

double SolverContact::memory_usage() const
{
  return contacts.memory_usage() + bytes_of(from, end_before, received);
}
