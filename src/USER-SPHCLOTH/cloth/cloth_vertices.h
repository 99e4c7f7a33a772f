// SPDX-License-Identifier: GPL-2.0-or-later
// The vertices of a cloth that a rank owns or needs, as arrays by slot of their halo.

#ifndef SPHCLOTH_CLOTH_CLOTH_VERTICES_H
#define SPHCLOTH_CLOTH_CLOTH_VERTICES_H

#include "cloth/vertex_halo.h"
#include "core/pbd/cloth_solver.h"
#include "core/util/bytes.h"

#include <vector>

namespace LAMMPS_NS {

struct ClothVertices {
  explicit ClothVertices(LAMMPS *lmp) : halo(lmp) {}

  VertexHalo halo;
  // positions, velocities, positions at the start of the (sub)step, displacements since then, and
  // the change of a Jacobi sweep (empty for other solvers); one idle vertex behind those of the
  // halo. Their w is the inverse mass in the solver, 0 for pins.
  sphcloth::Vertices p, v, start, displacement, change;
  // inverse mass to forces: 0 for attached vertices, too, which another fix integrates
  std::vector<double> inverse_mass;
  std::vector<int> attached;    // slots
  std::vector<Eigen::Vector3d> step_start;    // of owned ones, where the step takes them up

  // solver_mass: inverse masses of all slots in the solver
  void reset(const std::vector<double> &solver_mass, bool jacobi)
  {
    const std::size_t n = halo.n_slots() + 1;
    p.assign(n, {});
    for (int s = 0; s < halo.n_slots(); s++) p[s].w = solver_mass[s];
    start = p;
    v = p;
    displacement = p;
    inverse_mass = solver_mass;
    for (int s : attached) inverse_mass[s] = 0.0;
    change.assign(jacobi ? n : 0, {});
  }

  // of owned vertices, which something other than the solver has moved
  void load_positions(const double *const *x)
  {
    for (int s = 0; s < halo.n_owned(); s++) {
      const double *at = x[halo.atom_of(s)];
      p[s] = {at[0], at[1], at[2], p[s].w};
    }
  }

  void note_step_start()
  {
    step_start.resize(halo.n_owned());
    for (int s = 0; s < halo.n_owned(); s++) step_start[s] = {start[s].x, start[s].y, start[s].z};
  }

  void update_positions()
  {
    for (int s = 0; s < halo.n_slots(); s++) {
      p[s].x = start[s].x + displacement[s].x;
      p[s].y = start[s].y + displacement[s].y;
      p[s].z = start[s].z + displacement[s].z;
    }
  }

  double bytes() const
  {
    return sphcloth::bytes_of(p, v, start, displacement, change, step_start) + halo.memory_usage();
  }
};

}    // namespace LAMMPS_NS

#endif
