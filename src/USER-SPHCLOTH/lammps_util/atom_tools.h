// SPDX-License-Identifier: GPL-2.0-or-later
// What several styles ask of atoms and of the clock.

#ifndef SPHCLOTH_LAMMPS_UTIL_ATOM_TOOLS_H
#define SPHCLOTH_LAMMPS_UTIL_ATOM_TOOLS_H

#include "atom.h"
#include "atom_vec.h"
#include "domain.h"
#include "error.h"
#include "group.h"
#include "lammps.h"
#include "update.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace LAMMPS_NS {

inline double atom_mass(const Atom *atom, int i)
{
  return atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
}

// Other velocities have another one, but by chance: it tells what something else has changed
// between two runs.

inline double fingerprint_of(const double *v)
{
  return v[0] + 1.6180339887 * v[1] + 2.7182818 * v[2];
}

// FNV-1a

inline constexpr std::uint64_t EMPTY_HASH = 0xcbf29ce484222325U;
inline std::uint64_t hash_with(std::uint64_t hash, std::uint64_t number)
{
  return (hash ^ number) * 0x100000001b3U;
}
inline std::uint64_t hash_with(std::uint64_t hash, std::string_view words)
{
  for (const char c : words)
    hash = hash_with(hash, static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
  return hash;
}

// A number that changes when the first n atoms, or their places in the arrays, do.

inline std::uint64_t order_of_atoms(const Atom *atom, int n)
{
  std::uint64_t hash = EMPTY_HASH;
  for (int i = 0; i < n; i++) hash = hash_with(hash, static_cast<std::uint64_t>(atom->tag[i]));
  return hash;
}
inline std::uint64_t order_of_atoms(const Atom *atom) { return order_of_atoms(atom, atom->nlocal); }

inline std::uint64_t bits_of(double number)
{
  std::uint64_t bits;
  std::memcpy(&bits, &number, sizeof(bits));
  return bits;
}

// at the end of the current step

inline double physical_time(const Update *update)
{
  return update->atime + static_cast<double>(update->ntimestep - update->atimestep) * update->dt;
}

// For fixes that are restored.  LAMMPS, where a run begins, would forget the time between the last
// change of dt and a restart file that was written in the middle of a run.

inline void keep_restored_time(Update *update) { update->update_time(); }

// collective: is any atom in both groups?

inline bool share_atoms(const Atom *atom, int groupbit, int other_groupbit, MPI_Comm world)
{
  int mine = 0, any = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit && atom->mask[i] & other_groupbit) mine = 1;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  return any;
}

// of a keyword that reads its group at list builds or where a run begins

inline void refuse_dynamic_group(LAMMPS *lmp, const std::string &label, const std::string &keyword,
                                 int igroup)
{
  const char *name = lmp->group->names[igroup];
  if (lmp->group->dynamic[igroup])
    lmp->error->all(FLERR,
                    "{}: {} group {} is dynamic, and its atoms must stay the same within a run: "
                    "keep those that are in it now with 'group {} static', and change them "
                    "between runs",
                    label, keyword, name, name);
}

// collective: the first of the IDs of n new atoms, above those that are there or have been

inline tagint first_free_id(LAMMPS *lmp, const std::string &label, bigint n, tagint been = 0)
{
  const Atom *atom = lmp->atom;
  tagint mine = been, all = 0;
  for (int i = 0; i < atom->nlocal; i++) mine = std::max(mine, atom->tag[i]);
  MPI_Allreduce(&mine, &all, 1, MPI_LMP_TAGINT, MPI_MAX, lmp->world);
  if (n > MAXTAGINT - all)
    lmp->error->all(FLERR,
                    "{}: the largest atom ID is {}, too large for {} atoms more: renumber them "
                    "with 'reset_atoms id'",
                    label, all, n);
  return all + 1;
}

// collective: every rank's list behind one another

template <class Record>
void allgather(const std::vector<Record> &mine, std::vector<Record> &all, int nprocs,
               MPI_Comm world)
{
  static_assert(std::is_trivially_copyable_v<Record>);
  const int n = static_cast<int>(mine.size());
  std::vector<int> counts(nprocs), displs(nprocs, 0);
  MPI_Allgather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 1; p < nprocs; p++) displs[p] = displs[p - 1] + counts[p - 1];
  all.resize(displs.back() + counts.back());
  MPI_Datatype record;    // bytes would pass the largest int
  MPI_Type_contiguous(sizeof(Record), MPI_BYTE, &record);
  MPI_Type_commit(&record);
  MPI_Allgatherv(mine.data(), n, record, all.data(), counts.data(), displs.data(), record, world);
  MPI_Type_free(&record);
}

template <class Record>
std::vector<Record> allgather(const std::vector<Record> &mine, int nprocs, MPI_Comm world)
{
  std::vector<Record> all;
  allgather(mine, all, nprocs, world);
  return all;
}

// An atom of this rank, in group all and in those of groupbits; its local index, or -1 if the place
// belongs to another rank.

inline int create_owned_atom(Atom *atom, Domain *domain, tagint tag, int type,
                             const double *position, int groupbits)
{
  double x[3] = {position[0], position[1], position[2]};
  imageint image = (imageint(IMGMAX) << IMG2BITS) | (imageint(IMGMAX) << IMGBITS) | IMGMAX;
  if (!domain->ownatom(static_cast<int>(tag), x, &image, 0)) return -1;
  atom->avec->create_atom(type, x);
  const int i = atom->nlocal - 1;
  atom->tag[i] = tag;
  atom->image[i] = image;
  atom->mask[i] = 1 | groupbits;
  return i;
}

// after atoms came or went: ghosts are void, IDs are found anew

inline void refresh_map(Atom *atom)
{
  if (atom->map_style == Atom::MAP_NONE) return;
  atom->nghost = 0;
  atom->map_init();
  atom->map_set();
}

}    // namespace LAMMPS_NS

#endif
