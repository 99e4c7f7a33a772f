// SPDX-License-Identifier: GPL-2.0-or-later
// Particle shifting, core/sph/shifting.h.  What is measured where the forces are, with ghosts in
// place, is applied when the next step moves the particles: a restart between the two measures it
// again.

#include "fix_sph_shift.h"

#include "atom.h"
#include "comm.h"
#include "core/util/bytes.h"
#include "domain.h"
#include "error.h"
#include "fix_sph_integrate.h"
#include "fix_wall_sph.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "group.h"
#include "integrate.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/restart_record.h"
#include "modify.h"
#include "stepping/stepping_scheme.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace sphcloth;

/* ----------------------------------------------------------------------
   fix ID group sph/shift keyword value ...
------------------------------------------------------------------------- */

FixSPHShift::FixSPHShift(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} sph/shift", id)), fluid(nullptr),
    walls(nullptr), speed(Speed::LARGEST), correct_velocity(false), cloth_bits(0), reference(0.0),
    largest(0.0)
{
  ArgReader args(lmp, label, narg, arg, 3);
  read_options(args);
  scalar_flag = vector_flag = 1;
  size_vector = N_COUNTS;
  global_freq = 1;
  extscalar = 0;
  extvector = 1;
  restart_global = 1;
  comm_forward = 1;
  dynamic_group_allow = 1;
}

void FixSPHShift::read_options(ArgReader &args)
{
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "strength")
      coefficients.strength = args.at_least(keyword, 0.0);
    else if (keyword == "speed")
      speed = args.choice(keyword, {"largest", "own"}) ? Speed::OWN : Speed::LARGEST;
    else if (keyword == "max")
      coefficients.largest = args.fraction(keyword);
    else if (keyword == "surface")
      coefficients.surface = args.fraction(keyword);
    else if (keyword == "clumping")
      coefficients.clumping = args.at_least(keyword, 0.0);
    else if (keyword == "correct")
      correct_velocity = args.choice(keyword, {"no", "yes"});
    else
      args.unknown(keyword, "strength, speed, max, surface, clumping, correct");
  }
}

int FixSPHShift::setmask() { return POST_FORCE | INITIAL_INTEGRATE; }

void FixSPHShift::init()
{
  fluid = FluidState::find(force);
  if (!fluid)
    error->all(FLERR, "{}: pair_style {} has no neighbors to shift by: use 'pair_style sph/tait'",
               label, force->pair_style ? force->pair_style : "none");
  if (modify->get_fix_by_style("^sph/shift$").size() > 1)
    error->all(FLERR, "{}: there is another fix sph/shift: keep one, with a group of all fluid",
               label);
  const auto *run_style = dynamic_cast<HasSteppingScheme *>(update->integrate);
  if (fluid->integrates_density() && run_style &&
      run_style->stepping_scheme() == SteppingScheme::BLOCK)
    error->all(FLERR,
               "{}: a shift is no motion of the fluid, but 'density continuity' with block follows "
               "positions: use 'density summation', or another scheme than block",
               label);
  const auto found = modify->get_fix_by_style("^wall/sph$");
  walls = found.empty() ? nullptr : dynamic_cast<FixWallSPH *>(found[0]);
  steps = FixSPHIntegrate::find(modify);
  cloth_bits = 0;
  for (const Fix *fix : modify->get_fix_by_style("^pbd/cloth$")) cloth_bits |= fix->groupbit;

  if (const int type = fluid->foreign_type_in(groupbit))
    error->all(FLERR, "{}: group {} holds type {}, {}: give a group of fluid", label,
               group->names[igroup], type, fluid->kind(type));
}

/* ----------------------------------------------------------------------
   where the forces are: concentration gradients, and particles near a free surface
------------------------------------------------------------------------- */

void FixSPHShift::post_force(int)
{
  const int n = atom->nlocal, n_types = atom->ntypes + 1;
  concentration.assign(n, ConcentrationGradient());
  open.assign(n + atom->nghost, 0.0);
  record_sites();
  left.assign(n, 1);
  own_speed.assign(n, 0.0);
  double fastest = 0.0;

  with_kernel(fluid->options.kernel, [&](auto kernel) {
    using K = decltype(kernel);
    std::vector<KernelScale> scale(n_types * n_types);
    for (int s = 1; s < n_types; s++)
      for (int t = 1; t < n_types; t++)
        scale[s * n_types + t] = kernel_scale<K>(fluid->support(s, t), domain->dimension);
    for (int i = 0; i < n; i++)
      if (fluid->is_fluid(atom->type[i])) measure<K>(i, scale);
  });
  comm->forward_comm(this);

  for (int i = 0; i < n; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    left[i] = near_surface_or_cloth(i);
    const double *v = atom->v[i];
    own_speed[i] = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    fastest = std::max(fastest, own_speed[i]);
  }
  MPI_Allreduce(&fastest, &reference, 1, MPI_DOUBLE, MPI_MAX, world);
}

template <class K>
SPHCLOTH_MULTIVERSION void FixSPHShift::measure(int i, const std::vector<KernelScale> &scale)
{
  const int dim = domain->dimension, n_types = atom->ntypes + 1, type = atom->type[i];
  const double spacing = spacing_of(sites.at_rest[i], dim);
  ConcentrationGradient &mine = concentration[i];
  for (int t = 1; t < n_types; t++) {
    const KernelScale &s = scale[type * n_types + t];
    const double at_spacing = K::shape(std::min(spacing * s.inv_support, 0.9));
    const NeighborSpan near = fluid->neighbors(i, t);
    add_neighbors<K>(mine, sites, i, near, {s, 1.0 / at_spacing, coefficients.clumping, dim});
    if (correct_velocity) add_velocities<K>(mine, sites, i, near, s, atom->v[0]);
  }
  if (walls) walls->add_to(mine, i);
  open[i] = mine.cover < coefficients.surface ? 1.0 : 0.0;
}

// for the loops over neighbors, of owned and ghost particles

void FixSPHShift::record_sites()
{
  const int n = atom->nlocal + atom->nghost;
  sites.resize(n);
  for (int i = 0; i < n; i++) {
    const int type = atom->type[i];
    const double *x = atom->x[i], volume = fluid->volume(i);
    sites.sites[i] = {x[0], x[1], x[2], volume};
    sites.at_rest[i] = volume;
    if (fluid->is_fluid(type))
      sites.at_rest[i] *= atom->rho[i] / fluid->equation_of_state(type).rho0;
  }
}

// To contact with cloth a shift is motion.  Where that parts the fluid, this has a free surface;
// here are vertices of which the fluid knows.

bool FixSPHShift::near_surface_or_cloth(int i) const
{
  if (open[i] != 0.0) return true;
  const double *x = atom->x[i];
  for (int t = 1; t <= atom->ntypes; t++) {
    const NeighborSpan near = fluid->neighbors(i, t);
    const double support = fluid->support(atom->type[i], t);
    for (int k = 0; k < near.n; k++) {
      const int j = near.of[k];
      if (open[j] == 0.0 && !(atom->mask[j] & cloth_bits)) continue;
      const double *y = atom->x[j];
      const double dx = x[0] - y[0], dy = x[1] - y[1], dz = x[2] - y[2];
      if (dx * dx + dy * dy + dz * dz < support * support) return true;
    }
  }
  return false;
}

int FixSPHShift::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  for (int k = 0; k < n; k++) buf[k] = open[list[k]];
  return n;
}

void FixSPHShift::unpack_forward_comm(int n, int first, double *buf)
{
  std::copy(buf, buf + n, open.begin() + first);
}

/* ----------------------------------------------------------------------
   the next step
------------------------------------------------------------------------- */

void FixSPHShift::initial_integrate(int)
{
  largest = 0.0;
  counts[SHIFTED] = counts[LEFT] = counts[CUT] = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    if (left[i] || (steps && steps->is_asleep(i)))
      counts[LEFT]++;
    else
      shift(i);
  }
}

void FixSPHShift::shift(int i)
{
  const double spacing = spacing_of(sites.at_rest[i], domain->dimension);
  const double u = speed == Speed::OWN ? own_speed[i] : reference;
  const double scale = -coefficients.strength * fluid->support(atom->type[i]) * u * update->dt;
  std::array<double, 3> move = concentration[i].gradient;
  for (double &m : move) m *= scale;
  if (cut_to(move, coefficients.largest * spacing)) counts[CUT]++;
  for (int a = 0; a < 3; a++) atom->x[i][a] += move[a];
  if (correct_velocity)
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) atom->v[i][a] += concentration[i].grad_v[3 * a + b] * move[b];

  const double length = std::sqrt(move[0] * move[0] + move[1] * move[1] + move[2] * move[2]);
  largest = std::max(largest, length / spacing);
  counts[MOVED] += length;
  counts[SHIFTED]++;
}

/* ----------------------------------------------------------------------
   output: largest shift over spacing; moved in all, particles shifted, left alone, cut to max
------------------------------------------------------------------------- */

double FixSPHShift::compute_scalar()
{
  double all;
  MPI_Allreduce(&largest, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all;
}

double FixSPHShift::compute_vector(int n)
{
  double all;
  MPI_Allreduce(&counts[n], &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

void FixSPHShift::write_restart(FILE *fp)
{
  double all = 0.0;
  MPI_Reduce(&counts[MOVED], &all, 1, MPI_DOUBLE, MPI_SUM, 0, world);
  if (comm->me) return;
  write_record(fp, all);
}

void FixSPHShift::restart(char *buf)
{
  const auto moved = read_record<double>(buf, label, error);
  counts[MOVED] = comm->me == 0 ? moved : 0.0;
}

double FixSPHShift::memory_usage()
{
  return sites.bytes() + bytes_of(concentration, open, own_speed, left);
}
