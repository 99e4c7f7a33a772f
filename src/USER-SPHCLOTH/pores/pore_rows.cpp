// SPDX-License-Identifier: GPL-2.0-or-later
// In a projection all rows are solved at once.  A vertex that several particles push gives way to
// all of them: each takes it to be as light as it finds it if the others push with their shares,
// which they do where the flow is even.

#include "pores/pore_rows.h"

#include "atom.h"
#include "core/util/bytes.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

void PoreRows::rebuild()
{
  const int n = mesh.set->halo.n_slots();
  for (std::vector<Vec3> *each : {&displaced, &load, &push}) each->assign(n, Vec3::Zero());
  received.assign(mesh.set->halo.n_owned(), Vec3::Zero());
}

bool PoreRows::begin_step(const Vertex *, const Vertex *, double dt)
{
  const int mine = !mesh.pairs.empty();
  int any;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  present = any;
  if (!any) return false;
  step_impulse.setZero();
  step_lost = 0.0;
  rows.clear();
  mesh.set->find_drift(dt);
  for (const PorePair &pair : mesh.pairs) {
    const Sweep sweep = mesh.set->sweep_of(pair.particle);
    rows.emplace_back();
    rows.back().velocity = rows.back().velocity_before = (sweep.end - sweep.start) / dt;
  }
  share_masses();
  std::fill(received.begin(), received.end(), Vec3::Zero());
  return true;
}

void PoreRows::begin_substep(const Vertex *, const Vertex *, double dt)
{
  substep_dt = dt;
  for (Row &row : rows) row.correction.setZero();
}

void PoreRows::project(Vertex *displacement)
{
  load_displacements(displacement);
  std::fill(push.begin(), push.end(), Vec3::Zero());
  for (std::size_t k = 0; k < rows.size(); k++) solve(k);
  give(displacement);
}

void PoreRows::load_displacements(const Vertex *displacement)
{
  VertexHalo &halo = mesh.set->halo;
  for (int s = 0; s < halo.n_owned(); s++)
    displaced[s] = Vec3(displacement[s].x, displacement[s].y, displacement[s].z) +
        substep_dt * mesh.set->drift_of(s);
  halo.forward_displacements(0, displaced.data(), substep_dt);
}

void PoreRows::share_masses()
{
  VertexHalo &halo = mesh.set->halo;
  std::fill(load.begin(), load.end(), Vec3::Zero());
  for (const PorePair &pair : mesh.pairs)
    for (int q = 0; q < 3; q++) load[pair.vertices[q]][0] += pair.weight[q] * pair.share;
  halo.reverse_add(0, load.data());
  halo.forward(0, load.data());
  for (std::size_t k = 0; k < rows.size(); k++) {
    const PorePair &pair = mesh.pairs[k];
    rows[k].mobility = 1.0 / pair.mass;
    for (int q = 0; q < 3; q++) {
      const int s = pair.vertices[q];
      rows[k].mobility += pair.weight[q] * mesh.set->w_solver[s] * load[s][0] / pair.share;
    }
  }
}

void PoreRows::solve(std::size_t k)
{
  const PorePair &pair = mesh.pairs[k];
  Row &row = rows[k];
  row.relative = substep_dt * row.velocity + (row.mobility - 1.0 / pair.mass) * row.correction;
  for (int q = 0; q < 3; q++) row.relative -= pair.weight[q] * displaced[pair.vertices[q]];
  const Vec3 taken = pair.taken_from(row.relative / substep_dt, substep_dt, row.mobility);
  const Vec3 correction = substep_dt / row.mobility * taken;
  const Vec3 step = correction - row.correction;
  row.correction = correction;
  for (int q = 0; q < 3; q++) push[pair.vertices[q]] += pair.weight[q] * step;
}

void PoreRows::give(Vertex *displacement)
{
  VertexHalo &halo = mesh.set->halo;
  const std::vector<double> &w = mesh.set->w_solver;
  halo.reverse_add(0, push.data());
  for (int s = 0; s < halo.n_owned(); s++) {
    displacement[s].x += w[s] * push[s][0];
    displacement[s].y += w[s] * push[s][1];
    displacement[s].z += w[s] * push[s][2];
    received[s] += push[s] / substep_dt;
    step_impulse += push[s] / substep_dt;
  }
}

// Velocities of vertices follow from their displacements.

void PoreRows::end_substep(Vertex *, double dt)
{
  for (std::size_t k = 0; k < rows.size(); k++) {
    Row &row = rows[k];
    const Vec3 by = row.correction / mesh.pairs[k].mass;
    step_lost +=
        (row.relative - 0.5 * row.mobility * row.correction).dot(row.correction) / (dt * dt);
    row.offset += dt * (row.velocity - row.velocity_before) - by;
    row.velocity -= by / dt;
  }
}

void PoreRows::end_step()
{
  for (std::size_t k = 0; k < rows.size(); k++) {
    const Row &row = rows[k];
    const int i = mesh.pairs[k].particle;
    if (row.velocity != row.velocity_before) mesh.set->step_start.moved.push_back(i);
    for (int d = 0; d < 3; d++) {
      atom->x[i][d] += row.offset[d];
      atom->v[i][d] += row.velocity[d] - row.velocity_before[d];
    }
  }
}

double PoreRows::bytes() const { return bytes_of(rows, displaced, load, push, received); }
