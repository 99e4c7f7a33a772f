// Hinges of cloth.  They exert no force: fix pbd/cloth projects their constraints.

#include "dihedral_pbd.h"

#include "arg_reader.h"
#include "atom.h"
#include "comm.h"
#include "error.h"
#include "memory.h"
#include "modify.h"

using namespace LAMMPS_NS;

static const std::string COEFF = "dihedral_coeff (pbd)";

DihedralPBD::DihedralPBD(LAMMPS *lmp) : Dihedral(lmp)
{
  writedata = 1;
  reinitflag = 0;
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
  k.assign(n, 0.0);
}

// dihedral_coeff N k

void DihedralPBD::coeff(int narg, char **arg)
{
  if (narg < 1) utils::missing_cmd_args(FLERR, COEFF, error);
  if (!allocated) allocate();
  int ilo, ihi;
  utils::bounds(FLERR, arg[0], 1, atom->ndihedraltypes, ilo, ihi, error);
  ArgReader args(lmp, COEFF, narg, arg, 1);
  const double stiffness = args.fraction("stiffness k");
  if (args.more()) args.unknown(args.peek(), "no keyword: the only argument is the stiffness k");
  for (int i = ilo; i <= ihi; i++) {
    k[i] = stiffness;
    setflag[i] = 1;
  }
}

void DihedralPBD::init_style()
{
  if (comm->me == 0 && modify->get_fix_by_style("^pbd/cloth$").empty())
    error->warning(FLERR, "dihedral_style pbd does nothing without 'fix ID group pbd/cloth'");
}

void DihedralPBD::compute(int eflag, int vflag) { ev_init(eflag, vflag); }

void DihedralPBD::write_restart(FILE *fp)
{
  fwrite(&k[1], sizeof(double), atom->ndihedraltypes, fp);
}

void DihedralPBD::read_restart(FILE *fp)
{
  allocate();
  if (comm->me == 0)
    utils::sfread(FLERR, &k[1], sizeof(double), atom->ndihedraltypes, fp, nullptr, error);
  MPI_Bcast(&k[1], atom->ndihedraltypes, MPI_DOUBLE, 0, world);
  for (int i = 1; i <= atom->ndihedraltypes; i++) setflag[i] = 1;
}

void DihedralPBD::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->ndihedraltypes; i++) fprintf(fp, "%d %.16g\n", i, k[i]);
}
