// SPDX-License-Identifier: GPL-2.0-or-later
// Exported functions of LAMMPS 4 Feb to 22 Jul 2025; see README.md in this folder.

#ifndef LMP_ATOM_VEC_H
#define LMP_ATOM_VEC_H

namespace LAMMPS_NS {

class AtomVec {
 public:
  void create_atom(int, double *);
  void copy(int, int, int);
};

}    // namespace LAMMPS_NS

#endif
