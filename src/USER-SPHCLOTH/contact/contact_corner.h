// SPDX-License-Identifier: GPL-2.0-or-later
// The rows of a particle on two faces at once, as in a groove.  A pass over all rows, which share
// its mass, leaves a part of the approach to each face: friction takes it for sliding along the
// other one, and of what restitution gives back nothing may be left.  So in each pass these few are
// solved together: repeated until they hold, first along their normals and then with friction,
// after Moreau, Unilateral contact and dry friction in finite freedom dynamics, CISM Courses 302
// (1988).

#ifndef SPHCLOTH_CONTACT_CONTACT_CORNER_H
#define SPHCLOTH_CONTACT_CONTACT_CORNER_H

#include "core/contact/contact_impulse.h"

#include <algorithm>
#include <vector>

namespace LAMMPS_NS {

class ContactCorner {
 public:
  using Vec3 = Eigen::Vector3d;

  struct Row {
    int number;    // of the contact row
    Vec3 before;    // of the particle relative to the other side
    double other_inverse_mass;
    sphcloth::ExchangedImpulse so_far = {};
    double mass = 0.0;    // effective
    Vec3 impulse = Vec3::Zero();    // by all passes
  };
  std::vector<Row> rows;

  // step(row, relative) returns the impulse of a pass on the particle, with the mass of the
  // particle split over its rows.
  template <class Step> void repeat(double inverse_mass, Step step)
  {
    Vec3 moved = Vec3::Zero();
    double largest_sq = 0.0;
    for (int pass = 0; pass < MAX_PASSES; pass++) {
      Vec3 sum = Vec3::Zero();
      double change_sq = 0.0;
      for (Row &row : rows) {
        const Vec3 relative = row.before + moved + row.other_inverse_mass * row.impulse,
                   impulse = step(row, relative);
        row.impulse += impulse;
        sum += impulse;
        change_sq = std::max(change_sq, impulse.squaredNorm());
      }
      moved += inverse_mass * sum;
      largest_sq = std::max(largest_sq, change_sq);
      if (change_sq <= SMALL * SMALL * largest_sq) return;
    }
  }

 private:
  static constexpr int MAX_PASSES = 40;
  static constexpr double SMALL = 1e-4;    // of the largest change
};

}    // namespace LAMMPS_NS

#endif
