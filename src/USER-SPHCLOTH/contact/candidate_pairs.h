// SPDX-License-Identifier: GPL-2.0-or-later
// Broad phase: the particles and triangles of a mesh that may collide in a step.
// The list is made with a margin, and holds until the next list build of LAMMPS, while vertices
// stay within it and, for each particle, while that does; update() makes it anew where it holds no
// longer.  Particles that are far from the mesh are not looked at before any atom may have come
// near.  Which pairs are visited does not depend on when lists were made.

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
      const double ahead = std::max({stride[i], stride[j], stride[k]});
      if (c.distance > reach_then + ahead + std::max({path[i], path[j], path[k]})) continue;
      if (sphcloth::distance_along_centers(
              sphcloth::PairKind::POINT_TRIANGLE,
              {sweep.start, mesh.start[i], mesh.start[j], mesh.start[k]}) > reach_at_start + ahead)
        continue;
      const sphcloth::ClosestPoints at = mesh.closest_at_start(sweep.start, c.triangle);
      if (at.vector.norm() <= reach_at_start + ahead) visit(last, c.triangle, at);
    }
  }
  double max_reach() const;

  double memory_usage() const;

 private:
  struct Candidate {
    int particle, triangle;
    // at least, of where the particle was asked for from where the triangle then was
    double distance;
  };

  const MovingTriangles &mesh;
  std::vector<Candidate> candidates, merged;    // in the order of particles
  // at the start of the step when they were asked for: of owned atoms; by slot, of vertices
  std::array<std::vector<double>, 3> positions_then;
  std::vector<Vec3> vertices_then;
  std::vector<double> room;    // of owned atoms: how far their candidates hold
  std::vector<int> near;    // owned atoms with less room than others share
  double path_then = 0.0;    // StepStart::longest_path(), when the others were asked for
  std::vector<int> asked;    // owned atoms whose candidates are found anew
  std::vector<double> stride, path;    // of vertices: in this step; from then to its start
  TriangleDiscs discs;

  void sort_triangles();
  void find();
  void find_of(int particle);
  void measure_strides(double max_stride);
  void measure_paths();
  bool triangles_hold(double max_stride) const;
  double margin() const;
  double longest_path_of_vertices(double max_stride) const;
  double room_of_others() const;
  void find_near();
  bool others_hold() const;
  bool is_beyond_room(int i) const;
  Vec3 position_then(int i) const
  {
    return {positions_then[0][i], positions_then[1][i], positions_then[2][i]};
  }
};

}    // namespace LAMMPS_NS

#endif
