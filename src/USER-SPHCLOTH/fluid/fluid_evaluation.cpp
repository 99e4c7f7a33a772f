// SPDX-License-Identifier: GPL-2.0-or-later
// The phases of an evaluation in their order: volumes of boundary particles, density (1), Tait
// equation of state (3), momentum (2).

#include "fluid/fluid_evaluation.h"

#include "comm.h"
#include "core/util/bytes.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "fluid/side_source.h"
#include "fluid/step_hooks.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/rank_error.h"
#include "modify.h"
#include "neighbor.h"
#include "timer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>

using namespace LAMMPS_NS;
using namespace sphcloth;

static const std::string STYLE = "pair_style sph/tait";

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

void FluidEvaluation::forget()
{
  core.reset();
  forget_pair_values();
  is_evaluated = false;
}

// Lists outlive init(): 'run pre no' goes on with them.

void FluidEvaluation::begin_run()
{
  lists_of_atoms.initialized();
  active = nullptr;    // until a fix sets the active particles
  hooks = nullptr;
  stability.forget();
  scaled.forget();
  surface.begin_run();
  pressures_follow = false;
  lattices.set_expansion(nullptr);
  boundaries = find_fluid_boundaries(modify);
  find_sides();
  cache_pair_values();
  lattices.calibrate();
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
  model.pressure_scale.assign(n, 1.0);
  model.viscosity_switch.assign(n, ViscositySwitch());
  double first = 0.0;    // rest density; if there is no other, all factors are exactly 1
  for (int i = 1; i < n; i++) {
    model.role[i] = type(i).role;
    if (!is_fluid(i)) continue;
    const double rho0 = equation_of_state(i).rho0;
    if (first == 0.0) first = rho0;
    model.pressure_scale[i] = rho0 / first * (rho0 / first);
  }
  list_reach.assign(n * n, 0.0);
  moved = moved_here = std::vector<int>(n, 0);
}

void FluidEvaluation::set_pair(int i, int j, double listed)
{
  const int n = atom->ntypes + 1;
  FluidModel &model = core->model;
  const PairTerms t = set_terms(i, j);
  Friction needed = t.monaghan > 0.0 ? Friction::ARTIFICIAL : Friction::NONE;
  if (t.monaghan > 0.0 && switches_viscosity()) needed = Friction::SWITCHED;
  if (t.nu > 0.0) needed = std::max(needed, Friction::ANY);
  model.friction = std::max(model.friction, needed);
  list_reach[i * n + j] = list_reach[j * n + i] = listed;
}

void FluidEvaluation::find_sides()
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
  if (sides) sides->set_view_distance(longest + neighbor->skin);
}

/* ----------------------------------------------------------------------
   one evaluation
------------------------------------------------------------------------- */

void FluidEvaluation::begin(bool new_neighbors)
{
  is_evaluated = false;
  new_lists = new_neighbors;
  new_lists ? begin_lists() : lists_of_atoms.check(STYLE);
  const Particles p = particles();
  update_lists(p);
  select(p);
  core->record_positions(p, box());
  measure_volumes(p);
  for (FluidBoundary *boundary : boundaries) boundary->begin();
}

void FluidEvaluation::find_densities_and_pressures()
{
  const Particles p = particles();
  find_densities(p);
  find_pressures(p);
  ghosts.send_to_ghosts(GhostData::DENSITY);
  if (surface.on()) ghosts.send_to_ghosts(GhostData::TURN);
  if (extrapolate) find_boundary_pressures(p);
  core->record(p);
  if (surface.on()) core->record_turns(p, surface.turns());
  const bool switched = core->model.friction == Friction::SWITCHED;
  // shares and friction of the correction are both of the velocities before it
  if (switched) find_viscosity_shares(p);
  if (!hooks || !hooks->correct_velocities()) return;
  core->record(p);
  if (switched) find_viscosity_shares(p);
}

void FluidEvaluation::find_forces()
{
  if (scaled.wanted()) scaled.find(*core, particles(), stability, boundaries);
  // when free flight ends is told by rates of the density
  const bool by_rates = stability.knows_flight();
  if (stability.wanted() && !by_rates) find_frequencies();
  if (const Impulses *impulses = hooks ? hooks->begin_impulses() : nullptr)
    core->impulses(particles(), *impulses);
  else
    core->forces(particles(), hooks ? Target::FLUID : Target::ALL);
  if (surface.on()) surface.push(*core, particles(), boundaries);
  if (hooks) hooks->note_pair_forces();
  for (FluidBoundary *boundary : boundaries) push(*boundary);
  if (lattices.adapts_density() || surface.on())    // so far, rates of the sums
    core->for_active_fluid([this](int i, int t) {
      atom->drho[i] *= lattices.slope(i, t, atom->rho[i]) * surface.factor(i);
    });
  if (stability.wanted() && by_rates) find_frequencies();
}

// Where the pressures of inactive particles follow, these act on a boundary in every step.

void FluidEvaluation::push(FluidBoundary &boundary)
{
  const auto push_one = [&](int i, int) { boundary.push(i, p_over_rho2[i]); };
  if (!pressures_follow) return core->for_active_fluid(push_one);
  for (int i = 0; i < atom->nlocal; i++)
    if (const int t = atom->type[i]; is_fluid(t)) push_one(i, t);
}

void FluidEvaluation::find_virials(Fluid::Receiver receive, void *context)
{
  Particles all = particles();
  if (surface.on()) core->turn_virials(all, receive, context);
  if (!hooks) return core->virials(all, receive, context);
  all.active = nullptr;
  core->select(all);
  core->record_positions(all, box());
  core->record(all);
  if (core->model.friction == Friction::SWITCHED) find_viscosity_shares(all);
  core->virials(all, receive, context);
  core->select(particles());
}

void FluidEvaluation::end()
{
  if (hooks) hooks->apply_impulses();
  for (FluidBoundary *boundary : boundaries) boundary->end();
  is_evaluated = true;
}

/* ----------------------------------------------------------------------
   lists
------------------------------------------------------------------------- */

void FluidEvaluation::begin_lists()
{
  renormalizing = put_renormalizing_last(boundaries);
  mass_or_volume.resize(atom->nmax);
  p_over_rho2.assign(atom->nmax, 0.0);
  if (integrates_density()) integrated.begin_lists(hooks);
  surface.begin_lists();
  if (core->model.outputs == Outputs::RATE_AND_APPROACH) approach.resize(atom->nmax);
  if (core->model.friction == Friction::SWITCHED) viscosity_shares.assign(atom->nmax, 1.0);
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
  lists_of_atoms.lists_are_new();
  stability.lists_have_changed();
}

// Lists as wide as LAMMPS's hold until LAMMPS renews its own, which follows the fastest particle.
// Narrower ones are rebuilt where particles have approached each other.

void FluidEvaluation::update_lists(const Particles &p)
{
  try {
    if (new_lists)
      core->list(p, list_reach.data(), neighbor->skin, usual_motion(p));
    else
      core->follow(p);
  } catch (const std::bad_alloc &) {
    rank_error(lmp, FLERR,
               "{}: not enough memory for the neighbors of {} particles within the support {}: are "
               "particles or vertices much nearer to each other than that?",
               STYLE, atom->nlocal, options.support);
  }
  timer->stamp(Timer::NEIGH);
}

void FluidEvaluation::select(const Particles &p)
{
  if (!core->select(p) || !hooks) return;
  active_fluid.clear();
  core->for_active_fluid([this](int i, int) { active_fluid.push_back(i); });
}

Fluid::Box FluidEvaluation::box() const
{
  const double *lo = domain->triclinic ? domain->boxlo_bound : domain->boxlo, *prd = domain->prd;
  const double tilt = std::fabs(domain->xy) + std::fabs(domain->xz) + std::fabs(domain->yz);
  const double reach = comm->get_comm_cutoff() + neighbor->skin;
  return {{lo[0], lo[1], lo[2]}, {prd[0], prd[1], prd[2]}, reach, tilt};
}

// From velocities and a usual acoustic step: the step itself is another after a restart than
// before.

Motion FluidEvaluation::usual_motion(const Particles &p) const
{
  Motion motion;
  motion.dimension = domain->dimension;
  motion.v = p.v;
  constexpr double USUAL = 0.5;    // of h_s/c
  double step = std::numeric_limits<double>::max();
  for (int t = 1; t <= atom->ntypes; t++)
    if (is_fluid(t))
      step = std::min(step, USUAL * 0.5 * support(t) / equation_of_state(t).sound_speed());
  motion.step = step;
  motion.interval.assign(atom->ntypes + 1, 1.0);
  if (hooks) hooks->find_intervals(motion.interval);
  return motion;
}

/* ----------------------------------------------------------------------
   volumes of boundary particles, and masses
------------------------------------------------------------------------- */

// Volumes of boundary particles that share space among themselves follow their motion, as long as
// there is fluid to feel them: boxes and minimizers move particles without velocities, too.

void FluidEvaluation::measure_volumes(const Particles &p)
{
  const int n = atom->ntypes + 1;
  std::fill(moved.begin(), moved.end(), new_lists);
  if (new_lists) measured.begin_lists(p, atom->ntypes, [this](int t) { return is_measured(t); });
  if (measure_volume && !new_lists && any_fluid) {
    for (int t = 1; t < n; t++) moved_here[t] = measured.have_moved(p, t);
    MPI_Allreduce(moved_here.data(), moved.data(), n, MPI_INT, MPI_MAX, world);
  }
  bool any = new_lists;
  for (int t = 1; t < n; t++) {
    if (!is_measured(t) || !moved[t]) continue;
    measured.note(p, t);
    core->volumes(p, t, mass_or_volume.data());
    any = true;
  }
  if (!any) return;
  ghosts.send_to_ghosts(GhostData::MASS_OR_VOLUME);
  if (!new_lists) return;
  std::array<int, 3> here{0, 0, 0}, anywhere{0, 0, 0};
  for (int i = 0; i < p.n_owned; i++) {
    const int t = p.type[i];
    if (is_fluid(t)) here[0] = 1;
    if (extrapolates(t)) here[1] = 1;
    if (is_measured(t)) here[2] = 1;
  }
  MPI_Allreduce(here.data(), anywhere.data(), 3, MPI_INT, MPI_MAX, world);
  any_fluid = anywhere[0];
  extrapolate = anywhere[1];
  measure_volume = anywhere[2];
  find_equal_masses(p);
}

// A mass that all particles of a type share leaves the sums.

void FluidEvaluation::find_equal_masses(const Particles &p)
{
  std::vector<double> &mass = core->model.mass;
  std::fill(mass.begin(), mass.end(), -1.0);
  for (int i = 0; i < p.n_all; i++) {
    const int t = p.type[i];
    if (mass[t] < 0.0) mass[t] = is_fluid(t) ? mass_or_volume[i] : 0.0;
    if (mass[t] != mass_or_volume[i]) mass[t] = 0.0;
  }
}

/* ----------------------------------------------------------------------
   densities and pressures
------------------------------------------------------------------------- */

void FluidEvaluation::find_densities(const Particles &p)
{
  if (!integrates_density()) {
    core->gather(p, true);
    for (FluidBoundary *boundary : boundaries)
      core->for_active_fluid([&](int i, int) { p.rho[i] = boundary->density(i, p.rho[i]); });
    if (surface.on()) surface.complete(*core, p, boundaries, stability.bend_of_lattice());
    if (!lattices.adapts_density()) return;
    return core->for_active_fluid(
        [&](int i, int t) { p.rho[i] = lattices.density(i, t, p.rho[i]); });
  }
  integrated.integrate(*core, p, boundaries, hooks, new_lists);
}

void FluidEvaluation::find_boundary_pressures(const Particles &p)
{
  for (int t = 1; t <= atom->ntypes; t++)
    if (extrapolates(t)) core->boundary_pressures(p, t, p_over_rho2.data());
  ghosts.send_to_ghosts(GhostData::DENSITY);
}

// New lists and virials change the shares of inactive particles.  An impulse has that of its active
// source; where steps are equal inactive particles sleep, and are walls.

void FluidEvaluation::find_viscosity_shares(const Particles &p)
{
  constexpr double WHOLE = 1.0;
  if (p.active)
    for (int i = 0; i < p.n_owned; i++)
      if (!p.is_active(i)) viscosity_shares[i] = WHOLE;
  for (int t = 1; t <= atom->ntypes; t++)
    if (is_fluid(t)) core->model.viscosity_switch[t] = viscosity_switch(t);
  core->viscosity_shares(p, viscosity_shares.data());
  ghosts.send_to_ghosts(GhostData::VISCOSITY);
  core->record_viscosity_shares(p, viscosity_shares.data());
}

void FluidEvaluation::find_frequencies()
{
  const Particles p = particles();
  const double *waits = hooks ? hooks->frequency_waits() : nullptr;
  if (stability.find_shares(*core)) ghosts.send_to_ghosts(GhostData::SHARE);
  stability.find_fluid(*core, p, boundaries, waits);
  if (stability.need_vertices(*core, p, boundaries, waits)) {
    stability.find_vertices(*core, p, boundaries);
    if (stability.any_vertices()) ghosts.send_to_ghosts(GhostData::STIFFNESS);
  }
  stability.find_rows(*core, p, boundaries, scaled.on());
  if (scaled.on()) scaled.bound_frequencies(*core, stability);
  if (hooks) hooks->note_frequencies();
}

// Inactive particles keep their pressure until lists are built: then it follows from the density.

void FluidEvaluation::find_pressures(const Particles &p)
{
  const double min = options.tension ? -std::numeric_limits<double>::max() : 0.0;
  const bool adapts = lattices.adapts_density();
  const auto find = [&](int i, int t) {
    const double rho = p.rho[i];
    double &term = p_over_rho2[i];
    term = std::max(equation_of_state(t).pressure(rho), min) / (rho * rho);
    if (adapts) term *= lattices.slope(i, t, rho);
    if (surface.on()) surface.set_pressure(i, core->model.pressure_scale[t] * term);
    term *= surface.along(i);
    // a density that is renormalized has a gradient that is
    for (FluidBoundary *boundary : renormalizing) term *= boundary->inverse_gamma(i);
    // neither true of what is not a number
    if (!(term < std::numeric_limits<double>::max()) || !(rho > 0.0))
      rank_error(lmp, FLERR,
                 "{}: particle {} has density {}: particles overlap or the time step is too large",
                 STYLE, atom->tag[i], rho);
  };
  if (!active || !(pressures_follow || new_lists)) return core->for_active_fluid(find);
  for (int i = 0; i < p.n_owned; i++)
    if (is_fluid(p.type[i])) find(i, p.type[i]);
}

double FluidEvaluation::bytes() const
{
  return (core ? core->bytes() : 0.0) + stability.bytes() + scaled.bytes() + integrated.bytes() +
      surface.bytes() + measured.bytes() +
      bytes_of(mass_or_volume, p_over_rho2, approach, viscosity_shares, active_fluid);
}
