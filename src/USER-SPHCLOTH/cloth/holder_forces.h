// SPDX-License-Identifier: GPL-2.0-or-later
// What a cloth and the holders of its vertices do to each other: pins, whose motion is given, and
// bodies that vertices are attached to, which another fix integrates.

#ifndef SPHCLOTH_CLOTH_HOLDER_FORCES_H
#define SPHCLOTH_CLOTH_HOLDER_FORCES_H

#include "cloth/cloth_vertices.h"
#include "lammps_util/particle_columns.h"
#include "pointers.h"

#include <Eigen/Core>

namespace LAMMPS_NS {

class HolderForces : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;
  // per atom: force of the cloth on the holder of a vertex; gap between an attached vertex and
  // where the solver left it
  enum Column { FORCE, GAP = 3, N_COLUMNS = 6 };
  ParticleColumns columns;    // empty: not wanted

  HolderForces(LAMMPS *lmp_, ClothVertices &vertices_) : Pointers(lmp_), vertices(vertices_) {}

  bool wanted() const { return !columns.empty(); }
  void want();

  // An attached vertex starts where the solver left it and goes with its body, but for the part of
  // the gap to its place there that it closes.
  void load_attached(int slot);

  // in a step: what acts on pins, what each substep adds, and what attached vertices gained
  void begin_step();
  template <std::size_t N>
  void add_pull(const sphcloth::Constraints<N> &, const sphcloth::Vertex *start, double substep_dt,
                int substeps);
  void end_step();

  // from others in this step, mass times velocity
  void add_impulse(int owned_atom, const Vec3 &impulse);

  Vec3 force_on_holder(int owned_atom) const { return vector_of(FORCE, owned_atom); }

 private:
  ClothVertices &vertices;

  Vec3 vector_of(int column, int i) const
  {
    return {columns[column][i], columns[column + 1][i], columns[column + 2][i]};
  }
  sphcloth::Vertex velocity_of_attached(int slot) const;
};

}    // namespace LAMMPS_NS

#endif
