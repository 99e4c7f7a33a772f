// SPDX-License-Identifier: GPL-2.0-or-later
// Drag of fluid in the pores of a cloth while that is solved: rows between a particle and the
// vertices of a triangle, with an impulse that the velocity of the end of a substep gives.
//
// Vertices may be as light as they like: what stands up to the drag is the tension of the cloth,
// which the solver finds in the same substep.

#ifndef SPHCLOTH_PORES_PORE_ROWS_H
#define SPHCLOTH_PORES_PORE_ROWS_H

#include "cloth/solver_coupling.h"
#include "pointers.h"
#include "pores/pore_mesh.h"

#include <vector>

namespace LAMMPS_NS {

class PoreRows : public SolverCoupling, protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  PoreRows(LAMMPS *lmp_, PoreMesh &mesh_) : Pointers(lmp_), mesh(mesh_) {}

  void rebuild();    // after each list build
  // behind a step: adds the impulse on the cloth, mass times velocity, and the energy lost
  void take(Vec3 &impulse, double &lost) const
  {
    if (!present) return;
    impulse += step_impulse;
    lost += step_lost;
  }

  bool begin_step(const sphcloth::Vertex *start, const sphcloth::Vertex *end, double dt) override;
  void begin_substep(const sphcloth::Vertex *start, const sphcloth::Vertex *v, double dt) override;
  void project(sphcloth::Vertex *displacement) override;
  void end_substep(sphcloth::Vertex *v, double dt) override;
  void end_step() override;
  Vec3 impulse_on(int slot) const override { return received[slot]; }

  double bytes() const;

 private:
  struct Row {
    Vec3 velocity_before, velocity;    // of the particle, at the start of the step, and now
    Vec3 offset = Vec3::Zero();    // how far all substeps before have moved it aside
    Vec3 correction = Vec3::Zero();    // in this substep, mass times length: what the cloth gets
    double mobility = 0.0;    // inverse mass
    Vec3 relative = Vec3::Zero();    // displacement without the row, in the last projection
  };

  PoreMesh &mesh;
  bool present = false;    // in this step, on any rank
  Vec3 step_impulse = Vec3::Zero();
  double step_lost = 0.0;
  std::vector<Row> rows;    // of the pairs of the mesh
  double substep_dt = 0.0;
  // by slot: how vertices are displaced in this substep; by how many shares of particles they are
  // pushed; what they get in a projection
  std::vector<Vec3> displaced, load, push;
  std::vector<Vec3> received;    // by owned vertices in this step, mass times velocity

  void load_displacements(const sphcloth::Vertex *);
  void share_masses();
  void solve(std::size_t row);
  void give(sphcloth::Vertex *displacement);
};

}    // namespace LAMMPS_NS

#endif
