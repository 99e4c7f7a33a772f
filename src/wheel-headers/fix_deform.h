// SPDX-License-Identifier: GPL-2.0-or-later
// First members of LAMMPS 4 Feb to 22 Jul 2025; see README.md in this folder.

#ifndef LMP_FIX_DEFORM_H
#define LMP_FIX_DEFORM_H

#include "fix.h"

namespace LAMMPS_NS {

class FixDeform : public Fix {
 public:
  int remapflag;

  FixDeform(class LAMMPS *, int, char **);
  ~FixDeform() override;
};

}    // namespace LAMMPS_NS

#endif
