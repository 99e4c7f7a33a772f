// SPDX-License-Identifier: GPL-2.0-or-later
// The vertices of one cloth that are beside fluid, in its solver: forces and constraints move them
// as if they had the mass that scaling adds, and the fluid gets the rest.

#ifndef SPHCLOTH_FLUID_SCALED_VERTICES_H
#define SPHCLOTH_FLUID_SCALED_VERTICES_H

#include "pointers.h"

#include "cloth/cloth_vertices.h"
#include "cloth/solver_coupling.h"
#include "core/sph/mass_scaling.h"

#include <functional>
#include <vector>

namespace LAMMPS_NS {

class ScaledMass;

class ScaledVertices : public SolverCoupling, protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  ScaledVertices(class LAMMPS *lmp_, const ClothVertices &vertices_) :
      Pointers(lmp_), vertices(vertices_)
  {
  }

  // before a run: of the fluid of the pair style, if there is any
  void init();
  bool on() const;

  // Makes the forces on vertices those that would move the vertices alone as the scaled ones move.
  // Forces act on them for these parts of the step.  Collective.
  void scale_forces(double dt, const std::function<double(int slot)> &part_of_step);

  bool begin_step(const sphcloth::Vertex *, const sphcloth::Vertex *, double) override
  {
    return on();
  }
  void begin_substep(const sphcloth::Vertex *start, const sphcloth::Vertex *v, double dt) override;
  void project(sphcloth::Vertex *displacement) override;
  void end_substep(sphcloth::Vertex *, double) override {}
  void end_step() override {}
  Vec3 impulse_on(int slot) const override
  {
    return row_of_slot[slot] < 0 ? Vec3(Vec3::Zero()) : rows[row_of_slot[slot]].received;
  }

  // behind the last coupling of all cloths that are solved together; collective
  void move_fluid();

  double bytes() const;

 private:
  struct Row {
    int slot, number;    // of the row of ScaledMass
    sphcloth::MassScaling mass;
    double part_of_step;    // for which forces act
    Vec3 change;    // of the velocity in this step
    Vec3 expected;    // displacement of the substep as far as it is scaled
    Vec3 received;    // impulse in this step, from what constraints did
  };

  const ClothVertices &vertices;
  ScaledMass *scaled = nullptr;
  std::vector<int> row_of_slot;
  std::vector<Row> rows;
  double step_dt = 0.0, substep_dt = 0.0;
};

}    // namespace LAMMPS_NS

#endif
