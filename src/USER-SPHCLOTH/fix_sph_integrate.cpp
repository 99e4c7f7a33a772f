// Semi-implicit Euler (lines 30 to 33 of Algorithm 1) with a constant or a global time step,
// equations (10) to (12) and the limits in core/timestep/step_limits.h.

#include "fix_sph_integrate.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix_pbd_cloth.h"
#include "force.h"
#include "group.h"
#include "integrate.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/rank_error.h"
#include "lammps_util/restart_record.h"
#include "memory.h"
#include "modify.h"
#include "output.h"
#include "pair_sph_tait.h"
#include "sph_adaptive.h"
#include "stepping/block_steps.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace sphcloth;

/* ----------------------------------------------------------------------
   fix ID group sph/integrate constant|global keyword value ...
------------------------------------------------------------------------- */

FixSPHIntegrate::FixSPHIntegrate(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} sph/integrate", id)), pair(nullptr),
    said(SteppingScheme::CONSTANT), scheme(said), run_style_drives(false), floor(0.0),
    ceiling(update->dt), growth(2.0), times(lmp), ceiling_given(false), clamp_at_floor(false),
    state(nullptr), flies_alone(false), blocks(std::make_unique<BlockSteps>(lmp, this, rows)),
    previous(0.0), largest_before(0.0), limited_by(Limit::NONE), updates(0.0), steps_limited{},
    particles_limited{}
{
  time_integrate = 1;
  nevery = 1;
  comm_forward = 3;
  comm_reverse = 1;
  restart_global = 1;
  restart_peratom = 1;
  create_attribute = 1;
  scalar_flag = vector_flag = 1;
  size_vector = 5 + N_LIMITS - 1 + N_OF_PARTICLES + 4;
  global_freq = 1;
  extscalar = extvector = 0;
  peratom_flag = 1;
  size_peratom_cols = N_COLUMNS;
  peratom_freq = 1;
  dynamic_group_allow = 1;

  ArgReader args(lmp, label, narg, arg, 3);
  said = args.choice("scheme", {"constant", "global"}) ? SteppingScheme::GLOBAL
                                                       : SteppingScheme::CONSTANT;
  read_options(args);

  FixSPHIntegrate::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++) FixSPHIntegrate::set_arrays(i);
}

void FixSPHIntegrate::read_options(ArgReader &args)
{
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "velocity")
      lambda.velocity = args.at_least(keyword, 0.0);
    else if (keyword == "force")
      lambda.force = args.at_least(keyword, 0.0);
    else if (keyword == "acoustic")
      lambda.acoustic = args.at_least(keyword, 0.0);
    else if (keyword == "wetted")
      lambda.wetted = args.at_least(keyword, 0.0);
    else if (keyword == "viscous")
      lambda.viscous = args.at_least(keyword, 0.0);
    else if (keyword == "density")
      lambda.density = args.at_least(keyword, 0.0);
    else if (keyword == "relative")
      lambda.relative = args.at_least(keyword, 0.0);
    else if (keyword == "cloth")
      lambda.cloth = args.at_least(keyword, 0.0);
    else if (keyword == "fluctuation")
      control.eta = args.at_least(keyword, 0.0);
    else if (keyword == "output")
      times.interval = args.at_least(keyword, 0.0);
    else if (keyword == "until")
      times.until = args.positive(keyword);
    else if (keyword == "ratio") {
      blocks->options.ratio = args.integer(keyword, 2, 4);
      if (blocks->options.ratio == 3) args.fail(keyword, "3", "steps differ by 2 or 4");
    } else if (keyword == "gain")
      blocks->options.gain = args.at_least(keyword, 1.0);
    else if (keyword == "waking")
      blocks->options.waking = args.choice(keyword, {"no", "yes"});
    else if (keyword == "sleep")
      blocks->options.sleep = args.at_least(keyword, 0.0);
    else if (keyword == "min")
      floor = args.positive(keyword);
    else if (keyword == "max") {
      ceiling = args.positive(keyword);
      ceiling_given = true;
    } else if (keyword == "growth") {
      growth = args.number(keyword);
      if (growth <= 1.0 || growth > 2.0)
        args.fail(keyword, std::to_string(growth), "give a factor above 1, at most 2");
    } else if (keyword == "below")
      clamp_at_floor = args.choice(keyword, {"stop", "clamp"}) == 1;
    else
      args.unknown(
          keyword,
          "velocity, force, acoustic, wetted, viscous, density, relative, cloth, "
          "fluctuation, output, until, ratio, gain, waking, sleep, min, max, growth, below");
  }
  if (floor > ceiling)
    error->all(FLERR, "{}: min {} is above max {}: lower min or raise max (default: the timestep)",
               label, floor, ceiling);
}

FixSPHIntegrate::~FixSPHIntegrate()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  memory->destroy(state);
}

int FixSPHIntegrate::setmask() { return INITIAL_INTEGRATE | END_OF_STEP | POST_RUN; }

void FixSPHIntegrate::init()
{
  pair = dynamic_cast<PairSPHTait *>(force->pair_match("sph/tait", 1));
  if (!pair)
    error->all(FLERR, "{}: pair_style {} knows no density: use 'pair_style sph/tait'", label,
               force->pair_style ? force->pair_style : "none");
  if (modify->get_fix_by_style("^sph/integrate$").size() > 1)
    error->all(FLERR, "{}: there is another fix sph/integrate: keep one, with a group of all fluid",
               label);

  const auto *adaptive = dynamic_cast<SPHAdaptive *>(update->integrate);
  run_style_drives = adaptive != nullptr;
  scheme = adaptive ? adaptive->scheme() : said;
  check_scheme();
  pair->set_active(state, ACTIVE, scheme == SteppingScheme::INDIVIDUAL);
  flies_alone = scheme == SteppingScheme::GLOBAL;
  moving.n = -1;
  settle_types();
  cloths.clear();
  for (Fix *fix : modify->get_fix_by_style("^pbd/cloth$"))
    cloths.push_back(dynamic_cast<FixPBDCloth *>(fix));
  if (scheme != SteppingScheme::CONSTANT) {
    pair->want_density_rate();
    if (lambda.relative > 0.0) pair->want_approach();
    if (!cloths.empty()) pair->want_wetting();
  }

  int wrong = 0, any_wrong = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit && !pair->is_fluid(atom->type[i])) wrong = atom->type[i];
  MPI_Allreduce(&wrong, &any_wrong, 1, MPI_INT, MPI_MAX, world);
  if (any_wrong)
    error->all(
        FLERR,
        "{}: group {} holds type {}, a boundary type: integrate cloth with fix pbd/cloth, leave "
        "walls out",
        label, group->names[igroup], any_wrong);
}

void FixSPHIntegrate::settle_types()
{
  control.sound_time = std::numeric_limits<double>::infinity();
  fluids.assign(atom->ntypes + 1, FluidType());
  for (int t = 1; t <= atom->ntypes; t++) {
    FluidType &its = fluids[t];
    its.support = pair->support(t);
    if (!pair->is_fluid(t)) continue;
    its.eos = pair->equation_of_state(t);
    its.sound = its.eos.sound_speed();
    its.viscosity = pair->viscosity(t);
    control.sound_time = std::min(control.sound_time, 0.5 * its.support / its.sound);
  }
}

void FixSPHIntegrate::check_scheme()
{
  if (times.interval > 0.0 && scheme == SteppingScheme::CONSTANT)
    error->all(FLERR,
               "{}: output {} would shorten steps that are constant: use the scheme global, or a "
               "timestep that divides {}",
               label, times.interval, times.interval);
  const bool individual = scheme == SteppingScheme::INDIVIDUAL;
  if (!individual && scheme != SteppingScheme::BLOCK) return forget_rows();
  if (pair->integrates_density())
    error->all(
        FLERR,
        "{}: steps of individual particles need densities by summation, 'density continuity' "
        "integrates them: use 'density summation', or another scheme than {}",
        label, individual ? "individual" : "block");
  if (!individual && control.eta > 0.0)
    error->all(
        FLERR,
        "{}: fluctuation {} is for one step of all: leave it out, or use another scheme than "
        "block",
        label, control.eta);
  want_rows(individual ? +N_RATES : +BlockSteps::N_COLUMNS);
  if (!individual) blocks->init(pair);
}

void FixSPHIntegrate::want_rows(int columns)
{
  if (rows.count() == columns) return;
  forget_rows();
  rows.create(columns, atom->nmax);
  for (int i = 0; i < atom->nlocal; i++) set_row(i);
}

void FixSPHIntegrate::set_row(int i)
{
  rows.clear(i);
  if (rows.count() == BlockSteps::N_COLUMNS) blocks->set_new(i);
}

// of a run before, or a restart file, with steps of individual particles

void FixSPHIntegrate::forget_rows()
{
  if (rows.empty()) return;
  blocks->forget();
  for (int i = 0; i < atom->nlocal; i++) state[i][ACTIVE] = 1.0;
  rows.create(0, 0);
}

void FixSPHIntegrate::setup(int)
{
  if (scheme != SteppingScheme::CONSTANT) choose_step();
  times.look_for_end();
}

/* ----------------------------------------------------------------------
   lines 30 to 33: velocity first, then position with the new velocity
------------------------------------------------------------------------- */

void FixSPHIntegrate::initial_integrate(int)
{
  pair->advance(update->dt);
  switch (scheme) {
    case SteppingScheme::INDIVIDUAL: move_individually(); return select_active();
    case SteppingScheme::BLOCK:
      move_but([this](int i) { return blocks->sleeps(i); });
      return select_due();
    default: move_active();
  }
}

void FixSPHIntegrate::move_active()
{
  const auto [moved, rest] = move_but([this](int i) { return state[i][ACTIVE] == 0.0; });
  updates += moved;
  // while nobody rests, the pair style need not ask
  pair->set_active(rest ? state : nullptr, ACTIVE);
}

// how many move, and how many rest

template <class Rests> std::pair<int, int> FixSPHIntegrate::move_but(Rests rests)
{
  int moved = 0, rest = 0;
  const double dt = update->dt, dtf = dt * force->ftm2v;
  double **x = atom->x, **v = atom->v, **f = atom->f;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    if (rests(i)) {
      rest++;
      continue;
    }
    const double kick = dtf / atom_mass(atom, i);
    for (int d = 0; d < 3; d++) {
      v[i][d] += kick * f[i][d];
      x[i][d] += dt * v[i][d];
    }
    moved++;
  }
  return {moved, rest};
}

void FixSPHIntegrate::select_due()
{
  blocks->wake_moved();
  blocks->begin_step();
  const auto [due, rest] = blocks->mark_due(state, ACTIVE);
  updates += due;
  pair->set_active(rest ? state : nullptr, ACTIVE);
}

// From the last update, a time T ago, to now: v = v_last + T a, x = x_last + T v.  What is added to v
// and x in one step follows, so that others may move a particle in between.

void FixSPHIntegrate::move_individually()
{
  const double dt = update->dt, before = physical_time(update) - dt;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double elapsed = before - state[i][LAST_UPDATE];
    double *x = atom->x[i], *v = atom->v[i];
    for (int d = 0; d < 3; d++) {
      const double accel = rows[ACCEL + d][i];
      v[d] += dt * accel;
      x[d] += dt * (v[d] + elapsed * accel);
    }
  }
}

// (15): those whose own step, in whole steps of now, divides the number of the step.  The density of the
// others is interpolated, line 12.

void FixSPHIntegrate::select_active()
{
  const double dt = update->dt;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const bool active = update->ntimestep % whole_steps(state[i][OWN_STEP], dt) == 0;
    state[i][ACTIVE] = active;
    if (active)
      updates++;
    else
      atom->rho[i] += dt * rows[DENSITY][i];
  }
  pair->set_active(state, ACTIVE, true);
}

void FixSPHIntegrate::end_of_step()
{
  if (!run_style_drives) finish_step();
}

void FixSPHIntegrate::finish_step()
{
  previous = times.uncut() > 0.0 ? times.uncut() : update->dt;
  largest_before = compression.largest;
  steps_limited[static_cast<int>(limited_by)]++;
  if (scheme == SteppingScheme::BLOCK) {
    blocks->note_external_forces();
    limit_vertices();
  }
  if (scheme != SteppingScheme::CONSTANT) choose_step();
  times.look_for_end();
}

/* ----------------------------------------------------------------------
   the next step
------------------------------------------------------------------------- */

void FixSPHIntegrate::choose_step()
{
  if (scheme == SteppingScheme::BLOCK) return take_block_step();
  StepLimit wanted = tightest_anywhere();
  if (control.eta > 0.0) {
    compression = overall_compression();
    wanted.tighten(control.step(previous, compression, largest_before), Limit::FLUCTUATION);
  }
  StepLimit step = bounded_step(wanted, previous, growth, floor, ceiling);
  if (is_too_short(step)) error->all(FLERR, too_short(wanted, ""));
  if (times.any()) times.head_for(step);
  limited_by = step.by;
  if (step.dt != update->dt) apply(step.dt);
  if (times.arrives()) times.announce_thermo();
}

bool FixSPHIntegrate::is_too_short(const StepLimit &step) const
{
  return step.by == Limit::FLOOR && !clamp_at_floor;
}

std::string FixSPHIntegrate::too_short(const StepLimit &wanted, const std::string &whom) const
{
  return fmt::format("{}: the {} limit asks for a step of {}{}, below min {}: lower min, or use "
                     "'below clamp' to go on with min and count",
                     label, limit_name(wanted.by), wanted.dt, whom, floor);
}

// The pair style had it chosen, with the impulses that act in it.

void FixSPHIntegrate::take_block_step()
{
  limited_by = blocks->limited_by();
  times.set_arrives(blocks->arrives());
  if (const double dt = blocks->next_step(); dt != update->dt) apply(dt);
  if (times.arrives()) times.announce_thermo();
}

StepLimit FixSPHIntegrate::tightest_anywhere()
{
  const StepLimit mine = tightest_particle();
  struct {
    double dt;
    int by;
  } in = {mine.dt, static_cast<int>(mine.by)}, out;
  MPI_Allreduce(&in, &out, 1, MPI_DOUBLE_INT, MPI_MINLOC, world);
  return {out.dt, static_cast<Limit>(out.by)};
}

StepLimit FixSPHIntegrate::tightest_particle()
{
  const double now = physical_time(update);
  StepLimit tightest;
  particles_limited.fill(0.0);
  const auto take = [&](const StepLimit &own) {
    count(own);
    tightest.tighten(own.dt, own.by);
  };
  asked.clear();
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    if (state[i][ACTIVE] != 0.0 || rows.empty())
      asked.push_back(i);
    else
      take({state[i][OWN_STEP], static_cast<Limit>(static_cast<int>(rows[BY][i]))});
  }
  const auto force_on = [this](int i, double *f) { std::copy_n(atom->f[i], 3, f); };
  for_limits(asked, force_on, [&](int i, const StepLimit &own) {
    state[i][OWN_STEP] = std::min(own.dt, ceiling);
    state[i][LAST_UPDATE] = now;
    if (!rows.empty()) hold(i, own);
    take(own);
  });
  for_vertices([&](int i, const FixPBDCloth &cloth) {
    const StepLimit own = limit_of_vertex(i, cloth);
    take(own);
  });
  return tightest;
}

// of the fluid: force_on(i, f), take(i, limit)

template <class Force, class Take>
void FixSPHIntegrate::for_limits(const std::vector<int> &of, Force force_on, Take take) const
{
  StepStates states;
  StepLimits limits;
  const int n = static_cast<int>(of.size());
  for (int from = 0; from < n; from += StepStates::MOST) {
    const int *some = of.data() + from, m = std::min(n - from, StepStates::MOST);
    for (int k = 0; k < m; k++) {
      double f[3];
      force_on(some[k], f);
      states.set(k, particle_state(some[k], f));
    }
    particle_limits(lambda, states, m, limits);
    for (int k = 0; k < m; k++) take(some[k], limits[k]);
  }
}

// those that move

template <class Do> void FixSPHIntegrate::for_vertices(Do something) const
{
  for (const FixPBDCloth *cloth : cloths)
    for (int i = 0; i < atom->nlocal; i++)
      if (atom->mask[i] & cloth->groupbit && cloth->inverse_mass(i) > 0.0) something(i, *cloth);
}

StepLimit FixSPHIntegrate::limit_of_vertex(int i, const FixPBDCloth &cloth) const
{
  const double edge = lambda.cloth > 0.0 ? cloth.shortest_edge(i) : 0.0;
  return vertex_limit(lambda, vertex_state(i), edge);
}

/* ----------------------------------------------------------------------
   steps in powers of two
------------------------------------------------------------------------- */

StepLimit FixSPHIntegrate::find_steps(const std::vector<int> &of, const double *const *external,
                                      bool looks_around, double *dt, double *by)
{
  flies_alone = !looks_around;
  StepLimit tightest;
  const auto force_on = [&](int i, double *f) {
    for (int d = 0; d < 3; d++) f[d] = atom->f[i][d] + external[d][i];
  };
  for_limits(of, force_on, [&](int i, const StepLimit &wanted) {
    const StepLimit step = bounded_step(wanted, dt[i], growth, floor, ceiling);
    if (is_too_short(step))
      rank_error(lmp, FLERR, too_short(wanted, fmt::format(" for particle {}", atom->tag[i])));
    dt[i] = step.dt;
    by[i] = static_cast<double>(step.by);
    tightest.tighten(step.dt, step.by);
  });
  return tightest;
}

double FixSPHIntegrate::sound_time(int i) const
{
  const FluidType &fluid = fluids[atom->type[i]];
  return fluid.support / fluid.sound;
}

double FixSPHIntegrate::acceleration(int i, double by) const
{
  return by * force->ftm2v / atom_mass(atom, i);
}

// Vertices move in every step of the scene, which is no longer than what any of them allows.

void FixSPHIntegrate::limit_vertices()
{
  for_vertices([&](int i, const FixPBDCloth &cloth) {
    const StepLimit own = limit_of_vertex(i, cloth);
    state[i][OWN_STEP] = own.dt;
    rows[BlockSteps::BY][i] = static_cast<double>(own.by);
  });
  moving.n = -1;
}

double FixSPHIntegrate::vertex_step(int i) const
{
  return pair->is_fluid(atom->type[i]) ? 0.0 : state[i][OWN_STEP];
}

// A mesh that fills the kernel knows how wet it is when the first step has been taken.

const FixSPHIntegrate::Vertices &FixSPHIntegrate::vertices()
{
  if (moving.n >= 0) return moving;
  moving = {0, {ceiling, Limit::CEILING}};
  for_vertices([&](int i, const FixPBDCloth &) {
    moving.n++;
    const double dt = state[i][OWN_STEP], by = rows[BlockSteps::BY][i];
    if (dt > 0.0) moving.tightest.tighten(dt, static_cast<Limit>(static_cast<int>(by)));
  });
  return moving;
}

/* ----------------------------------------------------------------------
   what a particle brings along
------------------------------------------------------------------------- */

// what goes on until the next update

void FixSPHIntegrate::hold(int i, const StepLimit &own)
{
  const double to_accel = force->ftm2v / atom_mass(atom, i);
  for (int d = 0; d < 3; d++) rows[ACCEL + d][i] = to_accel * atom->f[i][d];
  rows[DENSITY][i] = atom->drho[i];
  rows[BY][i] = static_cast<double>(own.by);
}

void FixSPHIntegrate::count_blocks()
{
  particles_limited.fill(0.0);
  for (int i = 0; i < atom->nlocal; i++)
    if (state[i][OWN_STEP] > 0.0)
      count({state[i][OWN_STEP], static_cast<Limit>(static_cast<int>(rows[BlockSteps::BY][i]))});
}

void FixSPHIntegrate::count(const StepLimit &own)
{
  const Limit by = own.dt < ceiling ? own.by : Limit::CEILING;
  // in blocks floor and growth bound a particle as well: then none of its own limits does
  if (by <= Limit::CEILING) particles_limited[static_cast<int>(by)]++;
}

// what every kind of particle has; returns its mass

inline double FixSPHIntegrate::speed_and_force(int i, const double *f, StepState &s) const
{
  const double mass = atom_mass(atom, i);
  const double *v = atom->v[i];
  const double to_accel = force->ftm2v / mass;
  s.support = fluids[atom->type[i]].support;
  s.speed_sq = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  s.accel_sq = to_accel * to_accel * (f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  return mass;
}

inline StepState FixSPHIntegrate::particle_state(int i, const double *f) const
{
  StepState s{};
  speed_and_force(i, f, s);
  const FluidType &fluid = fluids[atom->type[i]];
  s.rho = atom->rho[i];
  s.nu = fluid.viscosity;
  s.sound = fluid.sound * fluid.eos.stiffening(s.rho);
  if (lambda.relative > 0.0) s.approach = pair->approach_speed(i);
  const bool flies = pair->p_over_rho2()[i] == 0.0;
  if (flies) s.until_pressed = until_pressed(i, fluid.eos.rho0 - s.rho, s.sound);
  // nothing is compressed in free flight, but individual steps interpolate the density
  if (!flies || scheme == SteppingScheme::INDIVIDUAL) s.drho = atom->drho[i];
  return s;
}

// Neighbours under a pressure p push each other and it together: the density grows ever faster, by
// p/h_s^2.  With one step for all theirs is short enough, and it flies alone; nor are they asked where its own
// sound, or the ceiling, allows less.

double FixSPHIntegrate::until_pressed(int i, double gap, double sound) const
{
  const double alone = time_to_cross(gap, atom->drho[i], 0.0);
  const double smoothing = 0.5 * fluids[atom->type[i]].support;
  const double by_sound = lambda.acoustic * smoothing / sound;
  if (flies_alone || 0.5 * alone <= by_sound || ceiling <= by_sound) return alone;
  const double ratio = atom->rho[i] / smoothing;
  return time_to_cross(gap, atom->drho[i], pair->p_over_rho2_beside(i) * ratio * ratio);
}

// Fluid acts on a light vertex like a spring on a light mass: the sound that limits the step is
// faster by the root of the ratio of the masses (added mass).

StepState FixSPHIntegrate::vertex_state(int i) const
{
  StepState s{};
  const double mass = speed_and_force(i, atom->f[i], s);
  const PairSPHTait::Wetting wet = pair->wetting(i);
  s.sound = wet.sound * std::sqrt(std::max(1.0, wet.fluid_mass / mass));
  return s;
}

// Everybody who keeps a copy of dt is told, and the time reached so far is booked first.

void FixSPHIntegrate::apply(double dt)
{
  update->update_time();
  update->dt = dt;
  update->dt_default = 0;
  update->integrate->reset_dt();
  if (force->pair) force->pair->reset_dt();
  for (Fix *other : modify->get_fix_list()) other->reset_dt();
  output->reset_dt();
  if (output->any_time_dumps && update->setupflag == 0) reschedule_dumps();
}

// LAMMPS has found anew at which step each dump by time is due, but if that is earlier now, dumps of
// style atom or xyz would be overlooked.

void FixSPHIntegrate::reschedule_dumps()
{
  for (int k = 0; k < output->ndump; k++)
    output->next_dump_any = k ? std::min(output->next_dump_any, output->next_dump[k])
                              : output->next_dump[k];
  output->next = std::min({output->next_dump_any, output->next_restart, output->next_thermo});
}

/* ----------------------------------------------------------------------
   output
------------------------------------------------------------------------- */

void FixSPHIntegrate::post_run()
{
  times.end_run();
  if (comm->me || scheme == SteppingScheme::CONSTANT) return;
  std::string line;
  for (int k = 1; k < N_LIMITS; k++)
    if (steps_limited[k] > 0.0)
      line += fmt::format(" {} {:.0f}", limit_name(static_cast<Limit>(k)), steps_limited[k]);
  utils::logmesg(lmp, "{}: steps by limit:{}\n", label, line);
}

double FixSPHIntegrate::own_step(int i) const
{
  // nobody asks for limits where the step is constant
  return scheme == SteppingScheme::CONSTANT ? update->dt : state[i][OWN_STEP];
}

double FixSPHIntegrate::compute_scalar() { return update->dt; }

// limit in force, active fraction, particle updates, largest compression, steps clamped at min,
// then steps by limit, particles by limit, whether this is an output time, the step for thermo,
// particles that sleep and ideal updates

double FixSPHIntegrate::compute_vector(int n)
{
  constexpr int PARTICLES = 5 + N_LIMITS - 1, TIMES = PARTICLES + N_OF_PARTICLES;
  if (n == TIMES) return times.is_now();
  if (n == TIMES + 1) return static_cast<double>(times.next_thermo());
  if (n > TIMES && !blocks->begun()) return 0.0;
  if (n == TIMES + 2) return sum_over_ranks(blocks->sleepers());
  if (n == TIMES + 3) return sum_over_ranks(blocks->ideal_updates());
  if (n >= PARTICLES) {
    if (blocks->begun()) count_blocks();
    return sum_over_ranks(particles_limited[n - PARTICLES + 1]);
  }
  if (n >= 5) return steps_limited[n - 4];
  switch (n) {
    case 0: return static_cast<double>(limited_by);
    case 1: {
      double mine[2] = {0.0, 0.0}, all[2];
      for (int i = 0; i < atom->nlocal; i++)
        if (atom->mask[i] & groupbit) {
          mine[0] += state[i][ACTIVE];
          mine[1] += 1.0;
        }
      MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, world);
      return all[1] > 0.0 ? all[0] / all[1] : 0.0;
    }
    case 2: return sum_over_ranks(updates);
    case 3: {
      double mine = largest_compression(), all;
      MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_MAX, world);
      return all;
    }
    default: return steps_limited[static_cast<int>(Limit::FLOOR)];
  }
}

double FixSPHIntegrate::largest_compression() const
{
  double largest = 0.0;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit)
      largest = std::max(largest, atom->rho[i] / pair->equation_of_state(atom->type[i]).rho0 - 1.0);
  return largest;
}

Compression FixSPHIntegrate::overall_compression() const
{
  double largest = largest_compression(), mine[2] = {0.0, 0.0}, all[2];
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) {
      const double rho0 = pair->equation_of_state(atom->type[i]).rho0;
      mine[0] += std::max(0.0, atom->rho[i] / rho0 - 1.0);
      mine[1] += 1.0;
    }
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, world);
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, world);
  return {largest, all[1] > 0.0 ? all[0] / all[1] : 0.0};
}

double FixSPHIntegrate::sum_over_ranks(double mine) const
{
  double all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

/* ----------------------------------------------------------------------
   restart: the step before, the ceiling unless it is given anew, the counters
------------------------------------------------------------------------- */

struct FixSPHIntegrate::Record {
  double previous, ceiling, updates, ideal_updates, largest_before;
  Limit limited_by;
  std::array<double, N_LIMITS> steps_limited;
  BlockSteps::Place blocks;
};

void FixSPHIntegrate::write_restart(FILE *fp)
{
  const double mine[2] = {updates, blocks->ideal_updates()};
  double all[2] = {0.0, 0.0};
  MPI_Reduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, 0, world);
  if (comm->me) return;
  const Record record{previous,       ceiling,    all[0],        all[1],
                      largest_before, limited_by, steps_limited, blocks->place()};
  write_record(fp, record);
}

void FixSPHIntegrate::restart(char *buf)
{
  const auto record = read_record<Record>(buf, label, error);
  keep_restored_time(update);
  previous = record.previous;
  // the time step that LAMMPS restored is the last one that was taken, no ceiling
  if (!ceiling_given) ceiling = record.ceiling;
  limited_by = record.limited_by;
  updates = comm->me == 0 ? record.updates : 0.0;
  blocks->set_ideal_updates(comm->me == 0 ? record.ideal_updates : 0.0);
  largest_before = record.largest_before;
  steps_limited = record.steps_limited;
  blocks->go_to(record.blocks);
}

/* ----------------------------------------------------------------------
   ghosts of particles with steps in powers of two
------------------------------------------------------------------------- */

int FixSPHIntegrate::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  return blocks->pack_forward(n, list, buf);
}

void FixSPHIntegrate::unpack_forward_comm(int n, int first, double *buf)
{
  blocks->unpack_forward(n, first, buf);
}

int FixSPHIntegrate::pack_reverse_comm(int n, int first, double *buf)
{
  return blocks->pack_reverse(n, first, buf);
}

void FixSPHIntegrate::unpack_reverse_comm(int n, int *list, double *buf)
{
  blocks->unpack_reverse(n, list, buf);
}

/* ----------------------------------------------------------------------
   per-particle state
------------------------------------------------------------------------- */

void FixSPHIntegrate::grow_arrays(int nmax)
{
  memory->grow(state, nmax, N_COLUMNS, "sph/integrate:state");
  rows.grow(nmax);
  array_atom = state;
  if (pair) pair->set_active(state, ACTIVE, scheme == SteppingScheme::INDIVIDUAL);
}

void FixSPHIntegrate::copy_arrays(int i, int j, int)
{
  std::copy(state[i], state[i] + N_COLUMNS, state[j]);
  rows.copy(i, j);
}

void FixSPHIntegrate::set_arrays(int i)
{
  state[i][OWN_STEP] = state[i][LAST_UPDATE] = 0.0;
  state[i][ACTIVE] = 1.0;
  if (!rows.empty()) set_row(i);
}

int FixSPHIntegrate::pack_exchange(int i, double *buf)
{
  double *end = std::copy(state[i], state[i] + N_COLUMNS, buf);
  return static_cast<int>(rows.pack(i, end) - buf);
}

int FixSPHIntegrate::unpack_exchange(int i, double *buf)
{
  std::copy(buf, buf + N_COLUMNS, state[i]);
  rows.unpack(i, buf + N_COLUMNS);
  return N_COLUMNS + rows.count();
}

// The first value of a record is its length.  Only individual steps have more to say.

int FixSPHIntegrate::pack_restart(int i, double *buf)
{
  buf[0] = rows.empty() ? 1 : 1 + pack_exchange(i, buf + 1);
  return static_cast<int>(buf[0]);
}

void FixSPHIntegrate::unpack_restart(int i, int nth)
{
  const double *record = atom->extra[i];
  for (int k = 0; k < nth; k++) record += static_cast<int>(*record);
  if (*record == 1.0) return;
  want_rows(static_cast<int>(*record) - 1 - N_COLUMNS);
  std::copy(record + 1, record + 1 + N_COLUMNS, state[i]);
  rows.unpack(i, record + 1 + N_COLUMNS);
}

int FixSPHIntegrate::size_restart(int) { return maxsize_restart(); }
int FixSPHIntegrate::maxsize_restart() { return rows.empty() ? 1 : 1 + N_COLUMNS + rows.count(); }

double FixSPHIntegrate::memory_usage()
{
  return static_cast<double>(sizeof(double)) * N_COLUMNS * atom->nmax + rows.bytes() +
      blocks->bytes() + bytes_of(asked);
}
