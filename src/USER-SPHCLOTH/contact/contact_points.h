// SPDX-License-Identifier: GPL-2.0-or-later
// How particles that are near a mesh move in the substeps of its solver: straight on, but for what
// contact adds.

#ifndef SPHCLOTH_CONTACT_CONTACT_POINTS_H
#define SPHCLOTH_CONTACT_CONTACT_POINTS_H

#include "contact/moving_triangles.h"

#include <vector>

namespace LAMMPS_NS {

class ContactPoints {
 public:
  using Vec3 = Eigen::Vector3d;

  explicit ContactPoints(MovingTriangles &mesh_) : mesh(mesh_) {}

  // the particles that have slots: they go back to where they start
  void begin_step(double dt);
  void begin_substep(double dt);
  // their velocities at the start of a substep, or so far at its end, to their slots
  void store_velocities(std::vector<Vec3> &velocity) const;
  // what rows have pushed in a pass, by slot
  void push(const std::vector<Vec3> &impulse);
  void end_substep(double dt);
  void push_velocities(const std::vector<Vec3> &impulse);
  void end_step(Atom *);    // moves the atoms

  // Adds what they have moved since the last time, beside what the mesh moves as a whole, to the
  // length of their paths in this step.
  void measure_paths(const Vec3 &together);
  double path(int slot) const { return points[slot - mesh.halo.n_slots()].path; }

  double bytes() const { return sphcloth::bytes_of(points); }

 private:
  struct Point {
    Vec3 from, displacement = Vec3::Zero();    // at the start of the substep, and since then
    Vec3 velocity, velocity_before;
    Vec3 measured;    // where its path has been measured to
    Vec3 ahead;    // where it would go
    double path = 0.0;
    bool touched = false;    // in this substep
    bool moved = false;    // in this step
  };

  MovingTriangles &mesh;
  std::vector<Point> points;

  // visit(point, slot)
  template <class Visit> void for_all(Visit visit)
  {
    int slot = mesh.halo.n_slots();
    for (Point &point : points) visit(point, slot++);
  }
};

}    // namespace LAMMPS_NS

#endif
