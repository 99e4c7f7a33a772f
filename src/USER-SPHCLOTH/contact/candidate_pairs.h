// SPDX-License-Identifier: GPL-2.0-or-later
// Broad phase: the particles and triangles of a mesh that may collide in a step.
// The list is made with a margin, and holds while particles and vertices stay within it, and until
// the next list build of LAMMPS; update() makes it anew where it holds no longer.  Which pairs are
// visited does not depend on when that was.

#ifndef SPHCLOTH_CONTACT_CANDIDATE_PAIRS_H
#define SPHCLOTH_CONTACT_CANDIDATE_PAIRS_H

#include "contact/moving_triangles.h"
#include "contact/triangle_discs.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace LAMMPS_NS {

class CandidatePairs : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  CandidatePairs(LAMMPS *lmp_, const MovingTriangles &mesh_) : Pointers(lmp_), mesh(mesh_) {}

  bool none() const { return mesh.groupbits == 0; }    // no particles are of concern

  // after each list build: there is no list
  void clear();

  // After each change of the sweeps of triangles.  Vertices are taken to move by at most
  // `max_stride` in this step.
  void update(double max_stride = std::numeric_limits<double>::infinity());

  // Those that may come as near as `reach`, at most max_reach(), in this step: visit(particle,
  // triangle, closest points at the start of the step), all triangles of a particle in one row.  A
  // distance changes by no more than both of its ends move.
  template <class Visit> void for_near(double reach, Visit visit) const
  {
    int last = -1;
    sphcloth::Sweep sweep{Vec3::Zero(), Vec3::Zero()};
    double reach_then = 0.0, reach_at_start = 0.0;
    for (const Candidate &c : candidates) {
      if (c.particle != last) {
        last = c.particle;
        sweep = mesh.sweep_of(last);
        reach_at_start = reach + (sweep.end - sweep.start).norm();
        reach_then = reach_at_start + (sweep.start - position_then(last)).norm();
      }
      const auto &[i, j, k] = mesh.triangles[c.triangle];
      if (c.distance > reach_then + std::max({path[i], path[j], path[k]})) continue;
      const sphcloth::ClosestPoints at = mesh.closest_at_start(sweep.start, c.triangle);
      if (at.vector.norm() <= reach_at_start + std::max({stride[i], stride[j], stride[k]}))
        visit(last, c.triangle, at);
    }
  }
  double max_reach() const;

  double memory_usage() const;

 private:
  struct Candidate {
    int particle, triangle;
    double distance;    // when the list was made
  };

  const MovingTriangles &mesh;
  std::vector<Candidate> candidates;
  // at the start of the step when the list was made: of owned atoms, of vertices by slot
  std::array<std::vector<double>, 3> positions_then;
  std::vector<Vec3> vertices_then;
  std::vector<double> stride, path;    // of vertices: in this step; and since then, with this step
  TriangleDiscs discs;

  void find();
  void measure_strides(double max_stride);
  void measure_paths();
  bool still_holds(double max_stride) const;
  double margin() const;
  double longest_path_of_vertices(double max_stride) const;
  double longest_path() const;
  Vec3 position_then(int i) const
  {
    return {positions_then[0][i], positions_then[1][i], positions_then[2][i]};
  }
};

}    // namespace LAMMPS_NS

#endif
