// SPDX-License-Identifier: GPL-2.0-or-later
// Velocities behind the solver: both sides of what was pushed apart lose their approach.

#ifndef SPHCLOTH_CONTACT_VELOCITY_ROWS_H
#define SPHCLOTH_CONTACT_VELOCITY_ROWS_H

#include "contact/contact_row.h"
#include "contact/moving_triangles.h"

#include <limits>
#include <vector>

namespace LAMMPS_NS {

class VelocityRows : protected Pointers {
 public:
  VelocityRows(LAMMPS *lmp_, MovingTriangles &mesh_, const MeetingRules &rules_) :
      Pointers(lmp_), mesh(mesh_), rules(rules_)
  {
  }

  void clear() { rows.clear(); }
  // At most `max_approach` of its velocity is removed.
  void add(const ContactRow &row, double max_approach = std::numeric_limits<double>::infinity())
  {
    rows.push_back({row, max_approach});
  }
  // Collective.  What restitution gives back comes back at once.
  void solve();

  double bytes() const { return masses.bytes() + sphcloth::bytes_of(rows, velocity); }

 private:
  using Vec3 = Eigen::Vector3d;
  struct Pushed {
    ContactRow row;
    double max_approach;
  };

  MovingTriangles &mesh;
  const MeetingRules rules;
  std::vector<Pushed> rows;
  SplitMasses masses;
  std::vector<Vec3> velocity;    // by slot

  void load_velocities();
  void push(const Pushed &);
};

}    // namespace LAMMPS_NS

#endif
