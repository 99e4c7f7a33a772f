// SPDX-License-Identifier: GPL-2.0-or-later
// The vertices of a cloth against the triangles of an obstacle, while the cloth is solved.
// After each sweep over the constraints of the cloth its vertices are put back out of the obstacle,
// and at the end of a substep their velocities follow; the obstacle takes the impulses.

#ifndef SPHCLOTH_CONTACT_OBSTACLE_COUPLING_H
#define SPHCLOTH_CONTACT_OBSTACLE_COUPLING_H

#include "cloth/solver_coupling.h"
#include "contact/moving_triangles.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

class ObstacleCoupling : public SolverCoupling, protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  ObstacleCoupling(LAMMPS *lmp_, const MovingTriangles &cloth_, MovingTriangles &obstacle_) :
      Pointers(lmp_), cloth(cloth_), obstacle(obstacle_)
  {
  }

  bool begin_step(const sphcloth::Vertex *start, const sphcloth::Vertex *end, double dt) override;
  void begin_substep(const sphcloth::Vertex *start, const sphcloth::Vertex *v, double dt) override;
  void project(sphcloth::Vertex *displacement) override;
  void end_substep(sphcloth::Vertex *v, double dt) override;
  void end_step() override;
  Vec3 impulse_on(int slot) const override { return received[slot]; }

  double memory_usage() const;

 private:
  struct Candidate {    // that a vertex may meet in this step
    int triangle;
    sphcloth::ContactStart start;
  };
  struct VertexContact {    // of a vertex of the cloth
    int slot;
    int first, last;    // of its candidates: candidates[first] to candidates[last - 1]
    Vec3 start = Vec3::Zero();
    // of the substep: the triangle that it was put back from last, where, and how far
    int triangle = -1;
    Vec3 weight = Vec3::Zero(), normal = Vec3::Zero();
    double correction = 0.0;
    Vec3 velocity_before = Vec3::Zero();
    double speed_before = 0.0;
  };

  const MovingTriangles &cloth;
  MovingTriangles &obstacle;
  double step_dt = 0.0, elapsed = 0.0;    // of the step, up to the end of the substep
  const sphcloth::Vertex *substep_start = nullptr;
  std::vector<sphcloth::Box> boxes;    // of the sweeps of triangles
  sphcloth::BoxGrid grid;
  std::vector<Candidate> candidates;
  std::vector<VertexContact> contacts;
  std::vector<Vec3> received;    // by slot of the cloth
  std::vector<Vec3> impulse;    // on the obstacle, by slot

  void load_obstacle();
  void find_candidates(int slot, const sphcloth::Sweep &);
  int find_deepest(const VertexContact &, const Vec3 &position,
                   sphcloth::ContactResult &deepest) const;
  Vec3 relative_velocity(const Vec3 &of_vertex, int triangle, const Vec3 &weight) const;
};

}    // namespace LAMMPS_NS

#endif
