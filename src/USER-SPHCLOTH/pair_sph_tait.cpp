// SPDX-License-Identifier: GPL-2.0-or-later
// Weakly compressible SPH: density summation (1), momentum (2), Tait equation of state (3). Here
// are its arguments, virial, energy, ghosts and restart.  The phases of an evaluation are in
// fluid/fluid_evaluation.cpp, the sums in density_loops.h, force_loops.h and rate_loops.h of
// core/sph, the types in fluid/sph_materials.cpp, queries in fluid/fluid_state.cpp.

#include "pair_sph_tait.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "lammps_util/default_skin.h"
#include "lammps_util/lammps_version.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using namespace sphcloth;

static const std::string STYLE = "pair_style sph/tait";

/* ---------------------------------------------------------------------- */

PairSPHTait::PairSPHTait(LAMMPS *lmp_) : Pair(lmp_), fluid(lmp_, this, *this)
{
  restartinfo = 1;
  single_enable = 0;
  manybody_flag = 1;
  writedata = 1;
  no_virial_fdotr_compute = 1;
  comm_forward = 2;
  comm_reverse = FluidEvaluation::ghost_size(GhostData::IMPULSE);
}

PairSPHTait::~PairSPHTait()
{
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
  }
}

void PairSPHTait::allocate()
{
  allocated = 1;
  const int n = atom->ntypes + 1;
  memory->create(setflag, n, n, "pair:setflag");
  memory->create(cutsq, n, n, "pair:cutsq");
  for (int i = 1; i < n; i++)
    for (int j = i; j < n; j++) setflag[i][j] = 0;
  fluid.allocate();
}

/* ----------------------------------------------------------------------
   pair_style sph/tait H keyword value ...
------------------------------------------------------------------------- */

void PairSPHTait::settings(int narg, char **arg)
{
  fluid.forget();
  fluid.read_options(narg, arg);
  if (allocated) fluid.lattices.set_masses();
}

void PairSPHTait::coeff(int narg, char **arg)
{
  if (!allocated) allocate();
  fluid.read(narg, arg, setflag);
  fluid.lattices.set_masses();
}

/* ---------------------------------------------------------------------- */

void PairSPHTait::init_style()
{
  if (!atom->rho_flag)
    error->all(FLERR,
               "{}: atom_style {} has no density: use atom_style sph, or hybrid sph molecular "
               "for a scene with cloth",
               STYLE, atom->atom_style);
  if (!comm->ghost_velocity)
    error->all(FLERR, "{}: ghost atoms have no velocity: add 'comm_modify vel yes'", STYLE);
  if (neighbor->nex_group || neighbor->nex_mol)
    error->all(FLERR,
               "{}: neigh_modify exclude group or molecule would hide neighbors from the sums: "
               "exclude types, or remove it; boundary particles leave each other out by their role",
               STYLE);
  // write_data and others initialize as well, and may come before the fix
  const bool begins_run = update->whichflag != 0;
  if (begins_run && fluid.sound_follows() && modify->get_fix_by_style("^sph/integrate$").empty())
    error->all(FLERR,
               "{}: c0 follows the flow where fix sph/integrate takes the steps: add it, or give a "
               "constant 'c0 C'",
               STYLE);
  if (update->whichflag == 2 && fluid.integrates_density())
    error->all(FLERR,
               "{}: minimize moves particles without velocities, and 'density continuity' follows "
               "velocities: use 'density summation' or 'density calibrated'",
               STYLE);
  if (fluid.options.precision == sphcloth::Precision::MIXED) check_range();
  choose_skin();
  fluid.lattices.set_masses();    // 'mass' may have come since
  comm_forward = FluidEvaluation::LARGEST_GHOST_SIZE;
  fluid.begin_run();
}

// The defaults of LAMMPS are for molecules: 1 mm in SI units, whatever the support.  Beside another
// pair style its lists may need what they have.

void PairSPHTait::choose_skin() const
{
  constexpr double OF_SUPPORT = 0.5, JUST_ABOVE = 1.0001;    // as one that is given
  const double usual = default_skin(update->unit_style);
  if (neighbor->skin != usual) return;
  double support = 0.0;
  for (int t = 1; t <= atom->ntypes; t++) support = std::max(support, fluid.support(t));
  const double skin = OF_SUPPORT * support;
  if (skin == usual || (skin < usual && force->pair != this)) return;
  neighbor->skin = skin;
  if (comm->me == 0)
    utils::logmesg(
        lmp,
        "{}: neighbor skin {:g}, half of the support, in the place of {:g}, the default "
        "of units {}: give it by 'neighbor' if another one is faster, as {:g} for the default\n",
        STYLE, skin, usual, update->unit_style, JUST_ABOVE * usual);
}

// Only lengths are in a unit of their own.

void PairSPHTait::check_range()
{
  constexpr double LARGEST = 1e30;
  for (int t = 1; t <= atom->ntypes; t++) {
    if (!fluid.is_fluid(t)) continue;
    const double rho0 = fluid.equation_of_state(t).rho0;
    const double sound = fluid.equation_of_state(t).sound_speed();
    for (const double number : {rho0, sound, sound * sound / rho0})
      if (!(number > 1.0 / LARGEST && number < LARGEST))
        error->all(
            FLERR,
            "{}: precision mixed: density {:.3g}, speed of sound {:.3g} and c0^2/rho0 {:.3g} "
            "of type {} must be between {:.0e} and {:.0e}: take 'precision double', or other "
            "units",
            STYLE, rho0, sound, sound * sound / rho0, t, 1.0 / LARGEST, LARGEST);
  }
}

double PairSPHTait::init_one(int i, int j)
{
  const double radius = fluid.support(i, j);

  // LAMMPS counts the images of a box within the cut-off in an int, and makes ghosts of all of them
  constexpr double MAX_BOXES = 1000.0, MAX_IMAGES = 1000.0;
  const double box = std::max({domain->prd[0], domain->prd[1], domain->prd[2]});
  double images = 1.0;
  for (int d = 0; d < domain->dimension; d++)
    if (domain->periodicity[d]) images *= 1.0 + 2.0 * radius / domain->prd[d];
  if (radius > MAX_BOXES * box || images > MAX_IMAGES)
    error->all(
        FLERR,
        "{}: the support {} of types {} and {} is {:.3g} times the box, {}, and reaches over "
        "{:.3g} images of it: give H and 'support' in the units of the box",
        STYLE, radius, i, j, radius / box, box, images);

  const double listed = excluded(i, j) ? 0.0 : fluid.reach(i, j);
  fluid.set_pair(i, j, listed);
  return listed;
}

// by neigh_modify exclude type; boundary particles that measure their volume still meet

bool PairSPHTait::excluded(int i, int j) const
{
  if (!fluid.is_fluid(i) && !fluid.is_fluid(j)) return false;
  for (int k = 0; k < neighbor->nex_type; k++) {
    const int a = neighbor->ex1_type[k], b = neighbor->ex2_type[k];
    if ((a == i && b == j) || (a == j && b == i)) return true;
  }
  return false;
}

/* ----------------------------------------------------------------------
   one evaluation: volumes of boundary particles, densities, pressures, forces
------------------------------------------------------------------------- */

void PairSPHTait::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  fluid.begin(neighbor->ago == 0);
  fluid.find_densities_and_pressures();
  fluid.find_forces();
  if (vflag_either) tally_virial();
  fluid.end();
  if (eflag_either) tally_energy();
}

void PairSPHTait::tally_virial()
{
  const auto receive = [](void *self, int i, const Acceleration &a) {
    auto *pair = static_cast<PairSPHTait *>(self);
    const double scale = pair->fluid.mass_or_volume_of(i) * pair->force->mvv2e;
    for (int m = 0; m < 6; m++) {
      if (pair->vflag_global) pair->virial[m] += scale * a.virial[m];
      if (pair->vflag_atom) pair->vatom[i][m] += scale * a.virial[m];
    }
  };
  fluid.find_virials(receive, this);
}

// internal energy of the fluid: what compression has stored

void PairSPHTait::tally_energy()
{
  for (int i = 0; i < atom->nlocal; i++) {
    const int t = atom->type[i];
    if (!fluid.is_fluid(t)) continue;
    const double e = fluid.mass_or_volume_of(i) *
        fluid.stored_energy(fluid.equation_of_state(t), atom->rho[i]) * force->mvv2e;
    if (eflag_global) eng_vdwl += e;
    if (eflag_atom) eatom[i] += e;
  }
}

/* ----------------------------------------------------------------------
   ghosts
------------------------------------------------------------------------- */

void PairSPHTait::send_to_ghosts(GhostData what)
{
  for_ghosts = what;
  release::forward_comm(comm, this, FluidEvaluation::ghost_size(what));
}

int PairSPHTait::pack_forward_comm(int n, int *sendlist, double *buf, int, int *)
{
  return fluid.pack(for_ghosts, n, sendlist, buf);
}

void PairSPHTait::unpack_forward_comm(int n, int first, double *buf)
{
  fluid.unpack(for_ghosts, n, first, buf);
}

void PairSPHTait::add_from_ghosts(GhostData what)
{
  for_ghosts = what;
  comm->reverse_comm(this);
}

int PairSPHTait::pack_reverse_comm(int n, int first, double *buf)
{
  return fluid.pack_reverse(for_ghosts, n, first, buf);
}

void PairSPHTait::unpack_reverse_comm(int n, int *owners, double *buf)
{
  fluid.add(for_ghosts, n, owners, buf);
}

/* ----------------------------------------------------------------------
   restart and data files: settings and coefficients, as the user gave them
------------------------------------------------------------------------- */

void PairSPHTait::write_restart_settings(FILE *fp) { fluid.write_options(fp); }

void PairSPHTait::read_restart_settings(FILE *fp)
{
  fluid.forget();
  fluid.read_options(fp);
}

void PairSPHTait::write_restart(FILE *fp)
{
  write_restart_settings(fp);
  fluid.write_restart(fp);
  for (int i = 1; i <= atom->ntypes; i++)
    fwrite(&setflag[i][i], sizeof(int), atom->ntypes + 1 - i, fp);
}

void PairSPHTait::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  allocate();
  fluid.read_restart(fp);
  for (int i = 1; i <= atom->ntypes; i++) {
    const int n = atom->ntypes + 1 - i;
    if (comm->me == 0) utils::sfread(FLERR, &setflag[i][i], sizeof(int), n, fp, nullptr, error);
    MPI_Bcast(&setflag[i][i], n, MPI_INT, 0, world);
  }
}

void PairSPHTait::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; i++) release::print(fp, "{} {}\n", i, fluid.words(i, i, true));
}

void PairSPHTait::write_data_all(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++)
      release::print(fp, "{} {} {}\n", i, j, fluid.words(i, j, true));
}

double PairSPHTait::memory_usage() { return Pair::memory_usage() + fluid.bytes(); }

void *PairSPHTait::extract(const char *name, int &)
{
  return std::strcmp(name, FluidState::EXTRACT) == 0 ? static_cast<FluidState *>(&fluid) : nullptr;
}
