// SPDX-License-Identifier: GPL-2.0-or-later
// What knows on which side of sheets particles are, so that fluid on two sides does not interact:
// fix cloth/contact.

#ifndef SPHCLOTH_FLUID_SIDE_SOURCE_H
#define SPHCLOTH_FLUID_SIDE_SOURCE_H

#include "core/contact/sheet_sides.h"

namespace LAMMPS_NS {

class SideSource {
 public:
  // name of a fix's extract() for it, null if its sheets do not part the fluid
  static constexpr const char *EXTRACT = "fluid_sides";

  // of all particles, owned and ghost
  virtual const sphcloth::Sides *sides() const = 0;
  // null: none of them is near a sheet
  virtual sphcloth::Parting *layers() = 0;
  // sheets matter up to this distance from a particle
  virtual void set_view_distance(double distance) = 0;

 protected:
  ~SideSource() noexcept(false) = default;
};

}    // namespace LAMMPS_NS

#endif
