// SPDX-License-Identifier: GPL-2.0-or-later
// One column per keyword, from the last evaluation of the pair style.

#include "compute_sph_atom.h"

#include "atom.h"
#include "error.h"
#include "fix_cloth_contact.h"
#include "fix_sph_integrate.h"
#include "fluid/fluid_state.h"
#include "fluid/side_source.h"
#include "force.h"
#include "lammps_util/arg_reader.h"
#include "memory.h"
#include "modify.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

/* ----------------------------------------------------------------------
   compute ID group sph/atom keyword ...
------------------------------------------------------------------------- */

ComputeSPHAtom::ComputeSPHAtom(LAMMPS *lmp_, int narg, char **arg) :
    Compute(lmp_, narg, arg), label(fmt::format("compute {} sph/atom", id)), nmax(0),
    fluid(nullptr), stepper(nullptr), sheets(nullptr)
{
  ArgReader args(lmp, label, narg, arg, 3);
  do columns.push_back(read_column(args));
  while (args.more());

  peratom_flag = 1;
  size_peratom_cols = columns.size() == 1 ? 0 : static_cast<int>(columns.size());
}

ComputeSPHAtom::~ComputeSPHAtom()
{
  memory->destroy(vector_atom);
  memory->destroy(array_atom);
}

ComputeSPHAtom::Column ComputeSPHAtom::read_column(ArgReader &args) const
{
  static const std::vector<std::string> NAMES = {
      "density", "pressure", "energy", "sound", "volume", "neighbors", "dt", "active", "side"};
  const std::string name = args.word("keyword");
  const auto found = std::find(NAMES.begin(), NAMES.end(), name);
  if (found == NAMES.end()) args.unknown(name, utils::join_words(NAMES, ", "));
  return static_cast<Column>(found - NAMES.begin());
}

bool ComputeSPHAtom::asks_for(Column column) const
{
  return std::find(columns.begin(), columns.end(), column) != columns.end();
}

void ComputeSPHAtom::init() { find_styles(); }

// Also before every use: the user may have replaced a style since init().

void ComputeSPHAtom::find_styles()
{
  fluid = FluidState::find(force);
  if (!fluid)
    error->all(FLERR, "{}: pair_style {} knows nothing of fluid: use 'pair_style sph/tait'", label,
               force->pair_style ? force->pair_style : "none");
  if (asks_for(Column::SIDE)) {
    const auto contacts = modify->get_fix_by_style("^cloth/contact$");
    if (contacts.empty())
      error->all(FLERR,
                 "{}: sides are known to fix cloth/contact alone: add that fix, or leave the "
                 "keyword out",
                 label);
    sheets = nullptr;    // of several, the one that parts the fluid
    for (Fix *contact : contacts) {
      int dim = 0;
      if (!sheets || contact->extract(SideSource::EXTRACT, dim))
        sheets = dynamic_cast<FixClothContact *>(contact);
    }
  }
  if (!asks_for(Column::DT) && !asks_for(Column::ACTIVE)) return;
  stepper = FixSPHIntegrate::find(modify);
  if (!stepper)
    error->all(FLERR,
               "{}: dt and active are known to fix sph/integrate alone: add that fix, or leave "
               "the two keywords out",
               label);
}

void ComputeSPHAtom::check_evaluated() const
{
  int mine = fluid->evaluated(), all = 0;
  MPI_Allreduce(&mine, &all, 1, MPI_INT, MPI_MIN, world);
  if (!all)
    error->all(FLERR,
               "{}: the pair style has not evaluated these particles: use it in or after a run, "
               "'run 0' at least",
               label);
}

/* ---------------------------------------------------------------------- */

void ComputeSPHAtom::compute_peratom()
{
  invoked_peratom = update->ntimestep;
  find_styles();
  check_evaluated();
  make_room();
  const int n = static_cast<int>(columns.size());
  for (int i = 0; i < atom->nlocal; i++) {
    double *row = n == 1 ? vector_atom + i : array_atom[i];
    for (int k = 0; k < n; k++) row[k] = atom->mask[i] & groupbit ? value(columns[k], i) : 0.0;
  }
}

void ComputeSPHAtom::make_room()
{
  if (atom->nmax <= nmax) return;
  nmax = atom->nmax;
  if (size_peratom_cols == 0)
    memory->grow(vector_atom, nmax, "sph/atom:vector");
  else
    memory->grow(array_atom, nmax, size_peratom_cols, "sph/atom:array");
}

double ComputeSPHAtom::value(Column column, int i) const
{
  const bool integrated = stepper && atom->mask[i] & stepper->groupbit;
  switch (column) {
    case Column::NEIGHBORS: return fluid->count_neighbors(i);
    case Column::DT: return integrated ? stepper->own_step(i) : 0.0;
    case Column::SIDE: return sheets->side_of(i);
    case Column::ACTIVE: return integrated && stepper->is_active(i);
    default: break;
  }
  if (fluid->is_fluid(atom->type[i])) return value_of_fluid(column, i);
  return column == Column::VOLUME && fluid->is_boundary(atom->type[i]) ? fluid->mass_or_volume_of(i)
                                                                       : 0.0;
}

double ComputeSPHAtom::value_of_fluid(Column column, int i) const
{
  const Tait &eos = fluid->equation_of_state(atom->type[i]);
  const double rho = atom->rho[i];
  switch (column) {
    case Column::DENSITY: return rho;
    case Column::PRESSURE: return fluid->pressure_of(i) * force->mvv2e * force->nktv2p;
    case Column::ENERGY:
      return fluid->mass_or_volume_of(i) * fluid->stored_energy(eos, rho) * force->mvv2e;
    case Column::SOUND: return eos.sound_speed(rho);
    case Column::VOLUME: return fluid->mass_or_volume_of(i) / rho;
    default: return 0.0;
  }
}

double ComputeSPHAtom::memory_usage()
{
  return sizeof(double) * static_cast<double>(nmax) * static_cast<double>(columns.size());
}
