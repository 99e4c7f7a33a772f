// SPDX-License-Identifier: GPL-2.0-or-later
// Broad phase: the particles and triangles of a mesh that may collide in a step.
// The list is made with a margin, and holds until a particle or a vertex has moved that far, or
// until the next list build of LAMMPS; update() makes it anew where it holds no longer.

#ifndef SPHCLOTH_CONTACT_CANDIDATE_PAIRS_H
#define SPHCLOTH_CONTACT_CANDIDATE_PAIRS_H

#include "contact/moving_triangles.h"
#include "contact/triangle_discs.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

class CandidatePairs : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  CandidatePairs(LAMMPS *lmp_, const MovingTriangles &mesh_) : Pointers(lmp_), mesh(mesh_) {}

  // after each list build: there is no list
  void clear();

  // after each change of the sweeps of triangles
  void update();

  // Those whose sweeps overlap in this step: visit(particle, triangle, sweep of the particle), all
  // triangles of a particle in one row.
  template <class Visit> void for_overlapping(Visit visit)
  {
    int last = -1;
    sphcloth::Sweep sweep;
    sphcloth::Box box;
    for (const auto &[i, t] : candidates) {
      if (i != last) {
        sweep = mesh.sweep_of(i);
        box = sphcloth::Box(sweep.start);
        box.extend(sweep.end);
        last = i;
      }
      if (swept_box(t).intersects(box)) visit(i, t, sweep);
    }
  }

  double memory_usage() const;

 private:
  const MovingTriangles &mesh;
  std::vector<std::array<int, 2>> candidates;    // atom and triangle
  std::vector<Vec3> positions_then;    // of owned atoms, when the list was made
  std::vector<Vec3> start_then, end_then;    // of vertices by slot, the same
  std::vector<sphcloth::Box> boxes;    // of the sweeps of triangles, made when they are asked for
  std::vector<char> has_box;
  TriangleDiscs discs;

  void find();
  bool still_holds() const;
  double margin() const;
  double max_displacement_sq() const;
  double max_vertex_displacement_sq() const;
  const sphcloth::Box &swept_box(int t);
};

}    // namespace LAMMPS_NS

#endif
