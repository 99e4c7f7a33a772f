// SPDX-License-Identifier: GPL-2.0-or-later
// Hinges of cloth.  They exert no force: fix pbd/cloth projects their constraints.

#include "dihedral_pbd.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/lammps_version.h"
#include "memory.h"
#include "modify.h"

using namespace LAMMPS_NS;

static const std::string COEFF = "dihedral_coeff (pbd)";

DihedralPBD::DihedralPBD(LAMMPS *lmp_) : Dihedral(lmp_)
{
  writedata = 1;
  release::not_for_fix_adapt(this);
}

DihedralPBD::~DihedralPBD()
{
  if (allocated && !copymode) memory->destroy(setflag);
}

void DihedralPBD::allocate()
{
  allocated = 1;
  const int n = atom->ndihedraltypes + 1;
  memory->create(setflag, n, "dihedral:setflag");
  for (int i = 1; i < n; i++) setflag[i] = 0;
  materials.allocate(atom->ndihedraltypes);
}

// dihedral_coeff N k, or N compliance A, and keywords

void DihedralPBD::coeff(int narg, char **arg)
{
  if (narg < 1) utils::missing_cmd_args(FLERR, COEFF, error);
  if (!allocated) allocate();
  ArgReader args(lmp, COEFF, narg, arg);
  const auto [ilo, ihi] = args.range("dihedral type", atom->ndihedraltypes);
  const PBDMaterial material = PBDMaterial::read(args, false);
  for (int i = ilo; i <= ihi; i++) {
    materials[i] = material;
    setflag[i] = 1;
  }
}

void DihedralPBD::init_style()
{
  if (comm->me == 0 && modify->get_fix_by_style("^pbd/cloth$").empty())
    error->warning(FLERR, "dihedral_style pbd does nothing without 'fix ID group pbd/cloth'");
}

void DihedralPBD::compute(int eflag, int vflag) { ev_init(eflag, vflag); }

void DihedralPBD::write_restart(FILE *fp) { materials.write_restart(fp); }

void DihedralPBD::read_restart(FILE *fp)
{
  allocate();
  materials.read_restart(fp, comm, error, world);
  for (int i = 1; i <= atom->ndihedraltypes; i++) setflag[i] = 1;
}

void DihedralPBD::write_data(FILE *fp) { materials.write_data(fp, false); }
