// SPDX-License-Identifier: GPL-2.0-or-later
// Faces behind which LAMMPS loses atoms when it builds lists.

#ifndef SPHCLOTH_LAMMPS_UTIL_BOX_FACES_H
#define SPHCLOTH_LAMMPS_UTIL_BOX_FACES_H

#include "atom.h"
#include "domain.h"
#include "lammps.h"
#include "lammps_util/rank_error.h"

#include <string>

namespace LAMMPS_NS {

// the fixed face of the box behind which this is, as 2 * direction, + 1 for the upper one, or -1

inline int face_left(Domain *domain, const double *x)
{
  double lamda[3];
  const double *position = x, *lo = domain->boxlo, *hi = domain->boxhi;
  if (domain->triclinic) {
    domain->x2lamda(const_cast<double *>(x), lamda);
    position = lamda;
    lo = domain->boxlo_lamda;
    hi = domain->boxhi_lamda;
  }
  for (int d = 0; d < 3; d++) {
    if (position[d] < lo[d] && domain->boundary[d][0] == 1) return 2 * d;
    if (position[d] >= hi[d] && domain->boundary[d][1] == 1) return 2 * d + 1;
  }
  return -1;
}

// Vertices of this rank, before LAMMPS loses them and misses atoms of their bonds or angles.

inline void require_inside_box(LAMMPS *lmp, const std::string &label, int groupbit)
{
  static constexpr const char *FACES[] = {"xlo", "xhi", "ylo", "yhi", "zlo", "zhi"};
  const Atom *atom = lmp->atom;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const int face = face_left(lmp->domain, atom->x[i]);
    if (face < 0) continue;
    rank_error(lmp, FLERR,
               "{}: vertex {} leaves the box through its fixed face {}, at {:g} {:g} {:g}: take a "
               "larger box, or 'boundary' m for this face",
               label, atom->tag[i], FACES[face], atom->x[i][0], atom->x[i][1], atom->x[i][2]);
  }
}

}    // namespace LAMMPS_NS

#endif
