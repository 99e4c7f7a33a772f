// Contact inside the solver of a cloth: who may meet whom, on which side of the sheet the fluid is, and the
// projections.  Behind the solver: contact/post_stabilization.cpp.

#include "contact/contact_surface.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "fix.h"
#include "force.h"
#include "lammps_util/atom_tools.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

// of the thickness: what may lie between two looks for who is near
static constexpr double MOST_ROOM = 1.5;

Eigen::Vector3d LAMMPS_NS::at_most(const Eigen::Vector3d &v, double most)
{
  const double size = v.norm();
  return size > most ? Eigen::Vector3d(most / size * v) : v;
}

ContactSurface::ContactSurface(LAMMPS *lmp_, ContactMesh *mesh_, Fix *contact, int meets_,
                               const ContactRules *rules_, ContactCounts *counts_) :
    TriangleSet(lmp_, mesh_, contact, fmt::format("fix {} cloth/contact", contact->id)),
    meets(meets_), rules(rules_), counts(counts_), last_places(nullptr), substep_dt(0.0),
    remaining(0.0)
{
}

void ContactSurface::rebuild(double far)
{
  TriangleSet::rebuild(far);

  w.assign(halo.n_slots(), 0.0);
  w_solver = w;
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    w[s] = mesh->inverse_mass(i);
    w_solver[s] = mesh->inverse_mass_in_solver(i);
  }
  halo.forward(0, w);
  halo.forward(0, w_solver);
  start.resize(halo.n_slots());
  end.resize(halo.n_slots());
  received.assign(halo.n_owned(), Vec3::Zero());
  found_at.clear();    // nobody was looked for yet
  start_then.clear();
}

/* ----------------------------------------------------------------------
   who may meet whom
------------------------------------------------------------------------- */

// does an atom meet this mesh, and can it give way?

bool ContactSurface::may_move(int i) const
{
  if (!(atom->mask[i] & meets)) return false;
  return std::none_of(others.begin(), others.end(), [i](const ContactMesh *other) {
    return other->has_vertex(i) && other->inverse_mass(i) == 0.0;
  });
}

// from where the last step has left it to where it is

Sweep ContactSurface::sweep_of(int i) const
{
  const double *x = atom->x[i], *last = last_places[i];
  return {Vec3(last[0], last[1], last[2]), Vec3(x[0], x[1], x[2])};
}

std::array<Sweep, 3> ContactSurface::sweep_of_triangle(int t) const
{
  std::array<Sweep, 3> sweep;
  for (int q = 0; q < 3; q++) sweep[q] = {start[triangles[t][q]], end[triangles[t][q]]};
  return sweep;
}

// of the way of a triangle in this step, with room for contact

Box ContactSurface::box_of_way(int t) const
{
  Box box;
  for (int s : triangles[t]) {
    box.extend(start[s]);
    box.extend(end[s]);
  }
  box.min().array() -= 2.0 * rules->thickness;
  box.max().array() += 2.0 * rules->thickness;
  return box;
}

void ContactSurface::set_discs(double reach)
{
  discs.resize(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); t++) {
    const auto &[a, b, c] = triangles[t];
    discs[t] = disc_around(end[a], end[b], end[c]);
    double displacement_sq = 0.0;
    for (int s : triangles[t])
      displacement_sq = std::max(displacement_sq, (end[s] - start[s]).squaredNorm());
    discs[t].room = std::sqrt(displacement_sq);
  }
  disc_grid.build(discs, reach);
}

// How far vertices and particles may go before those who are near are looked for again: as far as until
// the next list build, when they are in any case, but not so far that too many are near.

double ContactSurface::room_to_move() const
{
  return rules->thickness * std::clamp(0.5 * neighbor->skin / rules->thickness, 1.0, MOST_ROOM);
}

void ContactSurface::find_near()
{
  const double far = 2.0 * (rules->thickness + room_to_move());
  near.clear();
  set_discs(far);
  start_then = start;
  end_then = end;
  found_at.resize(atom->nlocal);
  for (int i = 0; i < atom->nlocal; i++) {
    const double *x = atom->x[i];
    found_at[i] = Vec3(x[0], x[1], x[2]);
    if (!may_move(i)) continue;
    const Sweep particle = sweep_of(i);
    const std::size_t first = near.size();
    disc_grid.within(particle.end, far + (particle.end - particle.start).norm(),
                     [&](int t) { near.push_back({i, t}); });
    std::sort(near.begin() + first, near.end());    // in whatever order cells have them
  }
}

void ContactSurface::bound()
{
  swept_for.assign(triangles.size(), false);
  swept.resize(triangles.size());
  if (!near_holds()) find_near();
}

// Are all who may meet in this step still among those that were near?

bool ContactSurface::near_holds() const
{
  if (found_at.size() != static_cast<std::size_t>(atom->nlocal) ||
      start_then.size() != start.size())
    return false;
  const double room = room_to_move();
  return !(std::max(farthest_vertex_sq(), farthest_sq()) > room * room);
}

// Of the ways of the vertices, squared, since then: from the end of the step before or from its start,
// whichever is nearer, since boxes hold both.

double ContactSurface::farthest_vertex_sq() const
{
  double farthest = 0.0;
  for (const std::vector<Vec3> *place : {&start, &end})
    for (std::size_t s = 0; s < place->size(); s++) {
      const Vec3 from_start = (*place)[s] - start_then[s], from_end = (*place)[s] - end_then[s];
      farthest = std::max(farthest, std::min(from_start.squaredNorm(), from_end.squaredNorm()));
    }
  return farthest;
}

// and of all who meet this mesh.  Every particle, twice in each step: one loop without branches.

double ContactSurface::farthest_sq() const
{
  const int n = atom->nlocal, *const mask = atom->mask;
  if (n == 0) return 0.0;
  const double *const x = atom->x[0], *const then = found_at[0].data();
  double farthest = 0.0;
#pragma omp simd reduction(max : farthest)
  for (int i = 0; i < n; i++) {
    const double dx = x[3 * i] - then[3 * i], dy = x[3 * i + 1] - then[3 * i + 1],
                 dz = x[3 * i + 2] - then[3 * i + 2];
    const double displacement_sq = mask[i] & meets ? dx * dx + dy * dy + dz * dz : 0.0;
    farthest = std::max(farthest, displacement_sq);
  }
  return farthest;
}

// made when somebody asks

const Box &ContactSurface::swept_box(int t)
{
  if (!swept_for[t]) swept[t] = box_of_way(t);
  swept_for[t] = true;
  return swept[t];
}

bool ContactSurface::begin_step(const Vertex *from_here, const Vertex *to_here, double dt)
{
  const Clock clock(counts->seconds);
  for (int s = 0; s < halo.n_owned(); s++) {
    start[s] = Vec3(from_here[s].x, from_here[s].y, from_here[s].z);
    end[s] = Vec3(to_here[s].x, to_here[s].y, to_here[s].z);
  }
  remaining = dt;
  halo.forward_positions(0, start.data(), remaining);
  halo.forward_positions(0, end.data());
  bound();
  meet();
  int mine = !pairs.empty(), any = 0;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (!any) return false;

  for (Particle &p : particles) p.velocity = p.velocity_before = (p.end - p.start) / dt;
  for (Particle &p : particles) p.end = p.start;
  std::fill(received.begin(), received.end(), Vec3::Zero());
  return true;
}

void ContactSurface::meet()
{
  forget_pairs();
  for_overlapping([this](int i, int t, const Sweep &sweep) {
    if (!may_meet(sweep, sweep_of_triangle(t), 2.0 * rules->thickness)) return;
    remember(i, t, ContactResult());
    particles[entry[i]].start = sweep.start;
    particles[entry[i]].end = sweep.end;
  });
}

// masses split evenly over all pairs

double ContactSurface::split_mass(const Pair &pair, const std::vector<double> &inverse_mass) const
{
  const Particle &p = particles[pair.particle];
  double inverse = p.w * p.contacts;
  for (int q = 0; q < 3; q++) {
    const int s = triangles[pair.triangle][q];
    inverse += inverse_mass[s] * shares[s][0] * pair.weight[q] * pair.weight[q];
  }
  return 1.0 / inverse;
}

// masses split as pairs push, so that one that hardly pushes hardly counts

double ContactSurface::loaded_mass(const Pair &pair) const
{
  const Particle &p = particles[pair.particle];
  double inverse = p.w * p.load;
  for (int q = 0; q < 3; q++) {
    const int s = triangles[pair.triangle][q];
    inverse += w_solver[s] * pair.weight[q] * shares[s][0];
  }
  return pair.push / inverse;
}

/* ----------------------------------------------------------------------
   sides
------------------------------------------------------------------------- */

void ContactSurface::find_sides(double reach, int sheet, std::vector<Sides> &sides)
{
  const Clock clock(counts->seconds);
  for (int s = 0; s < halo.n_slots(); s++) start[s] = end[s] = place(s);
  set_discs(reach);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!may_move(i)) continue;
    const double *x = atom->x[i];
    const int side = side_at(Vec3(x[0], x[1], x[2]), reach);
    if (side != 0) sides[i] |= side_of_sheet(sheet, side > 0);
  }
}

// 1 above, -1 below, 0 far away or beyond the border.  At an edge or a vertex several triangles are
// equally near; the one that is seen most from the front knows the side.

int ContactSurface::side_at(const Vec3 &p, double reach)
{
  double nearest = std::numeric_limits<double>::max(), height = 0.0;
  bool beyond = false;
  disc_grid.nearest(p, reach, SEAM * reach, [&](int t) {
    const Vec3 &a = end[triangles[t][0]], &b = end[triangles[t][1]], &c = end[triangles[t][2]];
    Vec3 weight;
    const Vec3 out = distance_vector(p, a, b, c, weight);
    const double distance = out.norm();
    if (distance > nearest * (1.0 + SEAM) || distance > reach) return;
    const Vec3 normal = (b - a).cross(c - a).normalized();
    const double over = normal.dot(out);
    if (distance < nearest * (1.0 - SEAM)) {
      height = 0.0;
      beyond = false;
    }
    nearest = std::min(nearest, distance);
    if (std::fabs(over) > std::fabs(height)) height = over;
    beyond = beyond || is_on_border(t, weight);
  });
  return beyond || height == 0.0 ? 0 : (height > 0.0 ? 1 : -1);
}

/* ----------------------------------------------------------------------
   inside the solver
------------------------------------------------------------------------- */

void ContactSurface::begin_substep(const Vertex *vertices, const Vertex *v, double dt)
{
  const Clock clock(counts->seconds);
  substep_dt = dt;
  substep_start = vertices;
  const double before = remaining;
  remaining -= dt;
  for (Particle &p : particles) {
    p.from = p.end;
    p.displacement = dt * p.velocity;
    p.end = p.from + p.displacement;
    p.touched = false;
    p.contacts = 0;
  }
  for (Pair &pair : pairs) {
    particles[pair.particle].contacts++;
    pair.met = false;
    pair.push = 0.0;
    pair.rub.setZero();
  }
  share_out([](const Pair &, int) { return 1.0; });
  if (rules->restitution > 0.0) load_velocities(v);
  if (rules->friction == 0.0) return;
  from.resize(halo.n_slots());
  for (int s = 0; s < halo.n_owned(); s++)
    from[s] = Vec3(vertices[s].x, vertices[s].y, vertices[s].z);
  halo.forward_positions(0, from.data(), before);
}

void ContactSurface::project(Vertex *displacement)
{
  const Clock clock(counts->seconds);
  for (int s = 0; s < halo.n_owned(); s++) {
    const Vertex &from_here = substep_start[s];
    end[s] = Vec3(from_here.x + displacement[s].x, from_here.y + displacement[s].y,
                  from_here.z + displacement[s].z);
  }
  halo.forward_positions(0, end.data(), remaining);
  change.assign(halo.n_slots(), Vec3::Zero());
  for (Particle &particle : particles) particle.change.setZero();

  for (Pair &pair : pairs) {
    press(pair);
    if (rules->friction > 0.0 && pair.met) rub(pair);
  }

  for (Particle &p : particles) {
    p.displacement += p.w * p.change;
    p.end = p.from + p.displacement;
  }
  halo.reverse_add(0, change.data());
  for (int s = 0; s < halo.n_owned(); s++) {
    displacement[s].x += w_solver[s] * change[s][0];
    displacement[s].y += w_solver[s] * change[s][1];
    displacement[s].z += w_solver[s] * change[s][2];
    received[s] += change[s] / substep_dt;
  }
}

// Closes what is missing of the gap.  What was pushed too far before is taken back, but a pair never
// pulls.  All of this is continuous in the positions: whether a gap that is just closed counts as a hit
// is round-off, and makes no difference.

void ContactSurface::press(Pair &pair)
{
  const Particle &p = particles[pair.particle];
  const std::array<int, 3> &slots = triangles[pair.triangle];
  const ContactResult touched =
      touch({p.start, p.end}, sweep_of_triangle(pair.triangle), rules->thickness, 0.0);
  double missing = touched.depth;
  if (touched.hit) {
    pair.weight = touched.weight;
    pair.normal = touched.normal;
    if (!pair.met && rules->restitution > 0.0)
      pair.speed_before = velocity_from(pair).dot(pair.normal);
    pair.met = true;
    pair.kept = touched.kept;
    counts->contacts++;
    counts->deepest = std::max(counts->deepest, touched.depth);
  } else if (pair.push > 0.0) {
    const Vec3 gap =
        distance_vector(p.end, end[slots[0]], end[slots[1]], end[slots[2]], pair.weight);
    const double distance = gap.norm();
    missing = pair.kept - distance;
    if (distance > 0.0) pair.normal = gap / distance;
  } else
    return;
  const double step = std::max(missing * split_mass(pair, w_solver), -pair.push);
  pair.push += step;
  give(pair, step * pair.normal);
}

// Coulomb friction against the sliding of this substep

void ContactSurface::rub(Pair &pair)
{
  const Particle &p = particles[pair.particle];
  Vec3 slip = p.end - p.from;
  for (int q = 0; q < 3; q++) {
    const int s = triangles[pair.triangle][q];
    slip -= pair.weight[q] * (end[s] - from[s]);
  }
  slip -= slip.dot(pair.normal) * pair.normal;
  const Vec3 wanted =
      at_most(pair.rub - split_mass(pair, w_solver) * slip, rules->friction * pair.push);
  give(pair, wanted - pair.rub);
  pair.rub = wanted;
}

// mass times length on the particle, and the opposite on the triangle

void ContactSurface::give(const Pair &pair, const Vec3 &by)
{
  Particle &p = particles[pair.particle];
  p.change += by;
  p.touched = true;
  for (int q = 0; q < 3; q++) change[triangles[pair.triangle][q]] -= pair.weight[q] * by;
}

// Positions that were put right may leave a motion apart behind, or not all of the approach gone.  What
// touches goes on with the part of its approach that the restitution gives back, and no more; but
// a pair never pulls.

void ContactSurface::end_substep(Vertex *v, double dt)
{
  const Clock clock(counts->seconds);
  for (Particle &p : particles) {
    if (p.touched) p.velocity = p.displacement / dt;
    p.load = 0.0;
    p.change.setZero();
  }
  for (Pair &pair : pairs) particles[pair.particle].load += pair.push;
  share_out([](const Pair &pair, int q) { return pair.push * pair.weight[q]; });
  load_velocities(v);
  change.assign(halo.n_slots(), Vec3::Zero());
  for (const Pair &pair : pairs)
    if (pair.push > 0.0) part(pair, dt);
  for (Particle &p : particles) p.velocity += p.w * p.change;
  halo.reverse_add(0, change.data());
  for (int s = 0; s < halo.n_owned(); s++) {
    v[s].x += w_solver[s] * change[s][0];
    v[s].y += w_solver[s] * change[s][1];
    v[s].z += w_solver[s] * change[s][2];
    received[s] += change[s];
  }
}

void ContactSurface::part(const Pair &pair, double dt)
{
  const double mass = loaded_mass(pair), pushed = pair.push / dt;
  const Vec3 velocity = velocity_from(pair);
  const double speed = velocity.dot(pair.normal);
  const double wanted = rules->restitution * std::max(0.0, -pair.speed_before);
  const double step = std::max((wanted - speed) * mass, -pushed);
  Vec3 impulse = step * pair.normal;
  if (rules->friction > 0.0) {
    const Vec3 rubbed = pair.rub / dt;
    impulse -= rubbed;
    impulse += at_most(rubbed - mass * (velocity - speed * pair.normal),
                       rules->friction * (pushed + step));
  }
  give(pair, impulse);
}

// of the particle from the triangle

Eigen::Vector3d ContactSurface::velocity_from(const Pair &pair) const
{
  Vec3 velocity = particles[pair.particle].velocity;
  for (int q = 0; q < 3; q++) velocity -= pair.weight[q] * now[triangles[pair.triangle][q]];
  return velocity;
}

void ContactSurface::load_velocities(const Vertex *v)
{
  now.resize(halo.n_slots());
  for (int s = 0; s < halo.n_owned(); s++) now[s] = Vec3(v[s].x, v[s].y, v[s].z);
  halo.forward_velocities(0, now.data());
}

void ContactSurface::end_step()
{
  const Clock clock(counts->seconds);
  for (const Particle &p : particles) {
    if (p.velocity != p.velocity_before) moved.push_back(p.atom);
    for (int d = 0; d < 3; d++) {
      atom->v[p.atom][d] += p.velocity[d] - p.velocity_before[d];
      atom->x[p.atom][d] = p.end[d];
    }
  }
  for (int s = 0; s < halo.n_owned(); s++)
    if (w[s] == 0.0)
      for (int d = 0; d < 3; d++) counts->impulse[d] += received[s][d] / force->ftm2v;
}

/* ----------------------------------------------------------------------
   for the vertices of another mesh
------------------------------------------------------------------------- */

void ContactSurface::look_around()
{
  load_sweeps();
  boxes.resize(triangles.size());
  for (std::size_t t = 0; t < boxes.size(); t++) boxes[t] = box_of_way(static_cast<int>(t));
  grid.build(boxes);
  change.assign(halo.n_slots(), Vec3::Zero());
}

std::array<Sweep, 3> ContactSurface::triangle_until(int t, double part) const
{
  std::array<Sweep, 3> sweep = sweep_of_triangle(t);
  for (Sweep &s : sweep) s.end = s.start + part * (s.end - s.start);
  return sweep;
}

Eigen::Vector3d ContactSurface::displacement_of(int t, const Vec3 &weight) const
{
  Vec3 displacement = Vec3::Zero();
  for (int q = 0; q < 3; q++)
    displacement += weight[q] * (end[triangles[t][q]] - start[triangles[t][q]]);
  return displacement;
}

void ContactSurface::push_triangle(int t, const Vec3 &weight, const Vec3 &impulse)
{
  for (int q = 0; q < 3; q++) change[triangles[t][q]] += weight[q] * impulse;
}

void ContactSurface::hand_over_pushes()
{
  halo.reverse_add(0, change.data());
  for (int s = 0; s < halo.n_owned(); s++)
    if (!change[s].isZero(0.0)) take_held(halo.atom_of(s), change[s]);
}

double ContactSurface::memory_usage() const
{
  return halo.memory_usage() + grid.bytes() + disc_grid.bytes() +
      bytes_of(start, end, change, from, now, w, w_solver, shares, received) +
      bytes_of(boxes, swept, swept_for, discs, near, found_at, start_then, end_then) +
      bytes_of(particles, moved, entry, pairs);
}
