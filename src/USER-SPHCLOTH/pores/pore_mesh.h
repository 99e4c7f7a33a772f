// SPDX-License-Identifier: GPL-2.0-or-later
// The porous triangles of one mesh, and the fluid that is near them in a step.

#ifndef SPHCLOTH_PORES_PORE_MESH_H
#define SPHCLOTH_PORES_PORE_MESH_H

#include "contact/moving_triangles.h"
#include "contact/triangle_ends.h"
#include "core/pores/pore_law.h"
#include "fluid/boundary_mesh.h"
#include "pointers.h"
#include "pores/pore_fluid.h"

#include <vector>

namespace LAMMPS_NS {

// a particle in the layer before a porous triangle

struct PorePair {
  using Vec3 = Eigen::Vector3d;

  int particle;
  std::array<int, 3> vertices;    // slots
  Vec3 weight, toward;    // barycentric; normal, from the particle to the mesh
  double mass;
  double share;    // of the pressure, over the width of the layer
  sphcloth::PoreDrag drag;    // mass over time
  double forchheimer;    // mass over length

  // What the drag takes from a velocity relative to the mesh in a time, where a push changes that
  // velocity by the push times the mobility.
  Vec3 taken_from(const Vec3 &u, double time, double mobility) const
  {
    const double by = time * mobility, closing = u.dot(toward), rate = by * drag.along;
    const double left = sphcloth::slowed(closing, by * drag.across, by * forchheimer);
    return (closing - left) * toward + rate / (1.0 + rate) * (u - closing * toward);
  }
};

class PoreMesh : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  PoreMesh(LAMMPS *lmp_, MovingTriangles *set_, const PoreFluid &fluid_) :
      Pointers(lmp_), set(set_), fluid(fluid_),
      mesh(lmp, set, fluid.groupbit, BoundaryMesh::Part::ALL),
      ends(set->mesh->topology(), [this](std::size_t triangle) { return is_porous(triangle); })
  {
  }

  MovingTriangles *const set;
  std::vector<PorePair> pairs;    // of this step

  void rebuild();    // after each list build
  // Once particles have moved in a step.  flow: by atom, of vertices, which changes.  Collective.
  void find(double *flow);

  // A mesh that does not give way: slows the particles of the pairs, and pushes it.  Returns the
  // impulse on it, mass times velocity, and adds to the energy that is lost.
  Vec3 slow_down(double &lost);

  // visit(particle, side): above, 1, or below, -1
  template <class Visit> void for_sides(Visit visit) const
  {
    for (const ClosestPoint &at : closest_points) visit(at.particle, side_of(at));
  }

  double bytes() const
  {
    return ends.bytes() +
        sphcloth::bytes_of(pairs, closest_points, pushed, start, velocity, area, passing, filled,
                           part);
  }

 private:
  const PoreFluid &fluid;
  BoundaryMesh mesh;
  const TriangleEnds ends;    // of the porous part
  std::vector<Vec3> pushed;    // by slot, 0 between steps
  std::vector<Vec3> start, velocity;    // by slot: at the start of the step
  // By slot: a third of the area of its triangles; shares of particles times upward displacements,
  // times widths, and shares; volumes times shares above and below; the parts of both layers
  std::vector<double> area;
  std::vector<Vec3> passing, filled, part;
  std::vector<ClosestPoint> closest_points;    // on porous triangles, not at their end

  bool is_porous(std::size_t triangle) const    // of the mesh
  {
    return fluid.is_porous(set->mesh->topology().triangles.type[triangle]);
  }
  void load_start();
  Vec3 relative_velocity(const ClosestPoint &) const;    // of the particle to the mesh
  int side_of(const ClosestPoint &) const;
  double share_of(const ClosestPoint &) const;
  void find_areas();
  void follow_flow(double *flow);
  void add_pair(const ClosestPoint &);
};

}    // namespace LAMMPS_NS

#endif
