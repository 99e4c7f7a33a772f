// SPDX-License-Identifier: GPL-2.0-or-later
// First members of LAMMPS 29 Aug 2024 to 22 Jul 2025; see README.md in this folder.

#ifndef LMP_FIX_SET_FORCE_H
#define LMP_FIX_SET_FORCE_H

#include "fix.h"

namespace LAMMPS_NS {

class FixSetForce : public Fix {
 public:
  FixSetForce(class LAMMPS *, int, char **);
  ~FixSetForce() override;

 protected:
  double xvalue, yvalue, zvalue;
  int varflag;
  char *xstr, *ystr, *zstr;
  char *idregion;
  class Region *region;
  int xvar, yvar, zvar, xstyle, ystyle, zstyle;
};

}    // namespace LAMMPS_NS

#endif
