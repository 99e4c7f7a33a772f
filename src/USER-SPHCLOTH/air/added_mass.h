// SPDX-License-Identifier: GPL-2.0-or-later
// Air that moves along with a cloth, across it: a mass that is added to that of the vertices in the
// direction of their normal, behind each sweep of the solver.
//
// What a sweep, or a force, gives to a vertex across the cloth is less by the share of the air in
// both masses; the air gets the rest.  A step of a mass matrix m + m_a n n^T, whose constraints are
// projected with m: where they pull across the cloth they need more substeps to get their way.

#ifndef SPHCLOTH_AIR_ADDED_MASS_H
#define SPHCLOTH_AIR_ADDED_MASS_H

#include "air/air_mesh.h"
#include "cloth/solver_coupling.h"

#include <vector>

namespace LAMMPS_NS {

class AddedMass : public SolverCoupling, protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  // areal: mass of the air over the area of the cloth
  AddedMass(LAMMPS *lmp_, AirMesh *mesh_, double areal_) :
      Pointers(lmp_), mesh(mesh_), areal(areal_)
  {
  }

  void rebuild();    // after each list build
  // at the start of a step, when it is known what is dry; collective
  void find_shares();

  bool begin_step(const sphcloth::Vertex *start, const sphcloth::Vertex *end, double dt) override;
  void begin_substep(const sphcloth::Vertex *, const sphcloth::Vertex *, double dt) override;
  void project(sphcloth::Vertex *displacement) override;
  void end_substep(sphcloth::Vertex *v, double dt) override;
  void end_step() override {}
  Vec3 impulse_on(int slot) const override
  {
    const Layer &layer = layers[slot];
    return -both_masses[slot] * (layer.gain + layer.speed) * layer.across;
  }

  // of an owned vertex of the mesh, which is another order
  Vec3 impulse_on_mesh(int slot) const { return impulse_on(slot_in_solver[slot]); }
  double bytes() const;

 private:
  // The air of an owned vertex of the solver, in its order.  With s its share in the mass across
  // the cloth, all speeds are those along the normal times the root of s.
  struct Layer {
    Vec3 across = Vec3::Zero();    // the normal times the root of s; 0 of a held vertex
    double speed = 0.0;    // by what the vertex has got; at the start of a substep without forces
    double gain = 0.0;    // by forces and constraints in this step, less that speed
  };

  AirMesh *const mesh;
  const double areal;
  std::vector<int> slot_in_solver;    // of owned vertices of the mesh
  std::vector<Layer> layers;
  std::vector<double> both_masses;    // of vertex and air
  std::vector<Vec3> area;    // of vertices of the mesh
  double substep_dt = 0.0;
};

}    // namespace LAMMPS_NS

#endif
