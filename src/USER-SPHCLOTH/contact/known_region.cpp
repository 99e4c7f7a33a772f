// SPDX-License-Identifier: GPL-2.0-or-later
// Which sweeps stay where all triangles are known.

#include "contact/known_region.h"

#include "atom.h"
#include "domain.h"
#include "lammps_util/rank_error.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using sphcloth::Sweep;

void KnownRegion::rebuild()
{
  bounded = ghosts.matters() && mesh.has_triangles();
  if (!bounded) return;
  constexpr double INFINITE = std::numeric_limits<double>::infinity();
  const bool tilted = domain->triclinic;
  const double *h_inv = domain->h_inv;
  unit = {1.0, 1.0, 1.0};
  if (tilted)
    unit = {std::hypot(h_inv[0], h_inv[5], h_inv[4]), std::hypot(h_inv[1], h_inv[3]), h_inv[2]};

  // lowest and highest vertex, the longest edge
  std::array<double, 7> here, all;
  here.fill(-INFINITE);
  vertices_then.resize(mesh.halo.n_owned());
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    vertices_then[s] = mesh.position(s);
    const Vec3 x = in_box(vertices_then[s]);
    for (int d = 0; d < 3; d++) {
      here[d] = std::max(here[d], -x[d]);
      here[3 + d] = std::max(here[3 + d], x[d]);
    }
  }
  here[6] = mesh.longest_edge_here();
  MPI_Allreduce(here.data(), all.data(), 7, MPI_DOUBLE, MPI_MAX, world);
  longest_edge = all[6];
  reach = ghosts.reach();

  const double *sublo = tilted ? domain->sublo_lamda : domain->sublo;
  const double *subhi = tilted ? domain->subhi_lamda : domain->subhi;
  const double *boxlo = tilted ? domain->boxlo_lamda : domain->boxlo;
  const double *boxhi = tilted ? domain->boxhi_lamda : domain->boxhi;
  for (int d = 0; d < 3; d++) {
    const bool open = !domain->periodicity[d];
    period[d] = open ? 0.0 : boxhi[d] - boxlo[d];
    known[d] = {open && sublo[d] <= boxlo[d] ? -INFINITE : sublo[d] - unit[d] * reach,
                open && subhi[d] >= boxhi[d] ? INFINITE : subhi[d] + unit[d] * reach};
    if (d == 2 && domain->dimension == 2) known[d] = {-INFINITE, INFINITE};
    occupied[d] = {-all[d], all[3 + d]};
  }
}

Eigen::Vector3d KnownRegion::in_box(const Vec3 &x) const
{
  if (!domain->triclinic) return x;
  double from[3] = {x[0], x[1], x[2]}, to[3];
  domain->x2lamda(from, to);
  return {to[0], to[1], to[2]};
}

double KnownRegion::max_vertex_displacement() const
{
  return bounded ? mesh.max_displacement(vertices_then) : 0.0;
}

// A triangle that comes near a sweep had its vertices, at the list build, within the displacement
// of vertices, the thickness and an edge.

void KnownRegion::check(double vertex_displacement) const
{
  if (!bounded) return;
  const double near = mesh.rules.thickness + vertex_displacement, margin = near + longest_edge;
  const double path = mesh.step_start.longest_path() + mesh.step_start.longest_sweep();
  if (path + margin <= reach) return;
  const std::array<Interval, 3> all = around_sweeps();
  if (missing({all[0].low, all[1].low, all[2].low}, {all[0].high, all[1].high, all[2].high},
              margin) == 0.0)
    return;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & mesh.groupbits)) continue;
    const Sweep sweep = mesh.sweep_of(i);
    const Vec3 from = in_box(sweep.start), to = in_box(sweep.end);
    const Vec3 low = from.cwiseMin(to), high = from.cwiseMax(to);
    const double unknown = missing(low, high, margin);
    if (unknown == 0.0 || !may_meet_mesh(low, high, near)) continue;
    rank_error(lmp, FLERR,
               "{}: particle {} moves by {:.6g} in step {}, vertices by up to {:.6g} since the "
               "last list build: farther than ghosts let its rank see triangles; lower the time "
               "step, or raise the ghost cutoff {:.6g} to {:.6g} with 'comm_modify cutoff'",
               mesh.label, atom->tag[i], (sweep.end - sweep.start).norm(), update->ntimestep,
               vertex_displacement, reach, reach + unknown);
  }
}

// Of all of them, which mostly stay where triangles are known: loops without branches.

std::array<KnownRegion::Interval, 3> KnownRegion::around_sweeps() const
{
  constexpr double INFINITE = std::numeric_limits<double>::infinity();
  const int n = atom->nlocal, groupbits = mesh.groupbits, *const mask = atom->mask;
  const double *const x = n > 0 ? atom->x[0] : nullptr;
  const ParticleColumns &last = mesh.step_start.positions;
  const double *const x0 = last[0], *const y0 = last[1], *const z0 = last[2];
  const Vec3 origin = in_box(Vec3::Zero()),
             along[3] = {in_box(Vec3::UnitX()) - origin, in_box(Vec3::UnitY()) - origin,
                         in_box(Vec3::UnitZ()) - origin};
  std::array<Interval, 3> around;
  for (int d = 0; d < 3; d++) {
    const double ax = along[0][d], ay = along[1][d], az = along[2][d];
    double low = INFINITE, high = -INFINITE;
#pragma omp simd reduction(min : low) reduction(max : high)
    for (int i = 0; i < n; i++) {
      const bool collides = (mask[i] & groupbits) != 0;
      const double from = ax * x0[i] + ay * y0[i] + az * z0[i],
                   to = ax * x[3 * i] + ay * x[3 * i + 1] + az * x[3 * i + 2];
      low = std::min(low, collides ? std::min(from, to) : INFINITE);
      high = std::max(high, collides ? std::max(from, to) : -INFINITE);
    }
    around[d] = {origin[d] + low, origin[d] + high};
  }
  return around;
}

// how much farther ghosts would have to reach

double KnownRegion::missing(const Vec3 &low, const Vec3 &high, double margin) const
{
  double longest = 0.0;
  for (int d = 0; d < 3; d++)
    longest = std::max({longest, (known[d].low - low[d]) / unit[d] + margin,
                        (high[d] - known[d].high) / unit[d] + margin});
  return longest;
}

// or an image of it

bool KnownRegion::may_meet_mesh(const Vec3 &low, const Vec3 &high, double margin) const
{
  for (int d = 0; d < 3; d++) {
    const double from = low[d] - occupied[d].high - unit[d] * margin,
                 to = high[d] - occupied[d].low + unit[d] * margin;
    const bool meets = period[d] == 0.0 ? from <= 0.0 && to >= 0.0
                                        : std::ceil(from / period[d]) <= std::floor(to / period[d]);
    if (!meets) return false;
  }
  return true;
}
