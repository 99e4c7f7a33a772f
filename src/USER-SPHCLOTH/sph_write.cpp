// SPDX-License-Identifier: GPL-2.0-or-later
// Writes tables of the kernel W and of the equation of state (3).

#include "sph_write.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/lammps_version.h"
#include "update.h"

#include <cerrno>
#include <cstring>

using namespace LAMMPS_NS;
using namespace sphcloth;

static const std::string STYLE = "sph_write";
static constexpr int MAX_ROWS = 1000000;

/* ----------------------------------------------------------------------
   sph_write kernel I J N FILE | sph_write state I N FILE rho_lo rho_hi
------------------------------------------------------------------------- */

void SPHWrite::command(int narg, char **arg)
{
  if (!domain->box_exist)
    error->all(FLERR, "{}: there is no box yet: use create_box or read_data before", STYLE);
  fluid = FluidState::find(force);
  if (!fluid)
    error->all(FLERR, "{}: pair_style {} has no kernel: use 'pair_style sph/tait'", STYLE,
               force->pair_style ? force->pair_style : "none");

  ArgReader args(lmp, STYLE, narg, arg);
  if (args.choice("table", {"kernel", "state"}) == 0)
    write_kernel(args);
  else
    write_state(args);
}

void SPHWrite::write_kernel(ArgReader &args)
{
  const int i = read_type(args, "first type"), j = read_type(args, "second type");
  const int n = args.integer("number of rows", 2, MAX_ROWS);
  const std::string file = args.word("file");
  args.end();
  if (!(fluid->reach(i, j) > 0.0))
    error->all(FLERR,
               "{}: types {} and {} are boundaries that never look at each other: give at least "
               "one fluid type",
               STYLE, i, j);

  const double support = fluid->support(i, j);
  std::string table = fmt::format("# kernel {} of types {} and {}, support {}, dimension {}, "
                                  "units {}\n# r W dW/dr\n",
                                  kernel_word(fluid->options.kernel), i, j, support,
                                  domain->dimension, update->unit_style);
  with_kernel(fluid->options.kernel, [&](auto kernel) {
    using K = decltype(kernel);
    const KernelScale scale = kernel_scale<K>(support, domain->dimension);
    for (int k = 0; k < n; k++) {
      const double q = k / (n - 1.0), r = q * support;
      table += fmt::format("{:.15g} {:.15g} {:.15g}\n", r, scale.w * K::shape(q),
                           scale.f * r * K::slope_over_q(q));
    }
  });
  append(file, table);
}

void SPHWrite::write_state(ArgReader &args)
{
  const int i = read_type(args, "type");
  const int n = args.integer("number of rows", 2, MAX_ROWS);
  const std::string file = args.word("file");
  const double low = args.positive("lowest density"), high = args.positive("highest density");
  args.end();
  if (low >= high)
    error->all(FLERR, "{}: density {} to {} is no range: give the lower one first", STYLE, low,
               high);
  if (!fluid->is_fluid(i))
    error->all(FLERR, "{}: type {} is a boundary and has no equation of state: give a fluid type",
               STYLE, i);

  const Tait &eos = fluid->equation_of_state(i);
  std::string table = fmt::format("# equation of state of type {}, rest density {}, units {}\n"
                                  "# density pressure sound energy/mass\n",
                                  i, eos.rho0, update->unit_style);
  for (int k = 0; k < n; k++) {
    const double rho = low + (high - low) * k / (n - 1.0);
    table += fmt::format("{:.15g} {:.15g} {:.15g} {:.15g}\n", rho,
                         fluid->acting_pressure(eos, rho) * force->mvv2e * force->nktv2p,
                         eos.sound_speed(rho), fluid->stored_energy(eos, rho) * force->mvv2e);
  }
  append(file, table);
}

int SPHWrite::read_type(ArgReader &args, const std::string &what) const
{
  const int itype = args.integer(what, 1, atom->ntypes);
  if (!fluid->has_role(itype))
    error->all(FLERR, "{}: nothing was said of type {}: use 'pair_coeff {} {} fluid ...' before",
               STYLE, itype, itype, itype);
  if (!fluid->is_fluid(itype) && !fluid->is_boundary(itype))
    error->all(FLERR, "{}: type {} is {}, without kernel and equation of state: give a fluid type",
               STYLE, itype, fluid->kind(itype));
  return itype;
}

// Tables in one file are blocks with blank lines between, as plotting programs expect.

void SPHWrite::append(const std::string &file, const std::string &table) const
{
  int failed = 0;
  if (comm->me == 0) {
    FILE *fp = fopen(file.c_str(), "a");
    if (fp) {
      fseek(fp, 0, SEEK_END);
      release::print(fp, "{}{}", ftell(fp) > 0 ? "\n\n" : "", table);
      failed = ferror(fp) ? EIO : 0;
      if (fclose(fp) && !failed) failed = errno;
    } else
      failed = errno;
  }
  MPI_Bcast(&failed, 1, MPI_INT, 0, world);
  if (failed)
    error->all(FLERR, "{}: cannot write file '{}' ({}): give a place that can be written", STYLE,
               file, std::strerror(failed));
}
