// SPDX-License-Identifier: GPL-2.0-or-later
// An error that one rank finds, while the others go on.

#ifndef SPHCLOTH_LAMMPS_UTIL_RANK_ERROR_H
#define SPHCLOTH_LAMMPS_UTIL_RANK_ERROR_H

#include "error.h"
#include "lammps.h"
#include "platform.h"
#include "universe.h"

#include <string>
#include <utility>

namespace LAMMPS_NS {

// As Error::one().  It ends all ranks, and a launcher may stop them before it has passed on what
// this one printed: it waits for that.

template <class... Words>
[[noreturn]] void rank_error(LAMMPS *lmp, const char *file, int line, const std::string &format,
                             Words &&...words)
{
  constexpr double TIMEOUT = 1.0;    // in s of wall time
  try {
    lmp->error->one(file, line, format, std::forward<Words>(words)...);
  } catch (...) {
    if (lmp->universe->nprocs > 1) platform::usleep(static_cast<int>(TIMEOUT * 1e6));
    throw;
  }
}

}    // namespace LAMMPS_NS

#endif
