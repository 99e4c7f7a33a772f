// What the fluid is made of on one rank, and what was found in the last evaluation.

#include "fluid/fluid_state.h"

#include "core/util/bytes.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "fluid/side_source.h"
#include "force.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/rank_error.h"
#include "modify.h"
#include "neighbor.h"
#include "pair.h"
#include "timer.h"

#include <cmath>
#include <limits>
#include <new>

using namespace LAMMPS_NS;
using namespace sphcloth;

static const std::string STYLE = "pair_style sph/tait";

FluidState *FluidState::find(Force *force)
{
  Pair *style = force->pair_match("sph/tait", 1);
  int dim = 0;
  return style ? static_cast<FluidState *>(style->extract(EXTRACT, dim)) : nullptr;
}

bool FluidState::has_role(int itype) const
{
  return pair->allocated && pair->setflag[itype][itype];
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

void FluidState::forget()
{
  core.reset();
  unsettle();
  is_evaluated = false;
}

// Lists outlive init(): 'run pre no' goes on with them.

void FluidState::begin_run()
{
  active = nullptr;    // until a fix sets the active particles
  hooks = nullptr;
  pressures_follow = false;
  boundaries = find_fluid_boundaries(modify);
  find_sides();
  settle();
  if (!core) core = Fluid::create(options.kernel, options.precision);
  FluidModel &model = core->model;
  const int n = atom->ntypes + 1;
  model.dimension = domain->dimension;
  model.n_types = atom->ntypes;
  model.friction = Friction::NONE;
  model.outputs = Outputs::NOTHING;
  model.role.assign(n, Role::NONE);
  model.mass.resize(n, 0.0);
  model.terms.assign(n * n, PairTerms());
  for (int i = 1; i < n; i++) model.role[i] = type(i).role;
}

void FluidState::find_sides()
{
  sides = nullptr;
  const Fix *owner = nullptr;
  for (Fix *fix : modify->get_fix_list()) {
    int dim = 0;
    void *found = fix->extract(SideSource::EXTRACT, dim);
    if (!found) continue;
    if (sides)
      error->all(FLERR,
                 "{}: fix {} and fix {} cloth/contact both part the fluid: give one of them "
                 "'sides no'",
                 STYLE, owner->id, fix->id);
    sides = static_cast<SideSource *>(found);
    owner = fix;
  }
  double longest = 0.0;
  for (int i = 1; i <= atom->ntypes; i++)
    if (is_fluid(i)) longest = std::max(longest, support(i));
  if (sides) sides->set_sight(longest + neighbor->skin);
}

void FluidState::want_density_rate()
{
  core->model.outputs = std::max(core->model.outputs, Outputs::RATE);
}

void FluidState::set_active(double **array, int column, bool interpolated)
{
  active = array;
  active_column = column;
  pressures_follow = interpolated;
}

/* ----------------------------------------------------------------------
   one evaluation
------------------------------------------------------------------------- */

Particles FluidState::particles()
{
  Particles p;
  p.n_owned = atom->nlocal;
  p.n_all = atom->nlocal + atom->nghost;
  if (p.n_all == 0) return p;
  p.type = atom->type;
  p.x = atom->x[0];
  p.v = atom->v[0];
  p.mass_or_volume = mass_or_volume.data();
  p.pressure = pressure.data();
  p.rho = atom->rho;
  p.drho = atom->drho;
  p.f = atom->f[0];
  p.approach = approach.data();
  p.force_unit = 1.0 / force->ftm2v;
  if (sides) p.sides = sides->sides();
  p.active = active;
  p.active_column = active_column;
  return p;
}

void FluidState::begin_lists()
{
  mass_or_volume.resize(atom->nmax);
  pressure.assign(atom->nmax, 0.0);
  if (diffuses()) gradient.assign(3 * static_cast<std::size_t>(atom->nmax), 0.0);
  if (core->model.outputs == Outputs::RATE_AND_APPROACH) approach.resize(atom->nmax);
  for (int i = 0; i < atom->nlocal; i++) {
    const int itype = atom->type[i];
    if (!is_boundary(itype))
      mass_or_volume[i] = atom_mass(atom, i);
    else if (type(itype).volume > 0.0)
      mass_or_volume[i] = type(itype).volume;
    const double *v = atom->v[i];
    if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2]))
      rank_error(lmp, FLERR, "{}: particle {} has velocity {} {} {}: give finite numbers", STYLE,
                 atom->tag[i], v[0], v[1], v[2]);
  }
  evaluated_order = order_of_atoms(atom);
}

// Lists as wide as LAMMPS's hold until LAMMPS renews its own, which follows the fastest particle.
// Narrower ones are rebuilt where particles have approached each other.

void FluidState::update_lists(const Particles &p, const double *reach, const Motion *motion)
{
  try {
    if (motion)
      core->list(p, reach, neighbor->skin, *motion);
    else
      core->follow(p);
  } catch (const std::bad_alloc &) {
    rank_error(
        lmp, FLERR,
        "{}: not enough memory for the neighbours of {} particles within the support {}: are "
        "particles or vertices much nearer to each other than that?",
        STYLE, atom->nlocal, options.support);
  }
  timer->stamp(Timer::NEIGH);
}

void FluidState::select(const Particles &p)
{
  if (!core->select(p)) return;
  if (!hooks) return;
  active_fluid.clear();
  for (int t = 1; t <= atom->ntypes; t++)
    if (is_fluid(t))
      for (const int slot : core->active().of(t)) active_fluid.push_back(core->order().at(slot));
}

// A mass that all particles of a type share leaves the sums.

void FluidState::find_equal_masses(const Particles &p)
{
  std::vector<double> &mass = core->model.mass;
  std::fill(mass.begin(), mass.end(), -1.0);
  for (int i = 0; i < p.n_all; i++) {
    const int t = p.type[i];
    if (mass[t] < 0.0) mass[t] = is_fluid(t) ? mass_or_volume[i] : 0.0;
    if (mass[t] != mass_or_volume[i]) mass[t] = 0.0;
  }
}

void FluidState::check_densities() const
{
  for (int i = 0; i < atom->nlocal; i++)
    if (is_fluid(atom->type[i]) && !(atom->rho[i] > 0.0))
      rank_error(lmp, FLERR,
                 "{}: particle {} has density {}: give every fluid particle one, 'set group all "
                 "sph/rho RHO0', or use 'density summation'",
                 STYLE, atom->tag[i], atom->rho[i]);
}

// Inactive particles keep their pressure until lists are built: then it follows from the density.

void FluidState::find_pressures(const Particles &p, bool of_all)
{
  const double min = options.tension ? -std::numeric_limits<double>::max() : 0.0;
  const auto find = [&](int i, const Tait &eos) {
    const double rho = p.rho[i];
    double &term = pressure[i];
    term = std::max(eos.pressure(rho), min) / (rho * rho);
    // a density that is renormalized has a gradient that is
    for (FluidBoundary *boundary : boundaries) term *= boundary->inverse_gamma(i);
    // neither true of what is not a number
    if (!(term < std::numeric_limits<double>::max()) || !(rho > 0.0))
      rank_error(lmp, FLERR,
                 "{}: particle {} has density {}: particles overlap or the time step is too large",
                 STYLE, atom->tag[i], rho);
  };
  if (!of_all || !active) return for_each_fluid(find);
  for (int i = 0; i < p.n_owned; i++)
    if (is_fluid(p.type[i])) find(i, equation_of_state(p.type[i]));
}

/* ----------------------------------------------------------------------
   for step hooks and boundaries
------------------------------------------------------------------------- */

void FluidState::push_walls_more(int i, double p_over_rho2, double times)
{
  for (FluidBoundary *boundary : boundaries) boundary->push_more(i, p_over_rho2, times);
}

void FluidState::prolong_walls(double times)
{
  for (FluidBoundary *boundary : boundaries) boundary->prolong(times);
}

void FluidState::hand_over_pushes(const FluidBoundary::Take &take)
{
  for (FluidBoundary *boundary : boundaries) boundary->defer(take);
}

bool FluidState::feels_moving_wall(int i) const
{
  return std::any_of(boundaries.begin(), boundaries.end(),
                     [&](FluidBoundary *boundary) { return boundary->moves_beside(i); });
}

bool FluidState::is_beside_mesh(int i) const
{
  return std::any_of(boundaries.begin(), boundaries.end(),
                     [&](FluidBoundary *boundary) { return boundary->has_vertices_beside(i); });
}

void FluidState::give_impulses(const std::vector<int> &slots, const double *pressure_time,
                               const double *span)
{
  const Particles p = particles();
  core->record_impulses(p, pressure_time, span);
  core->impulses(p, slots);
}

void FluidState::add_virial(int i, const Eigen::Vector3d &from, const Eigen::Vector3d &on)
{
  if (!pair->vflag_either) return;
  const double v[6] = {from[0] * on[0], from[1] * on[1], from[2] * on[2],
                       from[0] * on[1], from[0] * on[2], from[1] * on[2]};
  for (int m = 0; m < 6; m++) {
    if (pair->vflag_global) pair->virial[m] += v[m];
    if (pair->vflag_atom) pair->vatom[i][m] += v[m];
  }
}

/* ----------------------------------------------------------------------
   what the last evaluation found
------------------------------------------------------------------------- */

bool FluidState::evaluated() const
{
  return is_evaluated && evaluated_order == order_of_atoms(atom);
}

double FluidState::pressure_of(int i) const
{
  double p = pressure[i] * atom->rho[i] * atom->rho[i];
  if (is_fluid(atom->type[i]))
    for (FluidBoundary *boundary : boundaries) p /= boundary->inverse_gamma(i);
  return p;
}

int FluidState::count_neighbors(int i)
{
  if (core->order().slots() == 0) return 0;    // a scene without fluid has no lists
  const Particles p = particles();
  int n = 0;
  for (int t = 1; t <= atom->ntypes; t++)
    if (is_fluid(atom->type[i]) || is_fluid(t))
      n += core->count_inside(p, i, t, std::numeric_limits<int>::max());
  return n;
}

static double distance_sq(const double *x, const double *y)
{
  const double dx = x[0] - y[0], dy = x[1] - y[1], dz = x[2] - y[2];
  return dx * dx + dy * dy + dz * dz;
}

bool FluidState::inside_support(int i, int j) const
{
  const double reach = support(atom->type[i], atom->type[j]);
  return distance_sq(atom->x[i], atom->x[j]) < reach * reach;
}

double FluidState::p_over_rho2_beside(int i)
{
  double **x = atom->x;
  double max = 0.0;
  for (int t = 1; t <= atom->ntypes; t++) {
    const double reach = support(atom->type[i], t), reach_sq = reach * reach;
    const NeighborSpan near = neighbors(i, t);
    for (int k = 0; k < near.n; k++)
      if (const int j = near.of[k]; pressure[j] > max && distance_sq(x[i], x[j]) < reach_sq)
        max = pressure[j];
  }
  return max;
}

void FluidState::want_wetting() const
{
  for (FluidBoundary *boundary : boundaries) boundary->want_wetting();
}

double FluidState::approach_speed(int i)
{
  double fastest = approach[i];
  for (FluidBoundary *boundary : boundaries) fastest = std::max(fastest, boundary->approach(i));
  return fastest;
}

Wetting FluidState::wetting(int i)
{
  if (!is_boundary(atom->type[i])) {
    for (const FluidBoundary *boundary : boundaries)
      if (const Wetting wet = boundary->wetting(i); wet.fluid_mass > 0.0) return wet;
    return {};
  }
  const Particles p = particles();
  Wetting w;
  for (int t = 1; t <= atom->ntypes; t++) {
    if (!is_fluid(t) || core->count_inside(p, i, t, 1) == 0) continue;
    const Tait &eos = type(t).eos;
    w.fluid_mass = std::max(w.fluid_mass, eos.rho0 * mass_or_volume[i]);
    w.sound = std::max(w.sound, eos.sound_speed());
  }
  return w;
}

double FluidState::bytes() const
{
  return (core ? core->bytes() : 0.0) +
      bytes_of(mass_or_volume, pressure, rate, gradient, approach, active_fluid);
}
