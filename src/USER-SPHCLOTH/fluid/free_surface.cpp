// SPDX-License-Identifier: GPL-2.0-or-later
// Density sums that are completed at free surfaces.

#include "fluid/free_surface.h"

#include "atom.h"
#include "fluid/sph_materials.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

void FreeSurface::begin_run()
{
  table.reset();
  alongs.clear();
  turn.clear();
  if (materials.completes_surfaces()) table.emplace(materials.wall_table());
}

// Boundary particles have no turn.

void FreeSurface::begin_lists()
{
  if (!on()) return;
  alongs.assign(atom->nmax, 1.0);
  turn.assign(3 * static_cast<std::size_t>(atom->nmax), 0.0);
}

void FreeSurface::complete(Fluid &core, const Particles &p)
{
  core.sum_gradients(p, turn.data());
  core.for_active_fluid([&](int i, int type) {
    double *of = &turn[3 * i];
    const double length = std::sqrt(of[0] * of[0] + of[1] * of[1] + of[2] * of[2]);
    const double support = materials.support(type), x = support * length / p.rho[i];
    const SurfaceTable::Value h = (*table)(x);
    alongs[i] = h.factor - x * h.slope;
    const double by = length > 0.0 ? h.slope * support / length : 0.0;
    for (int d = 0; d < 3; d++) of[d] *= by;
    p.rho[i] *= h.factor;
  });
}

void FreeSurface::set_pressure(int i, double p_over_rho2)
{
  for (int d = 0; d < 3; d++) turn[3 * i + d] *= p_over_rho2;
}

double *FreeSurface::pack(int i, double *buf) const { return std::copy_n(&turn[3 * i], 3, buf); }

const double *FreeSurface::unpack(int i, const double *buf)
{
  std::copy_n(buf, 3, &turn[3 * i]);
  return buf + 3;
}
