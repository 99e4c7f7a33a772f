// SPDX-License-Identifier: GPL-2.0-or-later
// Finds parts of a cloth that would pass others, and keeps them apart.

#include "contact/cloth_guarantee.h"

#include "atom.h"
#include "comm.h"
#include "contact/rigid_zones.h"
#include "core/contact/additive_ccd.h"
#include "core/contact/contact_impulse.h"
#include "error.h"
#include "lammps_util/atom_tools.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

// Of the distance at the start of the step, or of the thickness if that is less: what must be left
// at all times, and what a pair that would have less is given at the end
static constexpr double KEEP = 0.1, GIVEN = 0.5;

// A pair that is nearer than this, of the thickness, hardly comes nearer.
static constexpr double CLOSE = 0.02, KEEP_CLOSE = 0.9;

static constexpr int MAX_PASSES = 20;

void ClothGuarantee::rebuild()
{
  if (!ghosts.matters()) return;
  vertices_then.resize(mesh.halo.n_owned());
  for (int s = 0; s < mesh.halo.n_owned(); s++) vertices_then[s] = mesh.position(s);
  const std::array<double, 2> here = edges.longest_here();
  MPI_Allreduce(here.data(), longest.data(), 2, MPI_DOUBLE, MPI_MAX, world);
}

bool ClothGuarantee::resolve_collisions()
{
  const WallTimer clock(mesh.counts.seconds);
  mesh.load_step();
  pushed.clear();
  bool any = false;
  for (int pass = 0; pass <= MAX_PASSES; pass++) {
    find_collisions();
    const bool can_push = std::any_of(rows.begin(), rows.end(),
                                      [this](const ContactRow &row) { return missing(row) > 0.0; });
    const double mine[3] = {rows.empty() ? 0.0 : 1.0, can_push ? 1.0 : 0.0,
                            pass == 0 ? max_displacement() : 0.0};
    double all[3];
    MPI_Allreduce(mine, all, 3, MPI_DOUBLE, MPI_MAX, world);
    if (pass == 0) check_reach(all[2]);
    if (all[0] == 0.0) break;
    any = true;
    if (all[1] == 0.0 || pass == MAX_PASSES) {
      solve_velocities();
      freeze_zones();
      return true;
    }
    push_apart();
  }
  if (any) solve_velocities();
  return any;
}

// of the gap at the end of the step

double ClothGuarantee::missing(const ContactRow &row) const
{
  return row.gap - row.relative(mesh.end).dot(row.normal);
}

static PairMotion motion_of(const ClothPair &pair, const MovingTriangles &mesh)
{
  PairMotion motion{pair.kind, {}, {}};
  for (int k = 0; k < 4; k++) {
    motion.start[k] = mesh.start[pair.slots[k]];
    motion.displacement[k] = mesh.end[pair.slots[k]] - mesh.start[pair.slots[k]];
  }
  return motion;
}

void ClothGuarantee::find_collisions()
{
  rows.clear();
  masses.begin(mesh.halo.n_slots());
  candidates.update();
  candidates.for_near(0.0, [&](const ClothPair &pair, const ClosestPoints &at) {
    const double thickness = candidates.rules.of(pair.with_obstacle).thickness,
                 apart = std::min(thickness, at.vector.norm());
    const PairMotion motion = motion_of(pair, mesh);
    const double keep = std::max(KEEP * apart, std::min(KEEP_CLOSE * apart, CLOSE * thickness));
    if (stays_apart(motion, at.vector, keep)) return;
    const SafeTime safe = safe_time(motion, keep);
    rows.emplace_back(pair, closest_points(pair.kind, motion.at(safe.time)).weight,
                      safe.vector.normalized(), std::max(GIVEN * apart, keep));
  });
  for (const ContactRow &row : rows) masses.count(row);
}

void ClothGuarantee::push_apart()
{
  masses.share(mesh.halo);
  masses.clear_impulses();
  for (const ContactRow &row : rows) {
    const double depth = missing(row);
    if (depth > 0.0) masses.apply(row, depth * masses.of(row, mesh.w) * row.normal);
    mesh.counts.cloth_stops++;
    pushed.push_back(row);
  }
  mesh.halo.reverse_add(0, masses.impulse.data());
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    if (masses.impulse[s].isZero(0.0)) continue;
    mesh.end[s] += mesh.w[s] * masses.impulse[s];
    double *x = atom->x[mesh.halo.atom_of(s)];
    for (int d = 0; d < 3; d++) x[d] = mesh.end[s][d];
  }
  mesh.halo.forward_positions(0, mesh.end.data());
}

// both sides of what was pushed lose their approach, and get what restitution gives back

void ClothGuarantee::solve_velocities()
{
  masses.begin(mesh.halo.n_slots());
  for (const ContactRow &row : pushed) masses.count(row);
  masses.share(mesh.halo);
  velocity.resize(mesh.halo.n_slots());
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    const double *v = atom->v[mesh.halo.atom_of(s)];
    velocity[s] = Vec3(v[0], v[1], v[2]);
  }
  mesh.halo.forward_velocities(0, velocity.data());
  masses.clear_impulses();
  for (const ContactRow &row : pushed) {
    const ContactRules &rules = candidates.rules.of(row.with_obstacle);
    const Vec3 relative = row.relative(velocity);
    const double speed = relative.dot(row.normal);
    if (speed >= 0.0) continue;
    const double mass = masses.of(row, mesh.w), step = -(1.0 + rules.restitution) * speed * mass;
    const Vec3 sliding = mass * (relative - speed * row.normal);
    masses.apply(row, step * row.normal - clamp_length(sliding, rules.friction * step));
  }
  mesh.halo.reverse_add(0, masses.impulse.data());
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    const Vec3 &impulse = masses.impulse[s];
    if (impulse.isZero(0.0)) continue;
    const int i = mesh.halo.atom_of(s);
    for (int d = 0; d < 3; d++) atom->v[i][d] += mesh.w[s] * impulse[d];
    if (mesh.w[s] == 0.0) mesh.push_held(i, impulse);
  }
}

// Both sides of a collision, and all that shares a vertex with them, form a zone.  Zones grow until
// nothing collides.

void ClothGuarantee::freeze_zones()
{
  ImpactZones zones;
  for (;;) {
    std::vector<tagint> caught;
    find_collisions();
    for (const ContactRow &row : rows) {
      mesh.counts.cloth_frozen++;
      for (const int s : row.slots) caught.push_back(atom->tag[mesh.halo.atom_of(s)]);
    }
    const std::vector<tagint> groups = allgather(caught, comm->nprocs, world);
    if (groups.empty()) return;
    if (!zones.join(groups))    // a zone keeps its shape, unless it holds vertices that do not
      error->all(FLERR,
                 "{}: held vertices push cloth through cloth at vertices {} and {}: move pins "
                 "slower or lower the time step",
                 mesh.label, groups[0], groups[3]);
    move_rigid_zones(lmp, mesh, zones);
    mesh.load_step();
  }
}

double ClothGuarantee::max_displacement() const
{
  if (!ghosts.matters()) return 0.0;
  double max_sq = 0.0;
  for (int s = 0; s < mesh.halo.n_owned(); s++)
    max_sq = std::max({max_sq, (mesh.start[s] - vertices_then[s]).squaredNorm(),
                       (mesh.end[s] - vertices_then[s]).squaredNorm()});
  return std::sqrt(max_sq);
}

// Both sides of a pair may have come from so far since the list build.

void ClothGuarantee::check_reach(double displacement) const
{
  if (!ghosts.matters() || !mesh.has_triangles()) return;
  const double needed = reach(longest[0], longest[1], candidates.rules.max_thickness()) +
      2.0 * displacement,
               has = ghosts.reach();
  if (needed > has)
    error->all(FLERR,
               "{}: vertices have moved by up to {:.6g} in step {} since the last list build, "
               "farther than ghosts let ranks see cloth that meets cloth: lower the time step, or "
               "raise the ghost cutoff {:.6g} to {:.6g} with 'comm_modify cutoff'",
               mesh.label, displacement, update->ntimestep, has, needed);
}
