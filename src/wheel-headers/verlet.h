// SPDX-License-Identifier: GPL-2.0-or-later
// Layout of LAMMPS 4 Feb to 22 Jul 2025; see README.md in this folder.

#ifndef LMP_VERLET_H
#define LMP_VERLET_H

#include "integrate.h"

namespace LAMMPS_NS {

class Verlet : public Integrate {
 public:
  Verlet(class LAMMPS *, int, char **);
  void init() override;
  void setup(int) override;
  void setup_minimal(int) override;
  void run(int) override;
  void force_clear() override;
  void cleanup() override;

 protected:
  int triclinic, torqueflag, extraflag;
};

}    // namespace LAMMPS_NS

#endif
