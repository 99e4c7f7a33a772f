// SPDX-License-Identifier: GPL-2.0-or-later
// Contact of cloth with cloth and with obstacles while it is solved: after each sweep over its
// constraints vertices and triangles, and edges, that are nearer than the thickness are pushed
// apart.

#ifndef SPHCLOTH_CONTACT_CLOTH_ROWS_H
#define SPHCLOTH_CONTACT_CLOTH_ROWS_H

#include "cloth/solver_coupling.h"
#include "contact/cloth_candidates.h"
#include "contact/contact_row.h"

#include <vector>

namespace LAMMPS_NS {

class ClothRows : public SolverCoupling, protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  ClothRows(LAMMPS *lmp_, MovingTriangles &mesh_, const MeshEdges &edges_,
            ClothCandidates &candidates_) :
      Pointers(lmp_), mesh(mesh_), edges(edges_), candidates(candidates_)
  {
  }

  void rebuild();    // after each list build

  bool begin_step(const sphcloth::Vertex *start, const sphcloth::Vertex *end, double dt) override;
  void begin_substep(const sphcloth::Vertex *start, const sphcloth::Vertex *v, double dt) override;
  void project(sphcloth::Vertex *displacement) override;
  void end_substep(sphcloth::Vertex *v, double dt) override;
  void end_step() override;
  Vec3 impulse_on(int slot) const override { return received[slot]; }

  double memory_usage() const;

 private:
  MovingTriangles &mesh;
  const MeshEdges &edges;
  ClothCandidates &candidates;
  std::vector<ContactRow> rows;
  std::vector<int> active;    // rows in contact in this substep
  SplitMasses masses;
  std::vector<Vec3> from, end_before, velocity;    // vertices at the start of the substep
  std::vector<Vec3> received;    // by owned vertices in this step, mass times velocity
  const sphcloth::Vertex *substep_start = nullptr;
  int passes = 1;    // of a projection, in this step
  double remaining = 0.0, substep_dt = 0.0;    // of the step, behind this substep
  double path = 0.0;    // longest of a vertex since the step began, beside what all move together

  double find_rows();
  void project_once(sphcloth::Vertex *displacement);
  void load_positions(const sphcloth::Vertex *displacement);
  void load_velocities(const sphcloth::Vertex *v);
  double share(const ContactRow &, const sphcloth::ClosestPoints &) const;
  double leaning_beside(int edge, const Vec3 &from_nearest,
                        const std::array<int, 2> &other_side) const;
  void project_normal(int row);
  void project_friction(ContactRow &);
  void solve_velocity(const ContactRow &, double dt);
};

}    // namespace LAMMPS_NS

#endif
