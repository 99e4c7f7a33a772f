// SPDX-License-Identifier: GPL-2.0-or-later
// Contact inside the solver of a cloth: a constraint of each particle with each triangle near it,
// projected after each sweep over the edges and hinges, mass-weighted, both ways, and only pushing.
// Friction follows from the normal correction; the end of a substep solves velocities.

#ifndef SPHCLOTH_CONTACT_SOLVER_CONTACT_H
#define SPHCLOTH_CONTACT_SOLVER_CONTACT_H

#include "cloth/solver_coupling.h"
#include "contact/candidate_pairs.h"
#include "contact/contact_pairs.h"

#include <vector>

namespace LAMMPS_NS {

class SolverContact : public SolverCoupling, protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  SolverContact(LAMMPS *lmp_, MovingTriangles &mesh_, CandidatePairs &candidates_) :
      Pointers(lmp_), mesh(mesh_), candidates(candidates_), contacts(lmp, mesh)
  {
  }

  // after each list build
  void rebuild();

  bool begin_step(const sphcloth::Vertex *start, const sphcloth::Vertex *end, double dt) override;
  void begin_substep(const sphcloth::Vertex *start, const sphcloth::Vertex *v, double dt) override;
  void project(sphcloth::Vertex *displacement) override;
  void end_substep(sphcloth::Vertex *v, double dt) override;
  void end_step() override;
  Vec3 impulse_on(int slot) const override { return received[slot]; }

  double memory_usage() const;

 private:
  MovingTriangles &mesh;
  CandidatePairs &candidates;
  ContactPairs contacts;
  double substep_dt = 0.0, remaining = 0.0;    // of the step, behind this substep
  const sphcloth::Vertex *substep_start = nullptr;    // by owned slot
  std::vector<Vec3> from;    // the same by slot, with friction
  std::vector<Vec3> end_before;    // by slot, in the last sweep
  double vertex_path = 0.0;    // how far the fastest went from sweep to sweep, in this step
  std::vector<Vec3> received;    // by owned slot, mass times velocity

  void find_pairs();
  void load_velocities(const sphcloth::Vertex *v);
  void move_vertices(const sphcloth::Vertex *displacement);
  void move_particles();
  bool sleeps(const ContactPair &) const;
  void project_normal(int pair);
  void project_friction(ContactPair &);
  void solve_velocity(const ContactPair &, double dt);
};

}    // namespace LAMMPS_NS

#endif
