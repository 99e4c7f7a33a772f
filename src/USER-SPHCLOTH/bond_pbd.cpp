// SPDX-License-Identifier: GPL-2.0-or-later
// Bonds of cloth.  They exert no force: fix pbd/cloth projects their constraints.

#include "bond_pbd.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "lammps_util/arg_reader.h"
#include "memory.h"
#include "modify.h"

using namespace LAMMPS_NS;

static const std::string COEFF = "bond_coeff (pbd)";

BondPBD::BondPBD(LAMMPS *lmp_) : Bond(lmp_)
{
  writedata = 1;
  reinitflag = 0;
}

BondPBD::~BondPBD()
{
  if (allocated && !copymode) memory->destroy(setflag);
}

void BondPBD::allocate()
{
  allocated = 1;
  const int n = atom->nbondtypes + 1;
  memory->create(setflag, n, "bond:setflag");
  for (int i = 1; i < n; i++) setflag[i] = 0;
  materials.allocate(atom->nbondtypes);
}

// bond_coeff N k, or N compliance A, and keywords

void BondPBD::coeff(int narg, char **arg)
{
  if (narg < 1) utils::missing_cmd_args(FLERR, COEFF, error);
  if (!allocated) allocate();
  ArgReader args(lmp, COEFF, narg, arg);
  const auto [ilo, ihi] = args.range("bond type", atom->nbondtypes);
  const PBDMaterial material = PBDMaterial::read(args, true);
  for (int i = ilo; i <= ihi; i++) {
    materials[i] = material;
    setflag[i] = 1;
  }
}

void BondPBD::init_style()
{
  if (comm->me == 0 && modify->get_fix_by_style("^pbd/cloth$").empty())
    error->warning(FLERR, "bond_style pbd does nothing without 'fix ID group pbd/cloth'");
}

void BondPBD::compute(int eflag, int vflag) { ev_init(eflag, vflag); }

double BondPBD::single(int, double, int, int, double &fforce)
{
  fforce = 0.0;
  return 0.0;
}

void BondPBD::write_restart(FILE *fp) { materials.write_restart(fp); }

void BondPBD::read_restart(FILE *fp)
{
  allocate();
  materials.read_restart(fp, comm, error, world);
  for (int i = 1; i <= atom->nbondtypes; i++) setflag[i] = 1;
}

void BondPBD::write_data(FILE *fp) { materials.write_data(fp, true); }
