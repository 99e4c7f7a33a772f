#include "contact_surface.h"

#include "atom.h"
#include "atom_tools.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

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

// of the thickness: what may lie between two looks for who is near
static constexpr double MOST_ROOM = 1.5;

static constexpr int STOP_PASSES = 200;

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

void ContactSurface::set_boxes(double margin)
{
  boxes.resize(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); t++) {
    boxes[t].setEmpty();
    double way_sq = 0.0;
    for (int s : triangles[t]) {
      boxes[t].extend(start[s]);
      boxes[t].extend(end[s]);
      way_sq = std::max(way_sq, (end[s] - start[s]).squaredNorm());
    }
    const Vec3 room = Vec3::Constant(margin + std::sqrt(way_sq));
    boxes[t].min() -= room;
    boxes[t].max() += room;
  }
  grid.build(boxes);
}

// How far vertices and particles may go before those who are near are looked for again: as far as until
// the next list build, when they are in any case, but not so far that too many are near.

double ContactSurface::room_to_move() const
{
  return rules->thickness * std::clamp(0.5 * neighbor->skin / rules->thickness, 1.0, MOST_ROOM);
}

void ContactSurface::find_near()
{
  const double skin = room_to_move();
  near.clear();
  set_boxes(2.0 * rules->thickness + skin);
  start_then = start;
  end_then = end;
  const Box &cloth_box = grid.bounds();
  found_at.resize(atom->nlocal);
  for (int i = 0; i < atom->nlocal; i++) {
    const double *x = atom->x[i];
    found_at[i] = Vec3(x[0], x[1], x[2]);
    if (!may_move(i)) continue;
    const Sweep particle = sweep_of(i);
    Box box(particle.start);
    box.extend(particle.end);
    box.min().array() -= skin;
    box.max().array() += skin;
    if (!cloth_box.intersects(box)) continue;
    grid.query(box, [&](int t) {
      if (boxes[t].intersects(box)) near.push_back({i, t});
    });
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
    const double way_sq = mask[i] & meets ? dx * dx + dy * dy + dz * dz : 0.0;
    farthest = std::max(farthest, way_sq);
  }
  return farthest;
}

// those of the near ones whose ways overlap in this step

template <class Visit> void ContactSurface::for_overlapping(Visit visit)
{
  int last = -1;
  Sweep sweep;
  Box box;
  for (const auto &[i, t] : near) {
    if (i != last) {
      sweep = sweep_of(i);
      box = Box(sweep.start);
      box.extend(sweep.end);
      last = i;
    }
    if (swept_box(t).intersects(box)) visit(i, t, sweep);
  }
}

// of the way of a triangle in this step, made when somebody asks

const Box &ContactSurface::swept_box(int t)
{
  Box &box = swept[t];
  if (swept_for[t]) return box;
  swept_for[t] = true;
  box.setEmpty();
  for (int s : triangles[t]) {
    box.extend(start[s]);
    box.extend(end[s]);
  }
  const Vec3 reach = Vec3::Constant(2.0 * rules->thickness);
  box.min() -= reach;
  box.max() += reach;
  return box;
}

bool ContactSurface::begin_step(const Vertex *from_here, const Vertex *to_here, double dt)
{
  const Clock clock(counts->seconds);
  for (int s = 0; s < halo.n_owned(); s++) {
    start[s] = Vec3(from_here[s].x, from_here[s].y, from_here[s].z);
    end[s] = Vec3(to_here[s].x, to_here[s].y, to_here[s].z);
  }
  remaining = dt;
  halo.forward_places(0, start.data(), remaining);
  halo.forward_places(0, end.data());
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
    remember(i, t, Touch());
    particles[entry[i]].start = sweep.start;
    particles[entry[i]].end = sweep.end;
  });
}

// the sum of what each pair asks of the mass of its vertices

template <class Part> void ContactSurface::share_out(Part part)
{
  shares.assign(halo.n_slots(), Vec3::Zero());
  for (const Pair &pair : pairs)
    for (int q = 0; q < 3; q++) shares[triangles[pair.triangle][q]][0] += part(pair, q);
  halo.reverse_add(0, shares.data());
  halo.forward(0, shares.data());
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
  set_boxes(reach);
  spheres.resize(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); t++) {
    const Vec3 &a = end[triangles[t][0]], &b = end[triangles[t][1]], &c = end[triangles[t][2]];
    const Vec3 centre = (a + b + c) / 3.0;
    spheres[t] = {centre,
                  std::max({(a - centre).norm(), (b - centre).norm(), (c - centre).norm()})};
  }
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
  grid.query(Box(p), [&](int t) {
    const double far = std::min(reach, nearest) * (1.0 + SEAM) + spheres[t].radius;
    if ((p - spheres[t].centre).squaredNorm() > far * far) return;
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
    for (int q = 0; q < 3; q++) beyond = beyond || (weight[q] <= 0.0 && is_border(element[t], q));
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
    p.way = dt * p.velocity;
    p.end = p.from + p.way;
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
  halo.forward_places(0, from.data(), before);
}

void ContactSurface::project(Vertex *way)
{
  const Clock clock(counts->seconds);
  for (int s = 0; s < halo.n_owned(); s++) {
    const Vertex &from_here = substep_start[s];
    end[s] = Vec3(from_here.x + way[s].x, from_here.y + way[s].y, from_here.z + way[s].z);
  }
  halo.forward_places(0, end.data(), remaining);
  change.assign(halo.n_slots(), Vec3::Zero());
  for (Particle &particle : particles) particle.change.setZero();

  for (Pair &pair : pairs) {
    press(pair);
    if (rules->friction > 0.0 && pair.met) rub(pair);
  }

  for (Particle &p : particles) {
    p.way += p.w * p.change;
    p.end = p.from + p.way;
  }
  halo.reverse_add(0, change.data());
  for (int s = 0; s < halo.n_owned(); s++) {
    way[s].x += w_solver[s] * change[s][0];
    way[s].y += w_solver[s] * change[s][1];
    way[s].z += w_solver[s] * change[s][2];
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
  const Touch touched =
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
    if (p.touched) p.velocity = p.way / dt;
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
   behind the solver: the guarantee
------------------------------------------------------------------------- */

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
  halo.forward_places(0, start.data(), update->dt);
  halo.forward_places(0, end.data());
}

// The particle that is deepest below its gap in each pass is put back to it, alone.  One that was too
// near before the step gets a part of the way back, in the first pass.

bool ContactSurface::stop(bool recover)
{
  int mine = 0, particle = -1, triangle = -1;
  Touch deepest;
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
      deepest = Touch();
    }
    Touch touched = touch(sweep, sweep_of_triangle(t), rules->thickness, SLACK);
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

bool ContactSurface::is_deeper(const Touch &a, int triangle_a, const Touch &b, int triangle_b) const
{
  if (!(a.depth > 0.0)) return false;
  if (triangle_b < 0 || a.depth > b.depth * (1.0 + SEAM)) return true;
  return a.depth >= b.depth * (1.0 - SEAM) && element[triangle_a] < element[triangle_b];
}

// at least a part of the thickness, if something of it is missing; false if nothing is

bool ContactSurface::give_room(Touch &touched, const Vec3 &p, int t) const
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

void ContactSurface::remember(int i, int triangle, const Touch &touched)
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
    Touch touched;
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
   for the vertices of another mesh
------------------------------------------------------------------------- */

void ContactSurface::look_around()
{
  load_sweeps();
  set_boxes(2.0 * rules->thickness);
  found_at.clear();    // the boxes are others now
  change.assign(halo.n_slots(), Vec3::Zero());
}

std::array<Sweep, 3> ContactSurface::triangle_until(int t, double part) const
{
  std::array<Sweep, 3> sweep = sweep_of_triangle(t);
  for (Sweep &s : sweep) s.end = s.start + part * (s.end - s.start);
  return sweep;
}

Eigen::Vector3d ContactSurface::way_of(int t, const Vec3 &weight) const
{
  Vec3 way = Vec3::Zero();
  for (int q = 0; q < 3; q++) way += weight[q] * (end[triangles[t][q]] - start[triangles[t][q]]);
  return way;
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
    double mass, way[3], momentum[3];    // of the free members
    double held, held_way[3], held_velocity[3];    // number of the held ones, and sums over them
  };
  constexpr int SIZE = sizeof(Sum) / sizeof(double);
  std::vector<Sum> mine(zones.size(), Sum{}), all(zones.size());
  std::vector<std::pair<int, int>> members;    // atom and zone
  for (int i = 0; i < atom->nlocal; i++)
    if (const int z = zones.of(atom->tag[i]); z >= 0) members.emplace_back(i, z);
  const auto is_held = [&](int i) { return mesh->has_vertex(i) && mesh->inverse_mass(i) == 0.0; };

  for (const auto &[i, z] : members) {
    const Vec3 way = sweep_of(i).end - sweep_of(i).start;
    const double m = atom_mass(atom, i);
    (is_held(i) ? mine[z].held : mine[z].mass) += is_held(i) ? 1.0 : m;
    for (int d = 0; d < 3; d++) {
      (is_held(i) ? mine[z].held_way : mine[z].way)[d] += is_held(i) ? way[d] : m * way[d];
      (is_held(i) ? mine[z].held_velocity : mine[z].momentum)[d] += is_held(i) ? atom->v[i][d]
                                                                               : m * atom->v[i][d];
    }
  }
  MPI_Allreduce(mine.data(), all.data(), SIZE * zones.size(), MPI_DOUBLE, MPI_SUM, world);

  for (const auto &[i, z] : members) {
    const Sum &sum = all[z];
    const Sweep sweep = sweep_of(i);
    Vec3 way, velocity, lost;
    for (int d = 0; d < 3; d++) {
      way[d] = sum.held > 0.0 ? sum.held_way[d] / sum.held : sum.way[d] / sum.mass;
      velocity[d] = sum.held > 0.0 ? sum.held_velocity[d] / sum.held : sum.momentum[d] / sum.mass;
      lost[d] = sum.momentum[d] - sum.mass * velocity[d];
    }
    if (!is_held(i)) {
      for (int d = 0; d < 3; d++) {
        atom->x[i][d] = sweep.start[d] + way[d];
        atom->v[i][d] = velocity[d];
      }
      continue;
    }
    const double apart = (sweep.end - sweep.start - way).norm();
    if (apart > rules->thickness)
      error->one(FLERR,
                 "{}: held vertex {} moves {} away from others in one step and crushes what is "
                 "between them: move pins slower or lower the time step",
                 label, atom->tag[i], apart);
    take_held(i, lost / sum.held);
  }
}

double ContactSurface::memory_usage() const
{
  return halo.memory_usage() +
      static_cast<double>(
             sizeof(Vec3) *
                 (start.capacity() + end.capacity() + change.capacity() + shares.capacity() +
                  from.capacity() + received.capacity() + end_then.capacity()) +
             sizeof(double) * (w.capacity() + w_solver.capacity()) +
             sizeof(Box) * (boxes.capacity() + swept.capacity()) +
             sizeof(Particle) * particles.capacity() + sizeof(Pair) * pairs.capacity() +
             sizeof(near[0]) * near.capacity() + sizeof(Vec3) * found_at.capacity());
}
