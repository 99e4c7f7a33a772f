// SPDX-License-Identifier: GPL-2.0-or-later
// Are lists of atom indices still those of the atoms?  Between runs write_restart, write_data,
// balance and others initialize LAMMPS anew and may move atoms to other ranks and places, and make
// other ghosts.  A run without setup then goes on with the lists.

#ifndef SPHCLOTH_LAMMPS_UTIL_LIST_GUARD_H
#define SPHCLOTH_LAMMPS_UTIL_LIST_GUARD_H

#include "atom.h"
#include "error.h"
#include "lammps_util/atom_tools.h"
#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

class ListGuard : protected Pointers {
 public:
  explicit ListGuard(LAMMPS *lmp_) : Pointers(lmp_) {}

  void initialized() { in_doubt = true; }

  void lists_are_new()
  {
    in_doubt = false;
    order = order_of_all();
  }

  // collective, before lists are used again
  void check(const std::string &label)
  {
    if (!in_doubt) return;
    in_doubt = false;
    const int mine = order != order_of_all();
    int any;
    MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
    if (any) error->all(FLERR, "{}: {}", label, REMEDY);
  }

  static constexpr const char *REMEDY =
      "LAMMPS was initialized anew since the last setup, as write_restart, write_data and balance "
      "do: leave 'pre no' out of run, or give write_restart and write_data 'noinit'";

 private:
  bool in_doubt = true;
  std::uint64_t order = 0;

  std::uint64_t order_of_all() const
  {
    return hash_with(order_of_atoms(atom, atom->nlocal + atom->nghost),
                     static_cast<std::uint64_t>(atom->nlocal));
  }
};

}    // namespace LAMMPS_NS

#endif
