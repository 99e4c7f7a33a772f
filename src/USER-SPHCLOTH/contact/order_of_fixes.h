// SPDX-License-Identifier: GPL-2.0-or-later
// Fixes that have to be defined before contact.

#ifndef SPHCLOTH_CONTACT_ORDER_OF_FIXES_H
#define SPHCLOTH_CONTACT_ORDER_OF_FIXES_H

#include <string>

namespace LAMMPS_NS {

class Fix;

// A warning for each fix behind this one that moves particles across the cloth.
void warn_of_reflection_after(class LAMMPS *, const Fix *contact, const std::string &label);

}    // namespace LAMMPS_NS

#endif
