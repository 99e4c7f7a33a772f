// SPDX-License-Identifier: GPL-2.0-or-later
// Velocities behind the solver: both sides of what was pushed apart lose their approach.
// What friction slows has moved with less velocity since the contact began.
//
// One pass over rows that share a mass removes a part of each approach, and the rest of it looks to
// friction like sliding along the other row.  With restitution or friction rows are repeated until
// each has its speed along the normal, and then with friction: Moreau, Unilateral contact and dry
// friction in finite freedom dynamics, CISM Courses 302 (1988).

#ifndef SPHCLOTH_CONTACT_VELOCITY_ROWS_H
#define SPHCLOTH_CONTACT_VELOCITY_ROWS_H

#include "contact/contact_row.h"
#include "contact/moving_triangles.h"
#include "core/contact/contact_impulse.h"

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
  // At most `max_approach` of its velocity is removed.  A particle that came too near by a length
  // has slid too far for as long as that took.
  void add(const ContactRow &row, double max_approach = std::numeric_limits<double>::infinity(),
           double too_near = 0.0)
  {
    rows.push_back({row, max_approach, too_near});
  }
  // Collective.  What restitution gives back comes back at once.
  void solve();

  double bytes() const { return masses.bytes() + sphcloth::bytes_of(rows, velocity); }

 private:
  using Vec3 = Eigen::Vector3d;
  struct Pushed {
    ContactRow row;
    double max_approach, too_near;
    double mass = 0.0, speed_before = 0.0;    // effective, and along the normal
    double change = 0.0;    // of that speed that is due
    sphcloth::ExchangedImpulse exchanged = {};
    Vec3 taken_back = Vec3::Zero();
  };

  MovingTriangles &mesh;
  const MeetingRules rules;
  std::vector<Pushed> rows;
  SplitMasses masses;
  std::vector<Vec3> velocity;    // by slot

  void load_velocities();
  void start_rows();
  void start(Pushed &) const;
  bool are_repeated() const;
  void pass_until_done(bool rubs, int max_passes);
  double pass(bool rubs);
  double push(Pushed &, bool rubs);
  void apply_impulses();
  Vec3 slid_too_far(const Pushed &) const;
  void take_back(const Pushed &);
};

}    // namespace LAMMPS_NS

#endif
