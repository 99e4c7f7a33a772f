// SPDX-License-Identifier: GPL-2.0-or-later
// Fixes that have to be defined before contact.

#include "contact/order_of_fixes.h"

#include "comm.h"
#include "error.h"
#include "fix.h"
#include "modify.h"

void LAMMPS_NS::warn_of_reflection_after(LAMMPS *lmp, const Fix *contact, const std::string &label)
{
  if (lmp->comm->me) return;
  bool behind = false;
  for (const Fix *fix : lmp->modify->get_fix_list()) {
    behind = behind || fix == contact;
    if (behind && utils::strmatch(fix->style, "^wall/reflect"))
      lmp->error->warning(FLERR,
                          "{}: fix {} {} is defined after it and moves particles that contact has "
                          "stopped at the cloth: define it before",
                          label, fix->id, fix->style);
  }
}
