// SPDX-License-Identifier: GPL-2.0-or-later
// compute cloth/contact: what fix cloth/contact knows of all contacts, by keyword.

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(cloth/contact,ComputeClothContact);
// clang-format on
#else

#ifndef LMP_COMPUTE_CLOTH_CONTACT_H
#define LMP_COMPUTE_CLOTH_CONTACT_H

#include "lammps_util/named_values.h"

namespace LAMMPS_NS {

class ComputeClothContact : public NamedValues {
 public:
  ComputeClothContact(class LAMMPS *, int, char **);
};

}    // namespace LAMMPS_NS

#endif
#endif
