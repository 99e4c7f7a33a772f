// Contact behind the solver of a cloth: the guarantee that nobody passes.  What still goes wrong on the way
// of a step is stopped, pass after pass; what is caught between moving triangles moves with them as one.

#include "contact/contact_surface.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/rank_error.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

// Of the gap, what may be missing behind the solver, and a hair, so that the next look finds done what
// is done.  The smaller the hair, the less depends on whether it was.
static constexpr double SLACK = 1e-6, HAIR = 1e-10;

// of the thickness: what a particle that is too near may get back in one step
static constexpr double RECOVERY = 0.1;

// Of the speed with which a particle came too near behind the solver, as much is taken: the whole approach,
// unless it hardly came too near.
static constexpr double FIRM = 10.0;

static constexpr int STOP_PASSES = 200;

bool ContactSurface::settle()
{
  const Clock clock(counts->seconds);
  load_sweeps();
  bound();
  forget_pairs();
  int pass = 0;
  while (stop(pass == 0))
    if (++pass == STOP_PASSES) break;
  if (pass > 0) stop_approach();
  if (pass == STOP_PASSES) freeze();
  for (const Particle &p : particles) moved.push_back(p.atom);
  return pass > 0;
}

void ContactSurface::load_sweeps()
{
  for (int s = 0; s < halo.n_owned(); s++) {
    const Sweep sweep = sweep_of(halo.atom_of(s));
    start[s] = sweep.start;
    end[s] = sweep.end;
  }
  halo.forward_positions(0, start.data(), update->dt);
  halo.forward_positions(0, end.data());
}

// The particle that is deepest below its gap in each pass is put back to it, alone.  One that was too
// near before the step gets a part of the way back, in the first pass.

bool ContactSurface::stop(bool recover)
{
  int mine = 0, particle = -1, triangle = -1;
  ContactResult deepest;
  double approach = 0.0;    // of the deepest
  const auto put_back = [&] {
    if (triangle < 0) return;
    for (int d = 0; d < 3; d++) atom->x[particle][d] += deepest.depth * deepest.normal[d];
    if (!deepest.hit) return;
    mine = 1;
    counts->stops++;
    remember(particle, triangle, deepest);
    pairs.back().approach = approach;
  };
  for_overlapping([&](int i, int t, const Sweep &sweep) {
    if (i != particle) {
      put_back();
      particle = i;
      triangle = -1;
      deepest = ContactResult();
    }
    ContactResult touched = touch(sweep, sweep_of_triangle(t), rules->thickness, SLACK);
    const double into = touched.depth - SLACK * touched.kept;
    if (touched.through)
      touched.depth += SLACK * touched.kept;
    else {
      if (touched.hit) touched.depth = into + HAIR * touched.kept;
      if (recover) give_room(touched, sweep.end, t);
    }
    if (!is_deeper(touched, t, deepest, triangle)) return;
    deepest = touched;
    approach = touched.through ? std::numeric_limits<double>::max() : FIRM * into / update->dt;
    triangle = t;
  });
  put_back();
  int any = 0;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  return any;
}

// Two triangles may be met alike, on an edge: then the same one on all ranks is taken.

bool ContactSurface::is_deeper(const ContactResult &a, int triangle_a, const ContactResult &b,
                               int triangle_b) const
{
  if (!(a.depth > 0.0)) return false;
  if (triangle_b < 0 || a.depth > b.depth * (1.0 + SEAM)) return true;
  return a.depth >= b.depth * (1.0 - SEAM) && element[triangle_a] < element[triangle_b];
}

// at least a part of the thickness, if something of it is missing; false if nothing is

bool ContactSurface::give_room(ContactResult &touched, const Vec3 &p, int t) const
{
  const std::array<int, 3> &s = triangles[t];
  Vec3 weight;
  const Vec3 gap = distance_vector(p, end[s[0]], end[s[1]], end[s[2]], weight);
  const double distance = gap.norm();
  if (distance == 0.0 || distance >= rules->thickness) return false;
  touched.weight = weight;
  touched.normal = gap / distance;
  touched.depth =
      std::max(touched.depth, std::min(rules->thickness - distance, RECOVERY * rules->thickness));
  return true;
}

void ContactSurface::remember(int i, int triangle, const ContactResult &touched)
{
  if (entry[i] < 0) {
    entry[i] = static_cast<int>(particles.size());
    particles.push_back({});
    particles.back().atom = i;
    particles.back().w = 1.0 / atom_mass(atom, i);
  }
  particles[entry[i]].contacts++;
  pairs.push_back({});
  pairs.back().particle = entry[i];
  pairs.back().triangle = triangle;
  pairs.back().weight = touched.weight;
  pairs.back().normal = touched.normal;
}

void ContactSurface::forget_pairs()
{
  for (const Particle &p : particles) entry[p.atom] = -1;
  particles.clear();
  pairs.clear();
  entry.resize(atom->nlocal, -1);
}

bigint ContactSurface::count_too_near(tagint &one)
{
  load_sweeps();
  bound();
  bigint mine = 0, all;
  tagint example = 0;
  int last = -1;
  for_overlapping([&](int i, int t, const Sweep &sweep) {
    ContactResult touched;
    if (i == last || !give_room(touched, sweep.end, t)) return;
    last = i;
    mine++;
    example = std::max(example, atom->tag[i]);
  });
  MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  MPI_Allreduce(&example, &one, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  return all;
}

// Both sides of what was stopped lose the motion towards each other, see FIRM.  What comes back comes
// back at once.

void ContactSurface::stop_approach()
{
  share_out([](const Pair &, int) { return 1.0; });
  now.resize(halo.n_slots());
  for (int s = 0; s < halo.n_owned(); s++) {
    const double *v = atom->v[halo.atom_of(s)];
    now[s] = Vec3(v[0], v[1], v[2]);
  }
  halo.forward_velocities(0, now.data());
  change.assign(halo.n_slots(), Vec3::Zero());
  for (Particle &p : particles) {
    const double *v = atom->v[p.atom];
    p.velocity = Vec3(v[0], v[1], v[2]);
    p.change.setZero();
  }
  for (const Pair &pair : pairs) {
    const Vec3 velocity = velocity_from(pair);
    const double speed = velocity.dot(pair.normal);
    if (speed >= 0.0) continue;
    const double taken = rules->restitution > 0.0 ? -speed : std::min(-speed, pair.approach);
    const double mass = split_mass(pair, w), step = (1.0 + rules->restitution) * taken * mass;
    const Vec3 sliding = mass * (velocity - speed * pair.normal);
    give(pair, step * pair.normal - at_most(sliding, rules->friction * step));
  }
  take_velocities();
}

// what give() has handed out were impulses

void ContactSurface::take_velocities()
{
  for (const Particle &p : particles)
    for (int d = 0; d < 3; d++) atom->v[p.atom][d] += p.w * p.change[d];
  halo.reverse_add(0, change.data());
  for (int s = 0; s < halo.n_owned(); s++) {
    if (change[s].isZero(0.0)) continue;
    const int i = halo.atom_of(s);
    for (int d = 0; d < 3; d++) atom->v[i][d] += w[s] * change[s][d];
    if (w[s] == 0.0) take_held(i, change[s]);
  }
}

void ContactSurface::take_held(int i, const Vec3 &impulse)
{
  mesh->push_held(i, impulse);
  for (int d = 0; d < 3; d++) counts->impulse[d] += impulse[d] / force->ftm2v;
}

/* ----------------------------------------------------------------------
   the last resort: what is still caught between moving triangles moves with them as one
------------------------------------------------------------------------- */

// A particle that passes through a triangle, the triangle, and all that shares a vertex or a particle
// with them, form a zone.  It keeps the shape of the start of the step, where nobody was on a wrong
// side, and moves with its mean velocity: momentum is kept, energy lost.  Zones grow until all is well.
// Provot, Graphics Interface 1997.

void ContactSurface::freeze()
{
  ContactZones zones;
  for (;;) {
    std::vector<tagint> caught;
    for_overlapping([&](int i, int t, const Sweep &sweep) {
      if (!touch(sweep, sweep_of_triangle(t), rules->thickness).through) return;
      counts->frozen++;
      caught.push_back(atom->tag[i]);
      for (int s : triangles[t]) caught.push_back(atom->tag[halo.atom_of(s)]);
    });
    const std::vector<tagint> groups = allgather(caught, comm->nprocs, world);
    if (groups.empty()) return;
    // a zone keeps its shape, unless it holds vertices that do not move alike
    if (!zones.join(groups))
      error->all(FLERR,
                 "{}: held vertex {} or its neighbours move apart from others and crush what is "
                 "between them, particle {}: move pins slower or lower the time step",
                 label, groups[1], groups[0]);
    move_zones(zones);
    load_sweeps();
    bound();
  }
}

void ContactSurface::move_zones(const ContactZones &zones)
{
  struct Sum {
    double mass, displacement[3], momentum[3];    // of the free members
    double held, held_displacement[3],
        held_velocity[3];    // number of the held ones, and sums over them
  };
  constexpr int SIZE = sizeof(Sum) / sizeof(double);
  std::vector<Sum> mine(zones.size(), Sum{}), all(zones.size());
  std::vector<std::pair<int, int>> members;    // atom and zone
  for (int i = 0; i < atom->nlocal; i++)
    if (const int z = zones.of(atom->tag[i]); z >= 0) members.emplace_back(i, z);
  const auto is_held = [&](int i) { return mesh->has_vertex(i) && mesh->inverse_mass(i) == 0.0; };

  for (const auto &[i, z] : members) {
    const Vec3 displacement = sweep_of(i).end - sweep_of(i).start;
    const double m = atom_mass(atom, i);
    (is_held(i) ? mine[z].held : mine[z].mass) += is_held(i) ? 1.0 : m;
    for (int d = 0; d < 3; d++) {
      (is_held(i) ? mine[z].held_displacement : mine[z].displacement)[d] +=
          is_held(i) ? displacement[d] : m * displacement[d];
      (is_held(i) ? mine[z].held_velocity : mine[z].momentum)[d] += is_held(i) ? atom->v[i][d]
                                                                               : m * atom->v[i][d];
    }
  }
  MPI_Allreduce(mine.data(), all.data(), SIZE * zones.size(), MPI_DOUBLE, MPI_SUM, world);

  for (const auto &[i, z] : members) {
    const Sum &sum = all[z];
    const Sweep sweep = sweep_of(i);
    Vec3 displacement, velocity, lost;
    for (int d = 0; d < 3; d++) {
      displacement[d] = sum.held > 0.0 ? sum.held_displacement[d] / sum.held
                                       : sum.displacement[d] / sum.mass;
      velocity[d] = sum.held > 0.0 ? sum.held_velocity[d] / sum.held : sum.momentum[d] / sum.mass;
      lost[d] = sum.momentum[d] - sum.mass * velocity[d];
    }
    if (!is_held(i)) {
      for (int d = 0; d < 3; d++) {
        atom->x[i][d] = sweep.start[d] + displacement[d];
        atom->v[i][d] = velocity[d];
      }
      continue;
    }
    const double apart = (sweep.end - sweep.start - displacement).norm();
    if (apart > rules->thickness)
      rank_error(lmp, FLERR,
                 "{}: held vertex {} moves {} away from others in one step and crushes what is "
                 "between them: move pins slower or lower the time step",
                 label, atom->tag[i], apart);
    take_held(i, lost / sum.held);
  }
}
