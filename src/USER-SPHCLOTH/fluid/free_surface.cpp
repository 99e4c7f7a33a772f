// SPDX-License-Identifier: GPL-2.0-or-later
// Density sums that are completed at free surfaces.

#include "fluid/free_surface.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fluid/fluid_boundary.h"
#include "fluid/sph_materials.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

void FreeSurface::begin_run()
{
  table.reset();
  factors.clear();
  alongs.clear();
  stiffenings.clear();
  turn.clear();
  if (!materials.completes_surfaces()) return;
  for (const FluidBoundary *boundary : find_fluid_boundaries(modify))
    if (!boundary->knows_gradients())
      error->all(
          FLERR,
          "pair_style sph/tait: surface is 'yes', but meshes with 'wall yes' complete sums on "
          "their own: use boundary particles or fix wall/sph instead, or 'surface no'");
  table.emplace(materials.wall_table());
  bend = with_kernel(materials.options.kernel, [&](auto kernel) {
    return bend_over_slope<decltype(kernel)>(domain->dimension);
  });
}

// Boundary particles have no turn.

void FreeSurface::begin_lists()
{
  if (!on()) return;
  factors.assign(atom->nmax, 1.0);
  alongs.assign(atom->nmax, 1.0);
  stiffenings.assign(atom->nmax, 1.0);
  turn.assign(3 * static_cast<std::size_t>(atom->nmax), 0.0);
}

void FreeSurface::complete(Fluid &core, const Particles &p,
                           const std::vector<FluidBoundary *> &boundaries,
                           const Bend &bend_of_lattice)
{
  core.sum_gradients(p, turn.data());
  core.for_active_fluid([&](int i, int type) {
    double *of = &turn[3 * i];
    for (FluidBoundary *boundary : boundaries) boundary->complete_gradient(i, of);
    const double length = std::sqrt(of[0] * of[0] + of[1] * of[1] + of[2] * of[2]);
    const double support = materials.support(type), x = support * length / p.rho[i];
    const SurfaceTable::Value h = (*table)(x);
    factors[i] = h.factor;
    alongs[i] = h.factor - x * h.slope;
    if (bend_of_lattice) {
      // neighbors in disorder, and waves of a lattice, in which the two parts are out of phase
      const double in_order = bend_of_lattice(type, p.mass_or_volume[i]) * h.slope;
      stiffenings[i] =
          std::max(std::fabs(alongs[i]) + bend * h.slope, std::hypot(alongs[i], in_order));
    }
    const double by = length > 0.0 ? h.slope * support / length : 0.0;
    for (int d = 0; d < 3; d++) of[d] *= by;
    p.rho[i] *= h.factor;
  });
}

void FreeSurface::set_pressure(int i, double p_over_rho2)
{
  for (int d = 0; d < 3; d++) turn[3 * i + d] *= p_over_rho2;
}

void FreeSurface::push(Fluid &core, const Particles &p,
                       const std::vector<FluidBoundary *> &boundaries)
{
  core.turn_forces(p);
  for (FluidBoundary *boundary : boundaries)
    core.for_active_fluid([&](int i, int type) {
      const Eigen::Map<const Eigen::Vector3d> its(&turn[3 * i]);
      boundary->push_turn(i, its / core.model.pressure_scale[type]);
    });
}

double *FreeSurface::pack(int i, double *buf) const
{
  *buf = stiffenings[i];
  return std::copy_n(&turn[3 * i], 3, buf + 1);
}

const double *FreeSurface::unpack(int i, const double *buf)
{
  stiffenings[i] = *buf;
  std::copy_n(buf + 1, 3, &turn[3 * i]);
  return buf + 4;
}
