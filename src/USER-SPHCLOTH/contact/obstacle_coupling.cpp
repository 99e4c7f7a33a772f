// SPDX-License-Identifier: GPL-2.0-or-later
// Puts the vertices of a cloth back out of an obstacle, sweep by sweep.

#include "contact/obstacle_coupling.h"

#include "core/contact/contact_impulse.h"
#include "core/util/bytes.h"

using namespace LAMMPS_NS;
using namespace sphcloth;

static Eigen::Vector3d vector_of(const Vertex &v) { return {v.x, v.y, v.z}; }

static void add(Vertex &v, const Eigen::Vector3d &by)
{
  v.x += by[0];
  v.y += by[1];
  v.z += by[2];
}

bool ObstacleCoupling::begin_step(const Vertex *start, const Vertex *end, double dt)
{
  step_dt = dt;
  elapsed = 0.0;
  const int n_owned = cloth.halo.n_owned();
  received.assign(n_owned, Vec3::Zero());
  candidates.clear();
  contacts.clear();
  load_obstacle();
  for (int s = 0; s < n_owned; s++)
    if (start[s].w != 0.0) find_candidates(s, {vector_of(start[s]), vector_of(end[s])});
  int mine = !contacts.empty(), any = 0;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  return any;
}

void ObstacleCoupling::load_obstacle()
{
  obstacle.load_step();
  boxes.resize(obstacle.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); t++) boxes[t] = obstacle.swept_box(static_cast<int>(t));
  grid.build(boxes);
  impulse.assign(obstacle.halo.n_slots(), Vec3::Zero());
}

void ObstacleCoupling::find_candidates(int slot, const Sweep &sweep)
{
  const int first = static_cast<int>(candidates.size());
  Box box(sweep.start);
  box.extend(sweep.end);
  grid.query(box, [&](int t) {
    if (boxes[t].intersects(box)) candidates.push_back({t, obstacle.contact_start(sweep.start, t)});
  });
  if (static_cast<int>(candidates.size()) == first) return;
  contacts.push_back({});
  contacts.back().slot = slot;
  contacts.back().first = first;
  contacts.back().last = static_cast<int>(candidates.size());
  contacts.back().start = sweep.start;
}

void ObstacleCoupling::begin_substep(const Vertex *start, const Vertex *v, double dt)
{
  substep_start = start;
  elapsed += dt;
  for (VertexContact &c : contacts) {
    c.triangle = -1;
    c.correction = 0.0;
    c.velocity_before = vector_of(v[c.slot]);
  }
}

// The deepest first, as often as there are triangles near.

void ObstacleCoupling::project(Vertex *displacement)
{
  for (VertexContact &c : contacts) {
    Vertex &vertex = displacement[c.slot];
    const Vec3 from = vector_of(substep_start[c.slot]);
    for (int pass = c.first; pass < c.last; pass++) {
      ContactResult deepest;
      const int triangle = find_deepest(c, from + vector_of(vertex), deepest);
      if (triangle < 0) break;
      if (c.triangle < 0)
        c.speed_before =
            relative_velocity(c.velocity_before, triangle, deepest.weight).dot(deepest.normal);
      c.triangle = triangle;
      c.weight = deepest.weight;
      c.normal = deepest.normal;
      c.correction += deepest.depth;
      add(vertex, deepest.depth * deepest.normal);
    }
  }
}

// the triangle, or -1: the vertex is in none

int ObstacleCoupling::find_deepest(const VertexContact &c, const Vec3 &position,
                                   ContactResult &deepest) const
{
  int triangle = -1;
  for (int k = c.first; k < c.last; k++) {
    const auto &[t, begin] = candidates[k];
    const ContactResult contact =
        obstacle.contact_since(begin, {c.start, position}, t, elapsed / step_dt);
    if (!contact.hit || !obstacle.is_deeper(contact, t, deepest, triangle)) continue;
    deepest = contact;
    triangle = t;
  }
  return triangle;
}

Eigen::Vector3d ObstacleCoupling::relative_velocity(const Vec3 &of_vertex, int triangle,
                                                    const Vec3 &weight) const
{
  Vec3 displacement = Vec3::Zero();
  for (int q = 0; q < 3; q++) {
    const int s = obstacle.triangles[triangle][q];
    displacement += weight[q] * (obstacle.end[s] - obstacle.start[s]);
  }
  return of_vertex - displacement / step_dt;
}

void ObstacleCoupling::end_substep(Vertex *v, double dt)
{
  for (const VertexContact &c : contacts) {
    if (c.triangle < 0) continue;
    Vertex &vertex = v[c.slot];
    // per mass of the vertex
    const ContactMotion motion{relative_velocity(vector_of(vertex), c.triangle, c.weight), c.normal,
                               c.speed_before};
    const double so_far = c.correction / dt;
    const Vec3 by =
        contact_impulse(motion, {so_far}, obstacle.rules.restitution, obstacle.rules.friction);
    add(vertex, by);
    const Vec3 on_vertex = (so_far * c.normal + by) / vertex.w;
    received[c.slot] += on_vertex;
    for (int q = 0; q < 3; q++)
      impulse[obstacle.triangles[c.triangle][q]] += c.weight[q] * -on_vertex;
  }
}

void ObstacleCoupling::end_step()
{
  obstacle.halo.reverse_add(0, impulse.data());
  for (int s = 0; s < obstacle.halo.n_owned(); s++)
    if (!impulse[s].isZero(0.0)) obstacle.push_held(obstacle.halo.atom_of(s), impulse[s]);
}

double ObstacleCoupling::memory_usage() const
{
  return grid.bytes() + bytes_of(boxes, candidates, contacts, received, impulse);
}
