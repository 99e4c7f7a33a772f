// SPDX-License-Identifier: GPL-2.0-or-later
// Two sides that may meet: a vertex or a particle and a triangle, or two edges.

#ifndef SPHCLOTH_CONTACT_CONTACT_PAIR_H
#define SPHCLOTH_CONTACT_CONTACT_PAIR_H

#include "contact/contact_rules.h"
#include "core/contact/closest_points.h"

#include <array>

namespace LAMMPS_NS {

struct ContactPair {
  sphcloth::PairKind kind;
  std::array<int, 4> slots;    // vertex or particle, and triangle; or two edges
  std::array<int, 2> members;    // triangle: the second; edges: both
  Meeting meeting;
};

}    // namespace LAMMPS_NS

#endif
