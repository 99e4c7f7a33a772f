#include "contact/obstacle.h"

#include "atom.h"
#include "fix_pbd_cloth.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

bool Obstacle::has_vertex(int i) const { return atom->mask[i] & groupbit; }

void Obstacle::push_held(int i, const Eigen::Vector3d &impulse)
{
  for (int d = 0; d < 3; d++) pushes[i][d] += impulse[d];
}

/* ---------------------------------------------------------------------- */

static Eigen::Vector3d vector_of(const Vertex &v) { return {v.x, v.y, v.z}; }

bool ObstacleCoupling::begin_step(const Vertex *start, const Vertex *end, double dt)
{
  step_dt = dt;
  elapsed = 0.0;
  received.assign(cloth->n_owned(), Vec3::Zero());
  near.clear();
  meetings.clear();
  surface->look_around();
  for (int s = 0; s < cloth->n_owned(); s++) {
    if (start[s].w == 0.0) continue;
    const Sweep sweep{vector_of(start[s]), vector_of(end[s])};
    const int first = static_cast<int>(near.size());
    surface->for_triangles_near(sweep, [this](int t) { near.push_back(t); });
    if (static_cast<int>(near.size()) == first) continue;
    meetings.push_back({});
    meetings.back().slot = s;
    meetings.back().first = first;
    meetings.back().last = static_cast<int>(near.size());
    meetings.back().start = sweep.start;
  }
  int mine = !meetings.empty(), any = 0;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  return any;
}

void ObstacleCoupling::begin_substep(const Vertex *start, const Vertex *v, double dt)
{
  substep_start = start;
  elapsed += dt;
  for (Meeting &m : meetings) {
    m.triangle = -1;
    m.push = 0.0;
    // of the vertex alone, until it is known what it meets
    m.weight = vector_of(v[m.slot]);
  }
}

// The deepest first, as often as there are triangles near.

void ObstacleCoupling::project(Vertex *displacement)
{
  for (Meeting &m : meetings) {
    Vertex &vertex = displacement[m.slot];
    const Vec3 from = vector_of(substep_start[m.slot]);
    for (int pass = m.first; pass < m.last; pass++) {
      ContactResult deepest;
      int triangle = -1;
      for (int k = m.first; k < m.last; k++) {
        const ContactResult touched =
            touch({m.start, from + vector_of(vertex)},
                  surface->triangle_until(near[k], elapsed / step_dt), rules->thickness, 0.0);
        if (!touched.hit || !surface->is_deeper(touched, near[k], deepest, triangle)) continue;
        deepest = touched;
        triangle = near[k];
      }
      if (triangle < 0) break;
      if (m.triangle < 0) {
        Meeting before = m;
        before.triangle = triangle;
        before.weight = deepest.weight;
        const Vertex old{m.weight[0], m.weight[1], m.weight[2], 0.0};
        m.speed_before = velocity_from(before, old).dot(deepest.normal);
      }
      m.triangle = triangle;
      m.weight = deepest.weight;
      m.normal = deepest.normal;
      m.push += deepest.depth;
      vertex.x += deepest.depth * deepest.normal[0];
      vertex.y += deepest.depth * deepest.normal[1];
      vertex.z += deepest.depth * deepest.normal[2];
    }
  }
}

// of a vertex with velocity v from the triangle

Eigen::Vector3d ObstacleCoupling::velocity_from(const Meeting &m, const Vertex &v) const
{
  return vector_of(v) - surface->displacement_of(m.triangle, m.weight) / step_dt;
}

// as ContactSurface::part()

void ObstacleCoupling::end_substep(Vertex *v, double dt)
{
  for (Meeting &m : meetings) {
    if (m.triangle < 0) continue;
    Vertex &vertex = v[m.slot];
    const Vec3 velocity = velocity_from(m, vertex);
    const double pushed = m.push / dt, speed = velocity.dot(m.normal);
    const double wanted = rules->restitution * std::max(0.0, -m.speed_before);
    const double step = std::max(wanted - speed, -pushed);
    const Vec3 sliding = velocity - speed * m.normal;
    const Vec3 by = step * m.normal - at_most(sliding, rules->friction * (pushed + step));
    vertex.x += by[0];
    vertex.y += by[1];
    vertex.z += by[2];
    const Vec3 impulse = (pushed * m.normal + by) / vertex.w;
    received[m.slot] += impulse;
    surface->push_triangle(m.triangle, m.weight, -impulse);
  }
}

void ObstacleCoupling::end_step() { surface->hand_over_pushes(); }
