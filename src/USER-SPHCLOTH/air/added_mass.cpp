// SPDX-License-Identifier: GPL-2.0-or-later
// Splits what a vertex gets across the cloth with the air.

#include "air/added_mass.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "force.h"

#include <algorithm>

using namespace LAMMPS_NS;
using sphcloth::Vertex;

void AddedMass::rebuild()
{
  slot_in_solver.clear();
  int in_mesh = 0, n = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!mesh->mesh->has_vertex(i)) continue;
    if (in_mesh < mesh->halo.n_owned() && mesh->halo.atom_of(in_mesh) == i) {
      slot_in_solver.push_back(n);
      in_mesh++;
    }
    n++;
  }
  share.assign(n, 0.0);
  for (std::vector<Vec3> *each : {&normal, &received, &before, &expected})
    each->assign(n, Vec3::Zero());
}

void AddedMass::find_shares()
{
  mesh->find_dry_areas(area);
  for (int s = 0; s < mesh->halo.n_owned(); s++) {
    const double size = area[s].norm(), w = mesh->mesh->inverse_mass(mesh->halo.atom_of(s));
    const double of_air = areal * size * w;    // over the mass of the vertex
    share[slot_in_solver[s]] = of_air / (1.0 + of_air);
    normal[slot_in_solver[s]] = size > 0.0 ? Vec3(area[s] / size) : Vec3::Zero();
  }
}

// `end` is where velocities and forces would bring a vertex.

bool AddedMass::begin_step(const Vertex *start, const Vertex *end, double dt)
{
  std::fill(received.begin(), received.end(), Vec3::Zero());
  for (std::size_t k = 0; k < slot_in_solver.size(); k++) {
    const int s = slot_in_solver[k], i = mesh->halo.atom_of(static_cast<int>(k));
    const Vec3 way(end[s].x - start[s].x, end[s].y - start[s].y, end[s].z - start[s].z);
    before[s] = way / dt - dt * force->ftm2v * mesh->mesh->inverse_mass(i) * Vec3(atom->f[i]);
  }
  return true;
}

void AddedMass::begin_substep(const Vertex *, const Vertex *, double dt)
{
  substep_dt = dt;
  for (const int s : slot_in_solver) expected[s] = dt * before[s];
}

void AddedMass::project(Vertex *displacement)
{
  for (const int s : slot_in_solver) {
    Vertex &d = displacement[s];
    if (share[s] == 0.0) continue;
    const Vec3 &n = normal[s];
    const Vec3 change = Vec3(d.x, d.y, d.z) - expected[s];
    const Vec3 kept_off = share[s] * change.dot(n) * n;
    d.x -= kept_off[0];
    d.y -= kept_off[1];
    d.z -= kept_off[2];
    expected[s] = Vec3(d.x, d.y, d.z);
    received[s] -= kept_off / (d.w * substep_dt);
  }
}

void AddedMass::end_substep(Vertex *v, double)
{
  for (const int s : slot_in_solver) before[s] = Vec3(v[s].x, v[s].y, v[s].z);
}

double AddedMass::bytes() const
{
  return sphcloth::bytes_of(slot_in_solver, share, normal, received, before, expected, area);
}
