// SPDX-License-Identifier: GPL-2.0-or-later
// Splits what a vertex gets across the cloth with the air.

#include "air/added_mass.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "force.h"

#include <cmath>

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
  layers.assign(n, Layer());
  both_masses.assign(n, 0.0);
}

void AddedMass::find_shares()
{
  mesh->find_dry_areas(area);
  for (int s = 0; s < mesh->halo.n_owned(); s++) {
    const int slot = slot_in_solver[s];
    const double size = area[s].norm(), w = mesh->mesh->inverse_mass(mesh->halo.atom_of(s));
    const double of_air = areal * size * w;    // over the mass of the vertex
    const double root = std::sqrt(of_air / (1.0 + of_air));
    layers[slot].across = root > 0.0 ? Vec3(root / size * area[s]) : Vec3::Zero();
    both_masses[slot] = root > 0.0 ? (1.0 + of_air) / w : 0.0;
  }
}

// `end` is where velocities and forces would bring a vertex.

bool AddedMass::begin_step(const Vertex *start, const Vertex *end, double dt)
{
  for (std::size_t k = 0; k < slot_in_solver.size(); k++) {
    const int s = slot_in_solver[k], i = mesh->halo.atom_of(static_cast<int>(k));
    const Vec3 way(end[s].x - start[s].x, end[s].y - start[s].y, end[s].z - start[s].z);
    const Vec3 kick = dt * force->ftm2v * mesh->mesh->inverse_mass(i) * Vec3(atom->f[i]);
    layers[s].speed = layers[s].across.dot(way / dt - kick);
    layers[s].gain = -layers[s].speed;
  }
  return true;
}

void AddedMass::begin_substep(const Vertex *, const Vertex *, double dt) { substep_dt = dt; }

void AddedMass::project(Vertex *displacement)
{
  const double dt = substep_dt, inv_dt = 1.0 / dt;
  Vertex *d = displacement;
  for (Layer &layer : layers) {
    const Vec3 &m = layer.across;
    const double share = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
    const double change = inv_dt * (m[0] * d->x + m[1] * d->y + m[2] * d->z) - layer.speed;
    const double withheld = dt * change;
    d->x -= withheld * m[0];
    d->y -= withheld * m[1];
    d->z -= withheld * m[2];
    layer.speed += (1.0 - share) * change;
    d++;
  }
}

void AddedMass::end_substep(Vertex *v, double)
{
  for (Layer &layer : layers) {
    const double next = layer.across.dot(Vec3(v->x, v->y, v->z));
    layer.gain += layer.speed - next;
    layer.speed = next;
    v++;
  }
}

double AddedMass::bytes() const
{
  return sphcloth::bytes_of(slot_in_solver, layers, both_masses, area);
}
