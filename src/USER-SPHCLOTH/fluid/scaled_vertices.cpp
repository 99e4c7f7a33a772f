// SPDX-License-Identifier: GPL-2.0-or-later
// Splits what forces and constraints give to a vertex with the fluid around it.

#include "fluid/scaled_vertices.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "fluid/fluid_state.h"
#include "force.h"

using namespace LAMMPS_NS;
using namespace sphcloth;

void ScaledVertices::init()
{
  FluidState *fluid = FluidState::find(force);
  scaled = fluid ? &fluid->scaled_mass() : nullptr;
}

bool ScaledVertices::on() const { return scaled && scaled->on(); }

void ScaledVertices::scale_forces(double dt, const std::function<double(int)> &part_of_step)
{
  step_dt = dt;
  scaled->find_kicks(dt);
  rows.clear();
  row_of_slot.assign(vertices.halo.n_owned(), -1);
  for (int s = 0; s < vertices.halo.n_owned(); s++) {
    const int i = vertices.halo.atom_of(s), n = scaled->row(i);
    const double w = vertices.inverse_mass[s];
    if (n < 0 || w == 0.0) continue;
    row_of_slot[s] = static_cast<int>(rows.size());
    const MassScaling mass(scaled->stiffness(n), w, dt);
    const double by = dt * force->ftm2v * w;
    auto f = Vec3::Map(atom->f[i]);
    const Vec3 change = mass.scaled(by * f, scaled->carried(n, dt));
    f = change / by;
    const double part = part_of_step(s);
    rows.push_back({s, n, mass, part, part * change, Vec3::Zero(), Vec3::Zero()});
  }
}

void ScaledVertices::begin_substep(const Vertex *, const Vertex *v, double dt)
{
  substep_dt = dt;
  for (Row &row : rows) row.expected = dt * Vec3(v[row.slot].x, v[row.slot].y, v[row.slot].z);
}

void ScaledVertices::project(Vertex *displacement)
{
  for (Row &row : rows) {
    Vertex &d = displacement[row.slot];
    const Vec3 by_constraints = Vec3(d.x, d.y, d.z) - row.expected,
               kept = row.mass.scaled(by_constraints);
    row.expected += kept;
    row.change += kept / substep_dt;
    row.received -= (by_constraints - kept) / (d.w * substep_dt);
    d.x = row.expected[0];
    d.y = row.expected[1];
    d.z = row.expected[2];
  }
}

void ScaledVertices::move_fluid()
{
  for (const Row &row : rows) scaled->give(row.number, {row.change, row.part_of_step}, step_dt);
  scaled->move_fluid(step_dt);
}

double ScaledVertices::bytes() const { return bytes_of(row_of_slot, rows); }
