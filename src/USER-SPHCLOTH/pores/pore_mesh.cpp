// SPDX-License-Identifier: GPL-2.0-or-later
// Finds particles in the layers before porous triangles, and what slows them.

#include "pores/pore_mesh.h"

#include "atom.h"
#include "lammps_util/atom_tools.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

void PoreMesh::rebuild()
{
  mesh.update_candidates(neighbor->skin, [this](int i) {
    return fluid.state->is_fluid(atom->type[i]) ? fluid.width(atom->type[i]) : 0.0;
  });
  for (std::vector<Vec3> *each : {&pushed, &start, &velocity, &passing, &filled, &part})
    each->assign(set->halo.n_slots(), Vec3::Zero());
  find_areas();
}

// Of owned vertices, whose triangles are all here.

void PoreMesh::find_areas()
{
  area.assign(set->halo.n_owned(), 0.0);
  for (int t = 0; t < static_cast<int>(set->triangles.size()); t++) {
    const auto &[a, b, c] = set->triangles[t];
    const Vec3 origin = set->position(a);
    const double third = (set->position(b) - origin).cross(set->position(c) - origin).norm() / 6.0;
    for (const int s : set->triangles[t])
      if (!set->halo.is_ghost(s)) area[s] += third;
  }
}

// Particles have moved when this is called, held vertices perhaps, free ones and ghosts not: only
// the start of the step is one time for all of them.

void PoreMesh::load_start()
{
  VertexHalo &halo = set->halo;
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    start[s] = set->sweep_of(i).start;
    velocity[s] = Vec3(atom->v[i]);
  }
  halo.forward_positions(0, start.data(), update->dt);
  halo.forward_velocities(0, velocity.data());
}

void PoreMesh::find(double *flow)
{
  load_start();
  closest_points.clear();
  mesh.find_closest_points(0, closest_points, start,
                           [this](int i) { return set->sweep_of(i).start; });
  const auto elsewhere = [&](const ClosestPoint &at) {
    const int triangle = set->element[at.triangle];
    return !is_porous(triangle) || ends.has(triangle, at.weight);
  };
  closest_points.erase(std::remove_if(closest_points.begin(), closest_points.end(), elsewhere),
                       closest_points.end());
  follow_flow(flow);
  pairs.clear();
  for (const ClosestPoint &at : closest_points) add_pair(at);
}

int PoreMesh::side_of(const ClosestPoint &at) const
{
  const auto &[a, b, c] = at.vertices;
  const Vec3 normal = (start[b] - start[a]).cross(start[c] - start[a]);
  return normal.dot(at.normal) > 0.0 ? 1 : -1;
}

double PoreMesh::share_of(const ClosestPoint &at) const
{
  return share_in_layer(at.distance, fluid.width(atom->type[at.particle]));
}

PoreMesh::Vec3 PoreMesh::relative_velocity(const ClosestPoint &at) const
{
  Vec3 u = Vec3(atom->v[at.particle]);
  for (int q = 0; q < 3; q++) u -= at.weight[q] * velocity[at.vertices[q]];
  return u;
}

// of each vertex, by the particles beside it

void PoreMesh::follow_flow(double *flow)
{
  VertexHalo &halo = set->halo;
  for (std::vector<Vec3> *each : {&passing, &filled})
    std::fill(each->begin(), each->end(), Vec3::Zero());
  for (const ClosestPoint &at : closest_points) {
    const int i = at.particle, type = atom->type[i], side = side_of(at);
    const double share = share_of(at);
    if (share == 0.0) continue;
    const double volume = atom_mass(atom, i) / fluid.density(type) * share;
    const double up = side * update->dt * relative_velocity(at).dot(at.normal);
    for (int q = 0; q < 3; q++) {
      passing[at.vertices[q]] += at.weight[q] * share * Vec3(up, fluid.width(type), 1.0);
      filled[at.vertices[q]][side > 0 ? 0 : 1] += at.weight[q] * volume;
    }
  }
  halo.reverse_add(0, passing.data());
  halo.reverse_add(0, filled.data());
  for (int s = 0; s < halo.n_owned(); s++) {
    const Vec3 &sum = passing[s];
    double &of_vertex = flow[halo.atom_of(s)];
    if (sum[2] > 0.0) of_vertex = next_flow(of_vertex, sum[0] / sum[2], sum[1] / sum[2]);
    const double by = area[s] > 0.0 ? 1.0 / area[s] : 0.0;
    const PartOfLayers parts = part_of_layers(of_vertex, by * filled[s][0], by * filled[s][1]);
    part[s] = Vec3(parts.above, parts.below, 0.0);
  }
  halo.forward(0, part.data());
}

// A net's resistance is that at the velocities of the start of the step.

void PoreMesh::add_pair(const ClosestPoint &at)
{
  const int i = at.particle, type = atom->type[i];
  const int side = side_of(at) > 0 ? 0 : 1;
  double share = 0.0;
  for (int q = 0; q < 3; q++) share += at.weight[q] * part[at.vertices[q]][side];
  share *= share_of(at);
  if (!(share > 0.0)) return;
  const PoreLaw &law = fluid.laws[type];
  const double mass = atom_mass(atom, i), rho0 = fluid.density(type), by = mass / rho0 * share;
  PoreDrag drag{law.darcy, 0.0};
  if (!law.screen.empty()) {
    const Vec3 u = relative_velocity(at);
    const double across = u.dot(at.normal);
    const PoreDrag of_net = law.screen.drag(across, (u - across * at.normal).norm(), rho0);
    drag = {drag.across + of_net.across, of_net.along};
  }
  pairs.push_back({i,
                   at.vertices,
                   at.weight,
                   -at.normal,
                   mass,
                   share * fluid.width(type),
                   {by * drag.across, by * drag.along},
                   by * law.forchheimer});
}

// Implicit in the velocity of the end of the step: at any resistance a particle slows down and does
// not turn around.  Its displacement is that of the lower velocity.

PoreMesh::Vec3 PoreMesh::slow_down(double &lost)
{
  Vec3 sum = Vec3::Zero();
  const double dt = update->dt;
  for (const PorePair &pair : pairs) {
    double *const v = atom->v[pair.particle], *const x = atom->x[pair.particle];
    Vec3 u = Vec3(v);
    for (int q = 0; q < 3; q++) u -= pair.weight[q] * velocity[pair.vertices[q]];
    const Vec3 change = pair.taken_from(u, dt, 1.0 / pair.mass), impulse = pair.mass * change;
    for (int d = 0; d < 3; d++) {
      v[d] -= change[d];
      x[d] -= dt * change[d];
    }
    sum += impulse;
    lost += impulse.dot(u - 0.5 * change);
    for (int q = 0; q < 3; q++) pushed[pair.vertices[q]] += pair.weight[q] * impulse;
  }
  mesh.sum_up(pushed, [this](int i, const Vec3 &push) { set->mesh->push_held(i, push); });
  return sum;
}
