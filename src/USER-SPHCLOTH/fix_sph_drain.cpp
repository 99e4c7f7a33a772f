// SPDX-License-Identifier: GPL-2.0-or-later
// An outflow.  It works just before LAMMPS would lose what left the box: at list builds, and when
// commands set up the system to move atoms to other ranks, as write_restart does.

#include "fix_sph_drain.h"

#include "atom.h"
#include "atom_vec.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_sph_integrate.h"
#include "group.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/box_faces.h"
#include "lammps_util/rank_error.h"
#include "lammps_util/restart_record.h"
#include "modify.h"
#include "region.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;

/* ----------------------------------------------------------------------
   fix ID group sph/drain keyword value ...
------------------------------------------------------------------------- */

FixSPHDrain::FixSPHDrain(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} sph/drain", id)), region(nullptr), drained(0),
    taken{}
{
  restart_global = 1;
  scalar_flag = vector_flag = 1;
  size_vector = 4;
  global_freq = 1;
  extscalar = extvector = 0;
  dynamic_group_allow = 1;

  ArgReader args(lmp, label, narg, arg, 3);
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword != "region") args.unknown(keyword, "region");
    const std::string name = args.word("region");
    if (!region_name.empty())
      args.fail("region", name, "there is one already: give the union of several");
    region_name = name;
    if (!domain->get_region_by_id(region_name))
      args.fail("region", region_name, "define it with the region command first");
  }
}

int FixSPHDrain::setmask() { return PRE_EXCHANGE; }

void FixSPHDrain::init()
{
  region = nullptr;
  if (!region_name.empty()) {
    region = domain->get_region_by_id(region_name);
    if (!region)
      error->all(FLERR, "{}: region {} is gone: define it again or delete the fix", label,
                 region_name);
    region->init();
  }
  check_group();
  remove();
}

void FixSPHDrain::check_group()
{
  if (!atom->num_bond) return;
  int mine = 0, any = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit && atom->num_bond[i] > 0) mine = 1;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (any)
    error->all(
        FLERR,
        "{}: group {} holds bonded atoms: cloth cannot be drained, give the group of the fluid",
        label, group->names[igroup]);
}

// out of the box through a fixed face, or inside the region

bool FixSPHDrain::leaves(int i) const
{
  const double *x = atom->x[i];
  if (!std::isfinite(0.0 * x[0] + 0.0 * x[1] + 0.0 * x[2]))
    rank_error(lmp, FLERR,
               "{}: particle {} is at {} {} {}: it does not leave, the run has failed; look at the "
               "forces on it, or take a smaller time step",
               label, atom->tag[i], x[0], x[1], x[2]);
  if (face_left(domain, x) >= 0) return true;
  return region && region->match(x[0], x[1], x[2]);
}

// Water that sleeps beside what leaves may have rested on it.

void FixSPHDrain::pre_exchange()
{
  const std::vector<Position> removed = remove();
  FixSPHIntegrate *steps = FixSPHIntegrate::find(modify);
  if (steps && steps->lets_sleep()) steps->wake_beside(allgather(removed, comm->nprocs, world));
}

// by this rank; collective

std::vector<FixSPHDrain::Position> FixSPHDrain::remove()
{
  if (region) region->prematch();
  double mine[5] = {}, all[5];    // count, mass, momentum
  std::vector<Position> removed;
  for (int i = 0; i < atom->nlocal;) {
    if (!(atom->mask[i] & groupbit) || !leaves(i)) {
      i++;
      continue;
    }
    const double mass = atom_mass(atom, i);
    mine[0] += 1.0;
    mine[1] += mass;
    for (int d = 0; d < 3; d++) mine[2 + d] += mass * atom->v[i][d];
    removed.push_back({atom->x[i][0], atom->x[i][1], atom->x[i][2]});
    atom->avec->copy(atom->nlocal - 1, i, 1);
    atom->nlocal--;
  }
  MPI_Allreduce(mine, all, 5, MPI_DOUBLE, MPI_SUM, world);
  if (all[0] == 0.0) return removed;
  const auto gone = static_cast<bigint>(all[0]);
  drained += gone;
  atom->natoms -= gone;
  for (int k = 0; k < 4; k++) taken[k] += all[1 + k];
  refresh_map(atom);
  return removed;
}

struct FixSPHDrain::Record {
  bigint drained;
  double taken[4];
};

void FixSPHDrain::write_restart(FILE *fp)
{
  if (comm->me) return;
  write_record(fp, Record{drained, {taken[0], taken[1], taken[2], taken[3]}});
}

void FixSPHDrain::restart(char *buf)
{
  const auto record = read_record<Record>(buf, label, error);
  drained = record.drained;
  std::copy(record.taken, record.taken + 4, taken);
}
