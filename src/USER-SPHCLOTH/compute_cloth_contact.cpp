// SPDX-License-Identifier: GPL-2.0-or-later
// Values of fix cloth/contact under the names that the user gives.

#include "compute_cloth_contact.h"

using namespace LAMMPS_NS;

// the vector of fix cloth/contact

static const std::vector<NamedValue> &values_of_contact()
{
  static const std::vector<NamedValue> VALUES = {
      {"contacts", 1, NamedValue::EXTENSIVE},     {"stops", 2, NamedValue::EXTENSIVE},
      {"caught", 3, NamedValue::EXTENSIVE},       {"overlap", 4, NamedValue::INTENSIVE},
      {"impulse/x", 5, NamedValue::EXTENSIVE},    {"impulse/y", 6, NamedValue::EXTENSIVE},
      {"impulse/z", 7, NamedValue::EXTENSIVE},    {"force/x", 8, NamedValue::EXTENSIVE},
      {"force/y", 9, NamedValue::EXTENSIVE},      {"force/z", 10, NamedValue::EXTENSIVE},
      {"cpu", 11, NamedValue::INTENSIVE},         {"cloth/contacts", 12, NamedValue::EXTENSIVE},
      {"cloth/stops", 13, NamedValue::EXTENSIVE}, {"cloth/caught", 14, NamedValue::EXTENSIVE},
      {"cloth/gap", 15, NamedValue::INTENSIVE},
  };
  return VALUES;
}

/* ----------------------------------------------------------------------
   compute ID group cloth/contact keyword ...
------------------------------------------------------------------------- */

ComputeClothContact::ComputeClothContact(LAMMPS *lmp_, int narg, char **arg) :
    NamedValues(lmp_, narg, arg, "cloth/contact", values_of_contact())
{
}
