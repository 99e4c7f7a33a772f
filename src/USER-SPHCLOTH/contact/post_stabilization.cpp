// SPDX-License-Identifier: GPL-2.0-or-later
// Finds what still penetrates behind the solver, and puts it back.

#include "contact/post_stabilization.h"

#include "atom.h"
#include "comm.h"
#include "contact/rigid_zones.h"
#include "core/contact/contact_impulse.h"
#include "error.h"
#include "lammps_util/atom_tools.h"
#include "update.h"

#include <algorithm>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

// Of the gap: what may be missing behind the solver, and how much farther a particle is put back,
// so that the next pass finds it resolved.  The smaller it is, the less depends on whether
// a particle was put back.
static constexpr double SLACK = 1e-6, OVERSHOOT = 1e-10;

// of the thickness: what a particle that is too near may get back in one step
static constexpr double RECOVERY = 0.1;

// Of the speed with which a particle came too near behind the solver, so much is removed: the
// whole approach, unless it hardly came too near.
static constexpr double APPROACH_FACTOR = 10.0;

static constexpr int MAX_PASSES = 200;

bool PostStabilization::resolve_penetrations()
{
  if (!mesh.groupbits) return false;
  const WallTimer clock(mesh.counts.seconds);
  mesh.load_step();
  candidates.update();
  contacts.clear();
  int pass = 0;
  while (resolve_deepest(pass == 0))
    if (++pass == MAX_PASSES) break;
  if (pass > 0) solve_velocities();
  if (pass == MAX_PASSES) freeze_zones();
  for (const ContactParticle &p : contacts.particles) mesh.moved.push_back(p.atom);
  return pass > 0;
}

// Each particle is put back from the triangle in which it is deepest, the triangle stays.  One that
// was too near before the step gets a part of the way back, in the first pass.  After that one no
// sweep becomes longer, and the region in which triangles are known must cover them.

bool PostStabilization::resolve_deepest(bool first)
{
  double mine[2] = {0.0, first ? region.max_vertex_displacement() : 0.0}, all[2];
  int particle = -1, triangle = -1;
  ContactResult deepest;
  double max_approach = 0.0;    // of the deepest
  const auto put_back = [&] {
    if (triangle < 0) return;
    for (int d = 0; d < 3; d++) atom->x[particle][d] += deepest.depth * deepest.normal[d];
    if (!deepest.hit) return;
    mine[0] = 1.0;
    mesh.counts.stops++;
    contacts.add(particle, triangle, deepest).max_approach = max_approach;
  };
  for_near([&](int i, int t, const Sweep &sweep) {
    if (i != particle) {
      put_back();
      particle = i;
      triangle = -1;
      deepest = ContactResult();
    }
    ContactResult contact = mesh.contact(sweep, t, SLACK);
    const double into = contact.depth - SLACK * contact.gap;
    if (contact.through)
      contact.depth += SLACK * contact.gap;
    else {
      if (contact.hit) contact.depth = into + OVERSHOOT * contact.gap;
      if (first) recover_gap(contact, sweep.end, t);
    }
    if (!mesh.is_deeper(contact, t, deepest, triangle)) return;
    deepest = contact;
    max_approach = contact.through ? std::numeric_limits<double>::max()
                                   : APPROACH_FACTOR * into / update->dt;
    triangle = t;
  });
  put_back();
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_MAX, world);
  if (first) region.check(all[1]);
  return all[0] > 0.0;
}

// at least a part of the thickness, if something of it is missing; false if nothing is

bool PostStabilization::recover_gap(ContactResult &contact, const Vec3 &p, int t) const
{
  const auto &[a, b, c] = mesh.triangles[t];
  const double thickness = mesh.rules.thickness;
  Vec3 weight;
  const Vec3 vector = distance_vector(p, mesh.end[a], mesh.end[b], mesh.end[c], weight);
  const double distance = vector.norm();
  if (distance == 0.0 || distance >= thickness) return false;
  if (mesh.is_nearer_to_another(t, weight, vector)) return false;
  contact.weight = weight;
  contact.normal = vector / distance;
  contact.depth = std::max(contact.depth, std::min(thickness - distance, RECOVERY * thickness));
  return true;
}

void PostStabilization::warn_of_too_near()
{
  mesh.load_step();
  candidates.update();
  bigint mine = 0, all;
  tagint example = 0, one;
  int last = -1;
  for_near([&](int i, int t, const Sweep &sweep) {
    ContactResult contact;
    if (i == last || !recover_gap(contact, sweep.end, t)) return;
    last = i;
    mine++;
    example = std::max(example, atom->tag[i]);
  });
  MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  MPI_Allreduce(&example, &one, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  if (all > 0 && comm->me == 0)
    error->warning(FLERR,
                   "{}: {} particles start nearer to the triangles than the thickness {}, atom {} "
                   "for example: they get their gap by a tenth of it per step; place them farther "
                   "away, or lower the thickness",
                   mesh.label, all, mesh.rules.thickness, one);
}

// Both sides of what was put back lose the approach, see APPROACH_FACTOR.  What restitution gives
// back comes back at once.

void PostStabilization::solve_velocities()
{
  const double restitution = mesh.rules.restitution;
  contacts.share_evenly();
  load_velocities();
  contacts.clear_impulses();
  for (const ContactPair &pair : contacts.pairs) {
    const Vec3 velocity = contacts.relative_velocity(pair);
    const double speed = velocity.dot(pair.normal);
    if (speed >= 0.0) continue;
    const double removed = restitution > 0.0 ? -speed : std::min(-speed, pair.max_approach);
    const double mass = contacts.split_mass(pair, mesh.w);
    const double step = (1.0 + restitution) * removed * mass;
    const Vec3 sliding = mass * (velocity - speed * pair.normal);
    contacts.apply_impulse(pair,
                           step * pair.normal - clamp_length(sliding, mesh.rules.friction * step));
  }
  apply_velocity_changes();
}

void PostStabilization::load_velocities()
{
  contacts.velocity.resize(mesh.halo.n_slots());
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    const double *v = atom->v[mesh.halo.atom_of(s)];
    contacts.velocity[s] = Vec3(v[0], v[1], v[2]);
  }
  mesh.halo.forward_velocities(0, contacts.velocity.data());
  for (ContactParticle &p : contacts.particles) {
    const double *v = atom->v[p.atom];
    p.velocity = Vec3(v[0], v[1], v[2]);
  }
}

void PostStabilization::apply_velocity_changes()
{
  for (const ContactParticle &p : contacts.particles)
    for (int d = 0; d < 3; d++) atom->v[p.atom][d] += p.w * p.impulse[d];
  std::vector<Vec3> &impulse = contacts.impulse;
  mesh.halo.reverse_add(0, impulse.data());
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    if (impulse[s].isZero(0.0)) continue;
    const int i = mesh.halo.atom_of(s);
    for (int d = 0; d < 3; d++) atom->v[i][d] += mesh.w[s] * impulse[s][d];
    if (mesh.w[s] == 0.0) mesh.push_held(i, impulse[s]);
  }
}

/* ----------------------------------------------------------------------
   the last resort: what is still caught between moving triangles moves with them as one
------------------------------------------------------------------------- */

// A particle that passes through a triangle, the triangle, and all that shares a vertex or
// a particle with them, form a zone.  Zones grow until no particle passes.

void PostStabilization::freeze_zones()
{
  ImpactZones zones;
  for (;;) {
    std::vector<tagint> caught;
    for_near([&](int i, int t, const Sweep &sweep) {
      if (!point_triangle_contact(sweep, mesh.sweep_of_triangle(t), mesh.rules.thickness).through)
        return;
      mesh.counts.frozen++;
      caught.push_back(atom->tag[i]);
      for (int s : mesh.triangles[t]) caught.push_back(atom->tag[mesh.halo.atom_of(s)]);
    });
    const std::vector<tagint> groups = allgather(caught, comm->nprocs, world);
    if (groups.empty()) return;
    // a zone keeps its shape, unless it holds vertices that do not move alike
    if (!zones.join(groups))
      error->all(FLERR,
                 "{}: held vertex {} or its neighbors move apart from others and crush what is "
                 "between them, particle {}: move pins slower or lower the time step",
                 mesh.label, groups[1], groups[0]);
    move_rigid_zones(lmp, mesh, zones);
    mesh.load_step();
    candidates.update();
  }
}
