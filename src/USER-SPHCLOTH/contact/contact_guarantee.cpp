// SPDX-License-Identifier: GPL-2.0-or-later
// Finds what would pass cloth or an obstacle, and keeps it apart.

#include "contact/contact_guarantee.h"

#include "atom.h"
#include "comm.h"
#include "contact/rigid_zones.h"
#include "core/contact/additive_ccd.h"
#include "error.h"
#include "lammps_util/atom_tools.h"
#include "update.h"

#include <algorithm>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

// Of the distance at the start of the step, or of the thickness if that is less: what must be left
// at all times, and what a pair that would have less is given at the end
static constexpr double KEEP = 0.1, GIVEN = 0.5;

// A pair that is nearer than this, of the thickness, hardly comes nearer.
static constexpr double CLOSE = 0.02, KEEP_CLOSE = 0.9;

static constexpr int MAX_PASSES = 20;
static constexpr double EXACTLY = std::numeric_limits<double>::infinity();

void ContactGuarantee::rebuild()
{
  if (of_cloth.none() || !ghosts.matters()) return;
  vertices_then.resize(mesh.halo.n_owned());
  for (int s = 0; s < mesh.halo.n_owned(); s++) vertices_then[s] = mesh.position(s);
  const std::array<double, 2> here = edges.longest_here();
  MPI_Allreduce(here.data(), longest.data(), 2, MPI_DOUBLE, MPI_MAX, world);
}

bool ContactGuarantee::resolve_collisions()
{
  velocities.clear();
  bool any = false;
  for (int pass = 0; pass <= MAX_PASSES; pass++) {
    find_collisions(pass > 0);
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
      velocities.solve();
      freeze_zones();
      return true;
    }
    push_apart();
  }
  if (any) velocities.solve();
  return any;
}

// of the gap at the end of the step

double ContactGuarantee::missing(const ContactRow &row) const
{
  return row.gap - row.relative(mesh.end).dot(row.normal);
}

static PairMotion motion_of(const ContactPair &pair, const MovingTriangles &mesh)
{
  PairMotion motion{pair.kind, {}, {}};
  for (int k = 0; k < 4; k++) {
    motion.start[k] = mesh.start[pair.slots[k]];
    motion.displacement[k] = mesh.end[pair.slots[k]] - mesh.start[pair.slots[k]];
  }
  return motion;
}

// The candidates of particles are those of their gaps, until triangles have moved.

void ContactGuarantee::find_collisions(bool triangles_moved)
{
  rows.clear();
  of_cloth.update();
  of_cloth.for_near(0.0,
                    [this](const ContactPair &pair, const ClosestPoints &at) { follow(pair, at); });
  if (triangles_moved) {
    mesh.step_start.atoms_moved();
    of_particles.update();
  }
  find_collisions_of_particles();
  masses.begin(mesh.end.size());
  for (const ContactRow &row : rows) masses.count(row);
}

// Of the triangles that a particle would meet, those count that are nearest then: their directions
// lean the least into others.

void ContactGuarantee::find_collisions_of_particles()
{
  std::size_t first = rows.size();
  double smallest = 0.0;
  int particle = -1;
  of_particles.for_near(0.0, [&](int i, int t, const ClosestPoints &at) {
    if (i != particle) first = rows.size();
    particle = i;
    if (at.vector.isZero(0.0) || !follow(mesh.pair_of(i, t), at)) return;
    const ContactRow row = rows.back();
    rows.pop_back();
    const double leaning =
        std::max(SEAM, mesh.leaning_into_others(t, {row.weight, row.normal}, EXACTLY));
    if (rows.size() > first && leaning > smallest * (1.0 + SEAM)) return;
    if (rows.size() > first && leaning < smallest * (1.0 - SEAM)) rows.resize(first, row);
    rows.push_back(row);
    smallest = leaning;
  });
}

// A row if both sides do not stay apart

bool ContactGuarantee::follow(const ContactPair &pair, const ClosestPoints &at)
{
  const double thickness = rules.of(pair.meeting).thickness,
               apart = std::min(thickness, at.vector.norm()),
               keep = std::max(KEEP * apart, std::min(KEEP_CLOSE * apart, CLOSE * thickness));
  const PairMotion motion = motion_of(pair, mesh);
  if (stays_apart(motion, at.vector, keep)) return false;
  const SafeTime safe = safe_time(motion, keep);
  rows.emplace_back(pair, closest_points(pair.kind, motion.at(safe.time)).weight,
                    safe.vector.normalized(), std::max(GIVEN * apart, keep));
  return true;
}

void ContactGuarantee::push_apart()
{
  masses.share(mesh.halo);
  masses.clear_impulses();
  for (const ContactRow &row : rows) {
    const double depth = missing(row);
    if (depth > 0.0) masses.apply(row, depth * masses.of(row, mesh.w) * row.normal);
    (row.meeting == Meeting::PARTICLE ? mesh.counts.stops : mesh.counts.cloth_stops)++;
    velocities.add(row);
  }
  mesh.halo.reverse_add(0, masses.impulse.data());
  for (int s = 0; s < static_cast<int>(mesh.end.size()); s++) {
    if (masses.impulse[s].isZero(0.0) || !mesh.is_owned(s)) continue;
    mesh.end[s] += mesh.w[s] * masses.impulse[s];
    const int i = mesh.atom_of(s);
    for (int d = 0; d < 3; d++) atom->x[i][d] = mesh.end[s][d];
    if (mesh.is_particle(s)) mesh.step_start.moved.push_back(i);
  }
  mesh.halo.forward_positions(0, mesh.end.data());
}

// Both sides of a collision, and all that shares a vertex with them, form a zone.  Zones grow until
// nothing collides.

void ContactGuarantee::freeze_zones()
{
  ImpactZones zones;
  for (;;) {
    std::vector<tagint> caught;
    find_collisions(true);
    for (const ContactRow &row : rows) {
      (row.meeting == Meeting::PARTICLE ? mesh.counts.frozen : mesh.counts.cloth_frozen)++;
      for (const int s : row.slots) caught.push_back(atom->tag[mesh.atom_of(s)]);
    }
    const std::vector<tagint> groups = allgather(caught, comm->nprocs, world);
    if (groups.empty()) return;
    if (!zones.join(groups))    // a zone keeps its shape, unless it holds vertices that do not
      error->all(FLERR,
                 "{}: held vertex {} or its neighbors move apart from others and crush what is "
                 "between them, atom {}: move pins slower or lower the time step",
                 mesh.label, groups[1], groups[0]);
    move_rigid_zones(lmp, mesh, zones);
    mesh.load_step();
  }
}

double ContactGuarantee::max_displacement() const
{
  if (of_cloth.none() || !ghosts.matters()) return 0.0;
  return mesh.max_displacement(vertices_then);
}

// Both sides of a pair may have come from so far since the list build.

void ContactGuarantee::check_reach(double displacement) const
{
  if (of_cloth.none() || !ghosts.matters() || !mesh.has_triangles()) return;
  const double needed = reach(longest[0], longest[1], rules.max_thickness()) + 2.0 * displacement,
               has = ghosts.reach();
  if (needed > has)
    error->all(FLERR,
               "{}: vertices have moved by up to {:.6g} in step {} since the last list build, "
               "farther than ghosts let ranks see cloth that meets cloth: lower the time step, or "
               "raise the ghost cutoff {:.6g} to {:.6g} with 'comm_modify cutoff'",
               mesh.label, displacement, update->ntimestep, has, needed);
}
