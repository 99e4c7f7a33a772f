// SPDX-License-Identifier: GPL-2.0-or-later
// Sums over the fluid around vertices, as (1) over volumes: vertices are sorted into cells of the
// support, and each particle looks at those around its own.

#include "air/water_beside.h"

#include "air/air_mesh.h"
#include "atom.h"
#include "core/geometry/buckets.h"
#include "core/sph/kernel.h"
#include "core/util/bytes.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "lammps_util/atom_tools.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using Eigen::Vector3d;
using Kernel = sphcloth::WendlandC2;

static Vector3d vector_of(const double *x) { return {x[0], x[1], x[2]}; }

void WaterBeside::init()
{
  fluid = nullptr;
  largest = 0.0;
  const FluidState *found = FluidState::find(force);
  if (!found) return;
  support.assign(atom->ntypes + 1, 0.0);
  for (int type = 1; type <= atom->ntypes; type++)
    if (found->is_fluid(type)) {
      support[type] = found->support(type);
      largest = std::max(largest, support[type]);
    }
  if (largest > 0.0) fluid = found;
}

void WaterBeside::find(AirMesh &cloth)
{
  if (!any()) return;
  cloth.water.assign(cloth.halo.n_slots(), 0.0);
  cloth.water_side.assign(cloth.halo.n_slots(), Vector3d::Zero());
  if (cloth.halo.n_owned() == 0) return;
  sort(cloth);
  sphcloth::Box near = grid.bounds;
  near.min().array() -= largest;
  near.max().array() += largest;
  for (int j = 0; j < atom->nlocal + atom->nghost; j++)
    if (support[atom->type[j]] > 0.0 && near.contains(vector_of(atom->x[j]))) add(cloth, j);
}

void WaterBeside::sort(const AirMesh &cloth)
{
  const int n = cloth.halo.n_owned();
  sphcloth::Box bounds;
  for (int s = 0; s < n; s++) bounds.extend(vector_of(atom->x[cloth.halo.atom_of(s)]));
  grid.cut(bounds, Vector3d::Constant(largest), n);
  sphcloth::sort_into_buckets(
      grid.size(),
      [&](auto put) {
        for (int s = 0; s < n; s++) {
          const sphcloth::CellGrid::Cell c = grid.of(vector_of(atom->x[cloth.halo.atom_of(s)]));
          put(grid.number(c[0], c[1], c[2]), s);
        }
      },
      first, vertices);
}

void WaterBeside::add(AirMesh &cloth, int j) const
{
  const int type = atom->type[j];
  const double reach = support[type];
  const double share = atom_mass(atom, j) / fluid->equation_of_state(type).rho0 * Kernel::norm(3) /
      (reach * reach * reach);
  const Vector3d x = vector_of(atom->x[j]), by = Vector3d::Constant(reach);
  grid.for_cells(grid.of(x - by), grid.of(x + by), [&](const auto &, std::size_t cell) {
    for (int k = first[cell]; k < first[cell + 1]; k++) {
      const int s = vertices[k];
      const Vector3d from = x - vector_of(atom->x[cloth.halo.atom_of(s)]);
      const double distance_sq = from.squaredNorm();
      if (distance_sq >= reach * reach) continue;
      const double distance = std::sqrt(distance_sq);
      const double part = share * Kernel::shape(distance / reach);
      cloth.water[s] += part;
      if (distance > 0.0) cloth.water_side[s] += part / distance * from;
    }
  });
}

double WaterBeside::bytes() const { return sphcloth::bytes_of(first, vertices); }
