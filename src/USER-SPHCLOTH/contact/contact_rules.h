// SPDX-License-Identifier: GPL-2.0-or-later
// What the user of fix cloth/contact asks for, and what it counts.

#ifndef SPHCLOTH_CONTACT_CONTACT_RULES_H
#define SPHCLOTH_CONTACT_CONTACT_RULES_H

#include "platform.h"

#include <algorithm>

namespace LAMMPS_NS {

struct ContactRules {
  double thickness = 0.0;
  double friction = 0.0;       // Coulomb's coefficient
  double restitution = 0.0;    // share of the approaching speed that comes back
  bool sides = true;           // fluids above and below a sheet do not interact
};

// what meets a triangle or an edge

enum class Meeting : char { CLOTH_CLOTH, CLOTH_OBSTACLE, PARTICLE };

struct MeetingRules {
  const ContactRules &cloth, &others;    // of cloth with cloth; of obstacles and particles
  const bool &cloth_meets_cloth;

  const ContactRules &of(Meeting meeting) const
  {
    return meeting == Meeting::CLOTH_CLOTH ? cloth : others;
  }
  double max_thickness() const
  {
    return cloth_meets_cloth ? std::max(cloth.thickness, others.thickness) : others.thickness;
  }
  double max_friction() const { return std::max(cloth.friction, others.friction); }
};

struct ContactCounts {
  double contacts = 0.0;    // impulses that were exchanged
  double stops = 0.0;       // particles that were put back to their side behind the solver
  double frozen = 0.0;      // particles that were caught between triangles and moved with them
  double deepest = 0.0;     // largest missing gap before it was closed
  double seconds = 0.0;     // of wall time
  double impulse[3] = {0.0, 0.0, 0.0};    // on held vertices
  // the first three of cloth on cloth, and the smallest distance at the start of the last step
  double cloth_contacts = 0.0, cloth_stops = 0.0, cloth_frozen = 0.0;
  double cloth_gap = 0.0;
  // in the last step, momentum of particles: passed on in the solver, and missing behind it
  double passed_on = 0.0, missed = 0.0;
};

// wall time, added up at the end of a block

class WallTimer {
 public:
  explicit WallTimer(double &sum_) : sum(sum_), begin(platform::walltime()) {}
  ~WallTimer() { sum += platform::walltime() - begin; }

 private:
  double &sum;
  const double begin;
};

}    // namespace LAMMPS_NS

#endif
