// SPDX-License-Identifier: GPL-2.0-or-later
// Layout of LAMMPS 4 Feb to 22 Jul 2025; see README.md in this folder.

#ifndef LMP_INTEGRATE_H
#define LMP_INTEGRATE_H

#include "compute.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {

class Integrate : protected Pointers {
 public:
  Integrate(class LAMMPS *, int, char **);
  virtual void init();
  virtual void setup(int) = 0;
  virtual void setup_minimal(int) = 0;
  virtual void run(int) = 0;
  virtual void force_clear() = 0;
  virtual void cleanup() {}
  virtual void reset_dt() {}
  virtual double memory_usage() { return 0; }

 protected:
  int eflag, vflag, virial_style, external_force_clear;
  std::vector<Compute *> elist_global, elist_atom, vlist_global, vlist_atom, cvlist_atom;
  int pair_compute_flag, kspace_compute_flag;

  void ev_setup();
  void ev_set(bigint);
};

}    // namespace LAMMPS_NS

#endif
