// SPDX-License-Identifier: GPL-2.0-or-later
// One mesh that particles meet, and on which side of it they are.

#ifndef SPHCLOTH_CONTACT_CONTACT_SURFACE_H
#define SPHCLOTH_CONTACT_CONTACT_SURFACE_H

#include "contact/moving_triangles.h"
#include "contact/sheet_sides.h"

#include <string>

namespace LAMMPS_NS {

struct ContactSurface {
  // see MovingTriangles
  ContactSurface(LAMMPS *lmp, ContactMesh *mesh, const std::string &label, int groupbits,
                 const ContactRules &rules, ContactCounts &counts, StepStart &step_start) :
      triangles(lmp, mesh, label, groupbits, rules, counts, step_start), sides(lmp, triangles)
  {
  }
  ContactSurface(const ContactSurface &) = delete;    // one refers to the other
  ContactSurface &operator=(const ContactSurface &) = delete;

  MovingTriangles triangles;
  SheetSides sides;

  double memory_usage() const { return triangles.memory_usage() + sides.memory_usage(); }
};

}    // namespace LAMMPS_NS

#endif
