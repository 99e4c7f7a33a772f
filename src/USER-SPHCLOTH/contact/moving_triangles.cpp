// SPDX-License-Identifier: GPL-2.0-or-later
// Loads positions and inverse masses of a mesh for a step, and gives impulses back to atoms.

#include "contact/moving_triangles.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "force.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

MovingTriangles::MovingTriangles(LAMMPS *lmp_, ContactMesh *mesh_, const std::string &label_,
                                 int groupbits_, const ContactRules &rules_, ContactCounts &counts_,
                                 const ParticleColumns &last_positions_) :
    TriangleSet(lmp_, mesh_, label_), groupbits(groupbits_), rules(rules_), counts(counts_),
    last_positions(last_positions_)
{
}

void MovingTriangles::rebuild(double max_distance)
{
  TriangleSet::rebuild(max_distance);
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
}

void MovingTriangles::load_step()
{
  for (int s = 0; s < halo.n_owned(); s++) {
    const Sweep sweep = sweep_of(halo.atom_of(s));
    start[s] = sweep.start;
    end[s] = sweep.end;
  }
  halo.forward_positions(0, start.data(), update->dt);
  halo.forward_positions(0, end.data());
}

void MovingTriangles::load_positions()
{
  for (int s = 0; s < halo.n_slots(); s++) start[s] = end[s] = position(s);
}

// from where the last step has left it to where it is

Sweep MovingTriangles::sweep_of(int i) const
{
  const double *x = atom->x[i];
  const ParticleColumns &last = last_positions;
  return {Vec3(last[0][i], last[1][i], last[2][i]), Vec3(x[0], x[1], x[2])};
}

std::array<Sweep, 3> MovingTriangles::sweep_of_triangle(int t) const
{
  std::array<Sweep, 3> sweep;
  for (int q = 0; q < 3; q++) sweep[q] = {start[triangles[t][q]], end[triangles[t][q]]};
  return sweep;
}

ContactResult MovingTriangles::contact(const Sweep &p, int t, double slack) const
{
  return of_nearest(point_triangle_contact(p, sweep_of_triangle(t), rules.thickness, slack), p.end,
                    t);
}

ContactResult MovingTriangles::contact_since(const ContactStart &begin, const Sweep &p, int t) const
{
  const auto &[i, j, k] = triangles[t];
  const PointAndTriangle now{p.end, end[i], end[j], end[k]};
  const ContactResult found = begin.side * now.height > 0.0
      ? point_triangle_nearness(now, begin.side, begin.gap(rules.thickness), 0.0)
      : point_triangle_contact(p, sweep_of_triangle(t), rules.thickness, 0.0);
  return of_nearest(found, p.end, t);
}

// None if the point is nearer to another triangle, unless it passes through

ContactResult MovingTriangles::of_nearest(const ContactResult &found, const Vec3 &p, int t) const
{
  if (!found.hit || found.through) return found;
  Vec3 from_nearest = p;
  for (int q = 0; q < 3; q++) from_nearest -= found.weight[q] * end[triangles[t][q]];
  return is_nearer_to_another(t, found.weight, from_nearest) ? ContactResult() : found;
}

// At an edge: inwards in the other triangle.  At a vertex: along all edges that end there, of which
// those of the triangle itself lead away from the point.

double MovingTriangles::leaning_into_others(int t, const Vec3 &weight, const Vec3 &from_nearest,
                                            int slot_of_point) const
{
  std::array<int, 3> at{};    // the vertices of the edge, or the vertex
  int n = 0;
  for (int q = 0; q < 3; q++)
    if (weight[q] > 0.0) at[n++] = triangles[t][q];
  if (n == 3) return 0.0;
  const Vec3 a = end[at[0]];
  const Vec3 edge = n == 2 ? Vec3(end[at[1]] - a) : Vec3::Zero();
  double largest = 0.0;
  for (int k = first[at[0]]; k < first[at[0] + 1]; k++) {
    const std::array<int, 3> &other = triangles[incident[k]];
    if (n == 2 && std::find(other.begin(), other.end(), at[1]) == other.end()) continue;
    if (std::find(other.begin(), other.end(), slot_of_point) != other.end()) continue;
    for (int s : other) {
      if (s == at[0] || (n == 2 && s == at[1])) continue;
      Vec3 direction = end[s] - a;
      if (n == 2) direction -= edge.dot(direction) / edge.squaredNorm() * edge;
      largest = std::max(largest, leaning(direction, from_nearest));
    }
  }
  return largest > 0.0 ? largest / from_nearest.norm() : 0.0;
}

bool MovingTriangles::is_deeper(const ContactResult &a, int triangle_a, const ContactResult &b,
                                int triangle_b) const
{
  if (!(a.depth > 0.0)) return false;
  if (triangle_b < 0 || a.depth > b.depth * (1.0 + SEAM)) return true;
  return a.depth >= b.depth * (1.0 - SEAM) && element[triangle_a] < element[triangle_b];
}

void MovingTriangles::push_held(int i, const Vec3 &impulse)
{
  mesh->push_held(i, impulse);
  for (int d = 0; d < 3; d++) counts.impulse[d] += impulse[d] / force->ftm2v;
}

double MovingTriangles::memory_usage() const
{
  return halo.memory_usage() + bytes_of(first, incident, start, end, w, w_solver, moved);
}
