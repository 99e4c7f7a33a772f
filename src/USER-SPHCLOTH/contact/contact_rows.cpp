// SPDX-License-Identifier: GPL-2.0-or-later
// Projects contacts after each sweep: the constraint of no penetration in lines 24 to 28 of
// Algorithm 1.
//
// Which of many near pairs push: only the nearest of a place, whose direction does not lean into
// what borders on it, as in Chen et al., Offset geometric contact, ACM Trans. Graph. 44(4)
// (2025): flat layers push each other along their normals.

#include "contact/contact_rows.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "force.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

// of the thickness: by which two sides of cloth are expected to approach in a step, and vertices to
// move towards a particle.  Without their constraints they may go anywhere.
static constexpr double MAX_APPROACH = 1.0, MAX_STRIDE = 0.25;

// of the thickness: what cloth that is too near to cloth gets back in a step.  Among particles this
// comes behind the solver, where it is no velocity that heavy water would take up.
static constexpr double RECOVERY = 0.1;

// of the thickness: a vector that is shorter has no direction
static constexpr double ROUND_OFF = 1e-6;

// A pass moves loads from layer to layer.  Projections take more than one where more of a thickness
// is missing at the start of a step, or would be at its end without contact, than `MISSING`, and
// the most of them where it is all of it.
static constexpr double MISSING = 0.1;
static constexpr int MAX_PASSES = 40;
static constexpr double NONE = -1.0;

// Rows share the mass of a vertex, so that one pass over many at a vertex leaves a part of each gap
// missing, which heavy particles then get back behind the solver, as compression.
static constexpr int PASSES_OF_PARTICLES = 3;

// By which, of the thickness, the two sides of a row may move past one another before their closest
// points are found anew; until then its distance is along its normal.  At an edge or a vertex that
// turns, and rows that lean too far do not push.  And of the distance to contact.
static constexpr double MAX_SLIDE = 0.1, MAX_SLIDE_LEANING = 0.01, MAX_SLIDE_ASIDE = 0.05,
                        MAX_SLIDE_APART = 0.5;

bool ContactRows::begin_step(const Vertex *step_start, const Vertex *step_end, double dt)
{
  const WallTimer clock(mesh.counts.seconds);
  mesh.step_start.atoms_moved();
  mesh.forget_particles();
  find_drift(dt);
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    mesh.start[s] = before(s, step_start[s], dt);
    mesh.end[s] = vector_of(step_end[s]);
  }
  remaining = dt;
  mesh.halo.forward_positions(0, mesh.start.data(), remaining);
  mesh.halo.forward_positions(0, mesh.end.data());
  rows.clear();
  details.clear();
  active.clear();
  const double missing = find_rows_of_cloth();
  n_rows_of_cloth = rows.size();
  find_rows_of_particles();
  const double mine = rows.empty() ? NONE : missing;
  double all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  if (all == NONE) return false;
  passes = all < MISSING ? 1 : static_cast<int>(MAX_PASSES * std::min(all, 1.0));
  too_near = all > 0.0;
  points.begin_step(dt);
  start_rows();
  passes_of_active = of_particles.none() ? passes : std::max(passes, PASSES_OF_PARTICLES);
  find_corners();
  path = 0.0;
  std::fill(received.begin(), received.end(), Vec3::Zero());
  return true;
}

// With room for what the constraints of the cloth add to the motion.  What is missing of a
// thickness anywhere, as a share of it.

double ContactRows::find_rows_of_cloth()
{
  double missing = 0.0;
  of_cloth.update(MAX_APPROACH * rules.max_thickness());
  of_cloth.for_near(of_cloth.max_reach(), [&](const ContactPair &pair, const ClosestPoints &at) {
    const double distance = at.vector.norm();
    if (distance == 0.0) return;
    const bool joined = of_cloth.are_joined(pair, distance);
    const double thickness = rules.of(pair.meeting).thickness,
                 recovered = joined || !recovers_in_solver() ? 0.0 : RECOVERY * thickness;
    add_row(pair, at, std::min(thickness, distance + recovered));
    details.back().joined = joined;
    const ContactRow &row = rows.back();
    const double ahead = std::min(distance, row.relative(mesh.end).dot(row.normal));
    if (!joined) missing = std::max(missing, 1.0 - ahead / thickness);
    if (pair.meeting == Meeting::CLOTH_CLOTH && !joined)
      mesh.counts.cloth_gap = std::min(mesh.counts.cloth_gap, distance);
  });
  return missing;
}

// A particle that starts nearer than the thickness keeps the gap it has: contact removes approach
// and never pushes, so it cannot add energy.

void ContactRows::find_rows_of_particles()
{
  const double thickness = rules.of(Meeting::PARTICLE).thickness;
  slot_of_particle.clear();
  of_particles.update(MAX_STRIDE * thickness);
  of_particles.for_near(of_particles.max_reach(), [&](int i, int t, const ClosestPoints &at) {
    add_row(mesh.pair_of(i, t), at, std::min(thickness, at.vector.norm()));
    slot_of_particle.push_back(rows.back().slots[0]);
  });
}

// From a triangle in which a point lies its normal leads.

void ContactRows::add_row(const ContactPair &pair, const ClosestPoints &at, double gap)
{
  const double distance = at.vector.norm();
  const Vec3 normal = distance > 0.0 ? Vec3(at.vector / distance)
                                     : mesh.normal_at_start(pair.members[1]);
  rows.emplace_back(pair, at.weight, normal, gap);
  rows.back().distance = distance;
  details.push_back({pair.members});
}

// of a particle, whose direction leans by so much into other triangles: the nearest, or not

static double share_of_nearest(double leaning) { return leaning > SEAM ? 0.0 : 1.0; }

// Where vertices are at the start of the step, with masses as they are shared in it.  A triangle
// that is almost the nearest to a particle may become that, and counts.

void ContactRows::start_rows()
{
  mesh.end = mesh.start;
  masses.begin(mesh.end.size());
  for (int k = 0; k < static_cast<int>(rows.size()); k++) {
    ContactRow &row = rows[k];
    const ClosestPoints at{row.weight, row.distance * row.normal};
    if (row.meeting == Meeting::PARTICLE) {
      const double leaning = leaning_of(k, at);
      row.share = share_of_nearest(leaning);
      masses.count(row, share_of_leaning(leaning));
    } else {
      row.share = share(k, at);
      masses.count(row);
    }
  }
  masses.share(mesh.halo);
  awake_from.resize(rows.size());
  for (std::size_t k = 0; k < rows.size(); k++) {
    rows[k].mass = masses.of(rows[k], mesh.w_solver);
    awake_from[k] = asleep(rows[k], rows[k].distance, 0.0);
  }
}

double ContactRows::max_slide(const ContactRow &row) const
{
  const double of_thickness = row.share == 0.0 ? MAX_SLIDE_ASIDE
      : row.is_inside_both()                   ? MAX_SLIDE
                                               : MAX_SLIDE_LEANING;
  return std::max(of_thickness * rules_of(row).thickness,
                  MAX_SLIDE_APART * (row.distance - row.gap));
}

void ContactRows::begin_substep(const Vertex *vertices, const Vertex *v, double dt)
{
  const WallTimer clock(mesh.counts.seconds);
  substep_dt = dt;
  substep_start = vertices;
  const double until_end = remaining;
  remaining -= dt;
  active.clear();
  substep_begins = true;
  masses.clear_loads();
  if (rules.cloth.restitution > 0.0) load_velocities(v);
  if (rules.max_friction() > 0.0) {
    from = mesh.end;
    for (int s = 0; s < mesh.halo.n_owned(); s++) from[s] = before(s, vertices[s], until_end);
    mesh.halo.forward_positions(0, from.data(), until_end);
  }
  points.begin_substep(dt);
}

void ContactRows::project(Vertex *displacement)
{
  const WallTimer clock(mesh.counts.seconds);
  load_positions(displacement);
  for (int pass = 0; pass < passes_of_active; pass++) {
    masses.clear_impulses();
    wake(pass >= passes);
    for_ahead(awake, [this](int k) {
      if (!rows[k].in_corner) project_normal(k);
    });
    for (const Corner &which : corners) project_corner(which);
    if (pass == passes_of_active - 1 && rules.max_friction() > 0.0) project_friction();
    push_positions(displacement);
    if (pass < passes_of_active - 1) load_ghosts(Vec3::Zero());
    points.push(masses.impulse);
    points.measure_paths(Vec3::Zero());
  }
}

// vertices, by what rows of all ranks have pushed

void ContactRows::push_positions(Vertex *displacement)
{
  mesh.halo.reverse_add(0, masses.impulse.data());
  double max_sq = 0.0;
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    if (masses.impulse[s].isZero(0.0)) continue;
    const Vec3 way = mesh.w_solver[s] * masses.impulse[s];
    add(displacement[s], way);
    mesh.end[s] = end_of(s, displacement);
    received[s] += masses.impulse[s] / substep_dt;
    max_sq = std::max(max_sq, way.squaredNorm());
  }
  path += std::sqrt(max_sq);
}

// What all vertices have moved together, in about this direction before, does not count.

void ContactRows::load_positions(const Vertex *displacement)
{
  const Vec3 aside = substep_begins ? together : Vec3::Zero();
  Vec3 sum = Vec3::Zero();
  double max_sq = 0.0;
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    const Vec3 at = end_of(s, displacement), way = at - mesh.end[s];
    mesh.end[s] = at;
    sum += way;
    max_sq = std::max(max_sq, (way - aside).squaredNorm());
  }
  path += std::sqrt(max_sq);
  load_ghosts(aside);
  points.measure_paths(aside);
  if (substep_begins && mesh.halo.n_owned() > 0) together = sum / mesh.halo.n_owned();
  substep_begins = false;
}

void ContactRows::load_ghosts(const Vec3 &aside)
{
  const int owned = mesh.halo.n_owned(), n = mesh.halo.n_slots();
  ghosts_before.assign(mesh.end.begin() + owned, mesh.end.begin() + n);
  mesh.halo.forward_positions(0, mesh.end.data(), remaining);
  double max_sq = 0.0;
  for (int s = owned; s < n; s++)
    max_sq = std::max(max_sq, (mesh.end[s] - ghosts_before[s - owned] - aside).squaredNorm());
  path += std::sqrt(max_sq);
}

// A row that sleeps would not push, and would keep its closest points: the answer does not depend
// on what wakes it.  One that pushes has those of this substep: with older ones it would feed the
// vibration of vertices that are light beside what they bear.

bool ContactRows::measure(int k, Vec3 &vector)
{
  ContactRow &row = rows[k];
  vector = row.relative(mesh.end);
  double slid = (vector - row.distance * row.normal).norm();
  const bool starts = !row.active && slid > 0.0 && row.pushes(vector.dot(row.normal));
  if (slid > max_slide(row) || starts) {
    vector = find_closest_points(k);
    slid = 0.0;
  }
  const double distance = vector.dot(row.normal);
  if (row.pushes(distance)) return true;
  awake_from[k] = path_of(k) + asleep(row, distance, slid);
  return false;
}

// They turn little: where their direction turns round inside both, one side has passed the other.
// A point then passes one triangle, but with it all edges that end there: these count as they did.

ContactRows::Vec3 ContactRows::find_closest_points(int k)
{
  ContactRow &row = rows[k];
  const ClosestPoints at = closest_points(row.kind, row.of_slots(mesh.end));
  const bool passed = at.vector.dot(row.normal) < 0.0 && inside_both(row.kind, at);
  row.distance = (passed ? -1.0 : 1.0) * at.vector.norm();
  row.normal = normal_of(row, at);
  masses.add_load(row, -row.normal_correction);
  row.weight = at.weight;
  masses.add_load(row, row.normal_correction);
  if (!passed || row.kind == PairKind::POINT_TRIANGLE) row.share = passed ? 1.0 : share(k, at);
  row.mass = masses.of(row, mesh.w_solver);
  return at.vector;
}

// From inside a triangle it is that of the triangle, whatever the distance: next to it the vector
// is round-off.

ContactRows::Vec3 ContactRows::normal_of(const ContactRow &row, const ClosestPoints &at) const
{
  if (row.kind == PairKind::POINT_TRIANGLE && inside_both(row.kind, at)) {
    const Vec3 &a = mesh.end[row.slots[1]], &b = mesh.end[row.slots[2]],
               &c = mesh.end[row.slots[3]];
    const Vec3 normal = (b - a).cross(c - a).normalized();
    return normal.dot(row.normal) < 0.0 ? Vec3(-normal) : normal;
  }
  const bool is_round_off = std::fabs(row.distance) < ROUND_OFF * rules_of(row).thickness;
  return is_round_off ? row.normal : Vec3(at.vector / row.distance);
}

// How much it counts: not where another pair of the same surfaces is nearer, continuously for
// cloth.  What the two sides have in common does not count: where a cloth is folded it is always
// nearer.  A particle meets the nearest triangle only, so that a flat mesh is a plane to it.

double ContactRows::share(int k, const ClosestPoints &at) const
{
  const ContactRow &row = rows[k];
  const std::array<int, 2> &members = details[k].members;
  const auto &[p, q, a, b] = row.slots;
  if (row.meeting == Meeting::PARTICLE) return share_of_nearest(leaning_of(k, at));
  if (row.kind == PairKind::POINT_TRIANGLE) return share_of_leaning(leaning_of(k, at));
  const double of_edges = share_of_edges(row.of_slots(mesh.end), at);
  if (of_edges == 0.0) return 0.0;
  return of_edges * share_of_leaning(leaning_beside(members[0], -at.vector, {a, b})) *
      share_of_leaning(leaning_beside(members[1], at.vector, {p, q}));
}

// into a triangle at an edge whose third vertex is none of the other side

double ContactRows::leaning_beside(int e, const Vec3 &from_nearest,
                                   const std::array<int, 2> &other_side) const
{
  const auto &[a, b] = edges.edges[e];
  const Vec3 edge = mesh.end[b] - mesh.end[a];
  double largest = 0.0;
  for (int k = edges.first[e]; k < edges.first[e + 1]; k++) {
    const int c = edges.opposite[k];
    if (c == other_side[0] || c == other_side[1]) continue;
    Vec3 inward = mesh.end[c] - mesh.end[a];
    inward -= edge.dot(inward) / edge.squaredNorm() * edge;
    largest = std::max(largest, leaning(inward, from_nearest));
  }
  return largest > 0.0 ? largest / from_nearest.norm() : 0.0;
}

// Coulomb friction against the sliding of this substep.  The rows that push have all of the mass:
// what they leave of the sliding is never removed.

ContactRows::Vec3 ContactRows::rub(int k, const Vec3 &slipped)
{
  const ContactRow &row = rows[k];
  if (rules_of(row).friction == 0.0) return Vec3::Zero();
  Vec3 &correction = details[k].friction_correction;
  const Vec3 sliding = slipped - slipped.dot(row.normal) * row.normal, before = correction;
  correction = clamp_length(before - masses.by_load(row, mesh.w_solver) * sliding,
                            rules_of(row).friction * row.normal_correction);
  return correction - before;
}

void ContactRows::end_step()
{
  const WallTimer clock(mesh.counts.seconds);
  points.end_step(atom);
  push_held();
  if (too_near && !recovers_in_solver()) recover_gaps();
}

void ContactRows::push_held() const
{
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    if (mesh.w[s] > 0.0 || received[s].isZero(0.0)) continue;
    for (int d = 0; d < 3; d++) mesh.counts.impulse[d] += received[s][d] / force->ftm2v;
    if (edges.is_obstacle(s)) mesh.mesh->push_held(mesh.halo.atom_of(s), received[s]);
  }
}

// of cloth, without velocity

void ContactRows::recover_gaps()
{
  for (int s = 0; s < mesh.halo.n_owned(); s++) mesh.end[s] = mesh.position(s);
  mesh.halo.forward_positions(0, mesh.end.data());
  find_missing_gaps();
  masses.share(mesh.halo);
  masses.clear_impulses();
  for (const int k : awake) {
    const ContactRow &row = rows[k];
    const double thickness = rules_of(row).thickness,
                 step = std::min(thickness - row.distance, RECOVERY * thickness);
    masses.apply(row, step * masses.of(row, mesh.w) * row.normal);
  }
  mesh.halo.reverse_add(0, masses.impulse.data());
  for (int s = 0; s < mesh.halo.n_owned(); s++)
    for (int d = 0; d < 3; d++)
      atom->x[mesh.halo.atom_of(s)][d] += mesh.w[s] * masses.impulse[s][d];
}

// Which rows sleep does not matter.

void ContactRows::find_missing_gaps()
{
  awake.clear();
  masses.begin(mesh.end.size());
  for (std::size_t n = 0; n < n_rows_of_cloth; n++) {
    const int k = static_cast<int>(n);
    const double thickness = rules_of(rows[k]).thickness;
    if (details[k].joined || rows[k].distance - path_of(k) >= thickness) continue;
    find_closest_points(k);
    if (rows[k].share == 0.0 || rows[k].distance >= thickness) continue;
    awake.push_back(k);
    masses.count(rows[k]);
  }
}

double ContactRows::memory_usage() const
{
  return masses.bytes() + points.bytes() +
      bytes_of(rows, slot_of_particle, details, awake_from, awake, active, from, ghosts_before,
               velocity, received, corners, corner.rows);
}
