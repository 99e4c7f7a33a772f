// SPDX-License-Identifier: GPL-2.0-or-later
// Reactions of pins, and impulses on attached vertices, from the multipliers of (7) and (8) there.

#include "cloth/holder_forces.h"

#include "atom.h"
#include "core/pbd/constraint_errors.h"
#include "force.h"
#include "update.h"

#include <array>

using namespace LAMMPS_NS;
using namespace sphcloth;

// Share of the gap which is closed in a step.  A quarter damps any oscillation between the body and
// what holds it within a few steps, whatever their masses; with 1 it would go on for ever.
static constexpr double CLOSED = 0.25;

void HolderForces::want()
{
  if (!wanted()) columns.create(N_COLUMNS, atom->nmax);
}

void HolderForces::load_attached(int s)
{
  const Vec3 gap = vector_of(GAP, vertices.halo.atom_of(s));
  Vertex &start = vertices.start[s];
  start = {start.x - gap[0], start.y - gap[1], start.z - gap[2], vertices.p[s].w};
  vertices.v[s] = velocity_of_attached(s);
}

Vertex HolderForces::velocity_of_attached(int s) const
{
  const int i = vertices.halo.atom_of(s);
  const double *u = atom->v[i];
  const Vec3 gap = vector_of(GAP, i);
  const double by = CLOSED / update->dt;
  return {u[0] + by * gap[0], u[1] + by * gap[1], u[2] + by * gap[2], vertices.p[s].w};
}

// A pin carries what acts on it, in addition to the pull of its constraints.

void HolderForces::begin_step()
{
  for (int s = 0; s < vertices.halo.n_owned(); s++) {
    const int i = vertices.halo.atom_of(s);
    for (int d = 0; d < 3; d++)
      if (vertices.p[s].w == 0.0) columns[FORCE + d][i] = atom->f[i][d];
  }
}

template <std::size_t N>
void HolderForces::add_pull(const Constraints<N> &c, const Vertex *start, double dt, int substeps)
{
  const double by = 1.0 / (dt * dt * force->ftm2v * substeps);
  for_each_held(c, vertices.p.data(), start, [&](int s, const Vec3 &gradient) {
    if (vertices.halo.is_ghost(s)) return;
    const int i = vertices.halo.atom_of(s);
    for (int d = 0; d < 3; d++) columns[FORCE + d][i] += by * gradient[d];
  });
}

template void HolderForces::add_pull(const Constraints<2> &, const Vertex *, double, int);
template void HolderForces::add_pull(const Constraints<4> &, const Vertex *, double, int);

// An attached vertex took part with its own mass: what it gained is the body's, from now on.

void HolderForces::end_step()
{
  for (int s : vertices.attached) {
    const int i = vertices.halo.atom_of(s);
    const Vertex &p = vertices.p[s], &v = vertices.v[s];
    const double by = 1.0 / (p.w * update->dt * force->ftm2v);
    const Vertex was = velocity_of_attached(s);
    const std::array<double, N_COLUMNS> now{by * (v.x - was.x),  by * (v.y - was.y),
                                            by * (v.z - was.z),  atom->x[i][0] - p.x,
                                            atom->x[i][1] - p.y, atom->x[i][2] - p.z};
    columns.unpack(i, now.data());
  }
}

void HolderForces::add_impulse(int i, const Vec3 &impulse)
{
  if (!wanted()) return;
  for (int d = 0; d < 3; d++) columns[FORCE + d][i] += impulse[d] / (update->dt * force->ftm2v);
}
