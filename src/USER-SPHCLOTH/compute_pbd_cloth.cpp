// SPDX-License-Identifier: GPL-2.0-or-later
// Values of fix pbd/cloth under the names that the user gives.

#include "compute_pbd_cloth.h"

using namespace LAMMPS_NS;

// the vector of fix pbd/cloth

static const std::vector<NamedValue> &values_of_cloth()
{
  static const std::vector<NamedValue> VALUES = {
      {"force/x", 1, NamedValue::EXTENSIVE},      {"force/y", 2, NamedValue::EXTENSIVE},
      {"force/z", 3, NamedValue::EXTENSIVE},      {"strain", 4, NamedValue::INTENSIVE},
      {"residual", 5, NamedValue::INTENSIVE},     {"sweeps", 6, NamedValue::INTENSIVE},
      {"energy", 7, NamedValue::EXTENSIVE},       {"halfkick/x", 8, NamedValue::EXTENSIVE},
      {"halfkick/y", 9, NamedValue::EXTENSIVE},   {"halfkick/z", 10, NamedValue::EXTENSIVE},
      {"unconverged", 11, NamedValue::INTENSIVE},
  };
  return VALUES;
}

/* ----------------------------------------------------------------------
   compute ID group pbd/cloth keyword ...
------------------------------------------------------------------------- */

ComputePBDCloth::ComputePBDCloth(LAMMPS *lmp_, int narg, char **arg) :
    NamedValues(lmp_, narg, arg, "pbd/cloth", values_of_cloth())
{
}
