// SPDX-License-Identifier: GPL-2.0-or-later
// compute pbd/cloth: what fix pbd/cloth knows of the whole cloth, by keyword.

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(pbd/cloth,ComputePBDCloth);
// clang-format on
#else

#ifndef LMP_COMPUTE_PBD_CLOTH_H
#define LMP_COMPUTE_PBD_CLOTH_H

#include "lammps_util/named_values.h"

namespace LAMMPS_NS {

class ComputePBDCloth : public NamedValues {
 public:
  ComputePBDCloth(class LAMMPS *, int, char **);
};

}    // namespace LAMMPS_NS

#endif
#endif
