// SPDX-License-Identifier: GPL-2.0-or-later
// A source of fluid: layers of a square lattice, one behind the other at the spacing, so that the
// jet has the density of water at rest.  Layers follow physical time and not steps; every rank
// computes the same layer and makes the particles that it owns.

#include "fix_sph_emit.h"

#include "atom.h"
#include "comm.h"
#include "core/util/bytes.h"
#include "domain.h"
#include "error.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/restart_record.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;

// their places are kept by every rank
static constexpr double MAX_IN_LAYER = 1e8;

/* ----------------------------------------------------------------------
   fix ID group sph/emit N type spacing keyword values ...
------------------------------------------------------------------------- */

FixSPHEmit::FixSPHEmit(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} sph/emit", id)), total(0), emitted(0), itype(0),
    spacing(0.0), mass(0.0), center(Vec3::Zero()), velocity(Vec3::Zero()), extent{0.0, 0.0},
    disc(false), start(0.0), layer_time(0.0), layers(0)
{
  restart_global = 1;
  force_reneighbor = 1;
  next_reneighbor = -1;
  scalar_flag = vector_flag = 1;
  size_vector = 4;
  global_freq = 1;
  extscalar = extvector = 0;
  time_depend = 1;

  ArgReader args(lmp, label, narg, arg, 3);
  total = args.integer("number of particles", 1, MAXSMALLINT);
  itype = args.integer("atom type", 1, atom->ntypes);
  spacing = args.positive("spacing");
  read_options(args);
  make_pattern();
  post_run();
}

void FixSPHEmit::read_options(ArgReader &args)
{
  const auto vector = [&](const std::string &what) {
    Vec3 v;
    for (int d = 0; d < 3; d++) v[d] = args.number(what + (d == 0 ? " x" : d == 1 ? " y" : " z"));
    return v;
  };
  start = physical_time(update);
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if ((keyword == "disc" || keyword == "rectangle") && extent[0] > 0.0)
      args.fail("opening", keyword, "there is one already: give one disc or one rectangle");
    if (keyword == "disc") {
      disc = true;
      center = vector("disc center");
      extent[0] = args.positive("disc radius");
    } else if (keyword == "rectangle") {
      disc = false;
      center = vector("rectangle center");
      extent[0] = args.positive("rectangle first side");
      extent[1] = args.positive("rectangle second side");
    } else if (keyword == "velocity")
      velocity = vector("velocity");
    else if (keyword == "start")
      start = args.at_least("start time", 0.0);
    else if (keyword == "mass")
      mass = args.positive("mass");
    else
      args.unknown(keyword, "disc, rectangle, velocity, start, mass");
  }
  if (extent[0] == 0.0)
    error->all(FLERR, "{}: the opening is missing: add 'disc X Y Z R' or 'rectangle X Y Z A B'",
               label);
  if (velocity.norm() == 0.0)
    error->all(FLERR, "{}: the velocity is missing: add 'velocity VX VY VZ'", label);
  if (domain->dimension == 2 && (center[2] != 0.0 || velocity[2] != 0.0))
    error->all(FLERR,
               "{}: the center is at z = {} and the velocity has {} in z: give 0 in a 2-D "
               "simulation",
               label, center[2], velocity[2]);
  layer_time = spacing / velocity.norm();
}

// Square lattice in the plane across the velocity, symmetric about the center.  The first side of
// a rectangle lies along x, or along y for a jet along x.

void FixSPHEmit::make_pattern()
{
  const Vec3 normal = velocity.normalized();
  Vec3 first = std::fabs(normal[0]) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  first = (first - first.dot(normal) * normal).normalized();
  const Vec3 second = normal.cross(first);
  sides[0] = first;
  sides[1] = second;
  const double reach_a = disc ? 2.0 * extent[0] : extent[0];
  const double reach_b = disc ? 2.0 * extent[0] : extent[1];
  const double cells = (reach_a / spacing) * (reach_b / spacing);
  if (cells > MAX_IN_LAYER)
    error->all(FLERR, "{}: spacing {} makes {:.3g} particles in a layer, more than {:g}: raise it",
               label, spacing, cells, MAX_IN_LAYER);
  // in two dimensions a layer is a row
  const auto count = [&](double reach, const Vec3 &side) {
    const bool across = domain->dimension == 2 && side[2] != 0.0;
    return across ? 1 : std::max(1, static_cast<int>(std::lround(reach / spacing)));
  };
  const int na = count(reach_a, first), nb = count(reach_b, second);
  for (int b = 0; b < nb; b++)
    for (int a = 0; a < na; a++) {
      const Vec3 x = spacing * ((a - 0.5 * (na - 1)) * first + (b - 0.5 * (nb - 1)) * second);
      if (!disc || x.squaredNorm() <= extent[0] * extent[0]) pattern.push_back(x);
    }
}

int FixSPHEmit::setmask() { return POST_INTEGRATE | PRE_EXCHANGE | POST_RUN; }

void FixSPHEmit::init()
{
  follow_renumbering();
  const auto *fluid = FluidState::find(force);
  if (!fluid || !fluid->is_fluid(itype))
    error->all(
        FLERR,
        "{}: type {} is no fluid: use 'pair_style sph/tait' and 'pair_coeff {} {} fluid ...'",
        label, itype, itype, itype);
  // with it a lattice of this spacing is water at rest
  rho0 = fluid->equation_of_state(itype).rho0;
  const double at_rest = fluid->lattices.mass(itype, spacing);
  if (atom->rmass && mass == 0.0) mass = at_rest;
  if (!atom->rmass && mass != 0.0)
    error->all(FLERR,
               "{}: masses belong to types here: leave the mass keyword out and use 'mass {} {}'",
               label, itype, mass);
  const double excess = mass_of_one() / at_rest - 1.0;
  if (comm->me == 0 && excess > 0.01)
    error->warning(
        FLERR,
        "{}: particles at this spacing are {:.1f} % too dense and burst apart: use a mass of "
        "{:.6g}",
        label, 100.0 * excess, at_rest);
  for (const Vec3 &x : pattern) {
    Vec3 position = center + x;
    if (!domain->inside(position.data()))
      error->all(FLERR,
                 "{}: the opening reaches out of the box at ({}, {}, {}): move it or shrink it",
                 label, position[0], position[1], position[2]);
  }
}

// to within round-off, so that a restart or another rank count does not shift a layer by a step

bool FixSPHEmit::layer_is_due() const
{
  return emitted < total && due() - physical_time(update) <= 1e-6 * update->dt;
}

/* ----------------------------------------------------------------------
   a layer that is due asks for a list build in this very step
------------------------------------------------------------------------- */

void FixSPHEmit::setup_pre_exchange()
{
  largest_id = first_free_id(lmp, label, 0, largest_id) - 1;
  while (layer_is_due()) emit_layer(physical_time(update) - due());
}

void FixSPHEmit::post_integrate()
{
  if (layer_is_due()) next_reneighbor = update->ntimestep;
}

void FixSPHEmit::post_run() { ids.assign(atom->tag, atom->tag + atom->nlocal); }

// Where commands between two runs have given IDs anew, as reset_atoms does, there are none of
// before any more.  Where atoms have only left, those that are there had the same IDs before.

void FixSPHEmit::follow_renumbering()
{
  const tagint n = first_free_id(lmp, label, 0) - 1;
  if (n != atom->natoms || n >= largest_id) return;    // new IDs have no gap
  const bigint mine = std::count_if(ids.begin(), ids.end(), [n](tagint one) { return one <= n; });
  bigint all;
  MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all < n) largest_id = n;
}

void FixSPHEmit::pre_exchange()
{
  while (layer_is_due()) emit_layer(physical_time(update) - due());
}

// age: how long ago the layer left the opening

void FixSPHEmit::emit_layer(double age)
{
  const bigint wanted = std::min<bigint>(pattern.size(), total - emitted);
  for (Fix *fix : modify->get_fix_by_style("^sph/emit$"))
    largest_id = std::max(largest_id, dynamic_cast<FixSPHEmit *>(fix)->largest_id);
  const tagint first = first_free_id(lmp, label, wanted, largest_id);
  bigint mine[2] = {0, warned ? 0 : count_in_the_way(age)}, all[2];
  const int before = atom->nlocal;
  for (bigint k = 0; k < wanted; k++)
    add_particle(center + pattern[k] + age * velocity, first + static_cast<tagint>(k));
  for (int i = before; i < atom->nlocal; i++) modify->create_attribute(i);

  mine[0] = atom->nlocal - before;
  MPI_Allreduce(mine, all, 2, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all[0] != wanted)
    error->all(FLERR,
               "{}: {} of {} particles of a layer fell out of the box: move the opening inwards",
               label, wanted - all[0], wanted);
  if (all[1] > 0) warn_of_backwater(all[1]);
  atom->natoms += all[0];
  refresh_map(atom);
  const double more = static_cast<double>(all[0]) * mass_of_one();
  came_in.mass += more;
  for (int d = 0; d < 3; d++) came_in.momentum[d] += more * velocity[d];
  came_in.energy += 0.5 * more * velocity.squaredNorm();
  emitted += all[0];
  layers++;
  largest_id = first + static_cast<tagint>(all[0]) - 1;
}

// owned particles that are where a layer appears; the layer before is a spacing further

bigint FixSPHEmit::count_in_the_way(double age) const
{
  const Vec3 normal = velocity.normalized(), middle = center + age * velocity;
  bigint n = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    const Vec3 from = Eigen::Map<const Vec3>(atom->x[i]) - middle;
    if (std::fabs(from.dot(normal)) >= 0.5 * spacing) continue;
    const double a = std::fabs(from.dot(sides[0])), b = std::fabs(from.dot(sides[1]));
    n += disc ? a * a + b * b <= extent[0] * extent[0]
              : a <= 0.5 * extent[0] && b <= 0.5 * extent[1];
  }
  return n;
}

void FixSPHEmit::warn_of_backwater(bigint particles)
{
  warned = true;
  if (comm->me == 0)
    error->warning(FLERR,
                   "{}: {} particles are where a layer appears, at the time {}: water that is too "
                   "dense bursts apart; move the opening away from what was poured, or pour slower",
                   label, particles, physical_time(update));
}

void FixSPHEmit::add_particle(const Vec3 &position, tagint tag)
{
  const int i = create_owned_atom(atom, domain, tag, itype, position.data(), groupbit);
  if (i < 0) return;
  for (int d = 0; d < 3; d++) atom->v[i][d] = velocity[d];
  atom->rho[i] = rho0;    // for continuity, which has no other for it
  if (atom->rmass) atom->rmass[i] = mass;
}

double FixSPHEmit::mass_of_one() const { return atom->rmass ? mass : atom->mass[itype]; }

// particles that are still to come, then the momentum that came in

double FixSPHEmit::compute_vector(int n)
{
  return n == 0 ? static_cast<double>(total - emitted) : came_in.momentum[n - 1];
}

struct FixSPHEmit::Record {
  bigint emitted, layers, largest_id;
  double start, layer_time, time;    // start and time: physical
  Poured came_in;
};

void FixSPHEmit::write_restart(FILE *fp)
{
  if (comm->me) return;
  write_record(fp, Record{emitted, layers, largest_id, start, layer_time, physical_time(update),
                          came_in});
}

void FixSPHEmit::restart(char *buf)
{
  const auto record = read_record<Record>(buf, label, error);
  emitted = record.emitted;
  layers = record.layers;
  largest_id = static_cast<tagint>(record.largest_id);
  came_in = record.came_in;
  // reset_timestep may have come before this fix
  start = record.start + (physical_time(update) - record.time);
  // the layer that comes next is due when it was, also if those behind it have another interval
  start += static_cast<double>(layers) * (record.layer_time - layer_time);
}

double FixSPHEmit::memory_usage() { return sphcloth::bytes_of(ids, pattern); }
