// SPDX-License-Identifier: GPL-2.0-or-later
// Mass scaling of vertices beside fluid (core/sph/mass_scaling.h): which pairs take part, from
// evaluation to evaluation, and what the fluid gets in a step.

#ifndef SPHCLOTH_FLUID_SCALED_MASS_H
#define SPHCLOTH_FLUID_SCALED_MASS_H

#include "pointers.h"

#include "core/sph/fluid.h"
#include "core/sph/mass_scaling.h"
#include "fluid/fluid_boundary.h"
#include "fluid/ghost_exchange.h"
#include "fluid/mesh_scaling.h"
#include "lammps_util/held_particles.h"
#include "lammps_util/particle_columns.h"

#include <Eigen/Core>

#include <vector>

namespace LAMMPS_NS {

class FluidStability;

class ScaledMass : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;
  ScaledMass(class LAMMPS *lmp_, GhostExchange &ghosts_) : Pointers(lmp_), ghosts(ghosts_) {}

  // Anew for each run: of the fluid of a group.  The column, of the fix that moves the fluid, is of
  // what there was in the last step.
  void forget() { groupbit = 0; }
  void want(int groupbit_, ParticleColumns &last_)
  {
    groupbit = groupbit_;
    last = &last_;
    held.begin_run(modify);
  }
  bool wanted() const { return groupbit != 0; }
  // is anything scaled?  Known from the first evaluation of a run on, the same on all ranks.
  bool on() const { return groupbit != 0 && any_vertices; }

  // in an evaluation, collective
  void find(sphcloth::Fluid &, const sphcloth::Particles &, FluidStability &,
            const std::vector<FluidBoundary *> &);
  // those of fluid beside vertices that have been found now
  void bound_frequencies(const sphcloth::Fluid &, FluidStability &) const;
  bool is_beside_vertices(int i) const { return strength[i] > 0.0; }

  const Eigen::Matrix3d &stiffness(int n) const { return stiffnesses[n]; }
  // of an owned atom; -1: it is no vertex beside fluid
  int row(int i) const { return rows[i]; }
  // what the forces of a step, and new springs, do to fluid of all ranks; collective once in a step
  void find_kicks(double dt);
  // what the fluid beside a vertex gives to it then
  Vec3 carried(int n, double dt) const;
  // what the vertex of a row does in a step; the fluid gets the rest
  void give(int n, const VertexChange &change, double dt);
  // moves the fluid by what it was given; collective
  void move_fluid(double dt);

  static int ghost_size(GhostData);
  int pack(GhostData, int i, double *buf) const;
  int unpack(GhostData, int i, const double *buf);
  void add(int i, const double *buf);
  double bytes() const;

 private:
  GhostExchange &ghosts;
  int groupbit = 0;
  ParticleColumns *last = nullptr;
  HeldParticles held;
  bool any_vertices = false, any_pairs = false, kicks_known = false;
  std::vector<sphcloth::VertexGradients> gradients;    // over vertices, of owned fluid
  // s_i^2 times their trace, of all atoms; 0 of what has no vertex near
  std::vector<double> strength;
  std::vector<double> normals;    // of the same, [all][3], away from the vertices of pairs
  std::vector<int> beside;    // all atoms of a strength above 0
  sphcloth::VertexPairs vertex_pairs;
  std::vector<int> rows;    // of owned atoms
  std::vector<Eigen::Matrix3d> stiffnesses;    // of rows
  MeshScaling meshes;
  std::vector<Vec3> carried_by_meshes;    // of rows, in this step
  std::vector<VertexChange> changes;    // of rows, until the fluid is moved
  std::vector<sphcloth::FluidKick> kicks;    // of all atoms
  std::vector<Vec3> impulses;

  void note_springs(double dt);
  int held_in_step(int i, double dt) const;
  int row_of(int vertex);
};

}    // namespace LAMMPS_NS

#endif
