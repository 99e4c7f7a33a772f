// SPDX-License-Identifier: GPL-2.0-or-later
// The adapter of stepping schemes to LAMMPS.

#include "fix_sph_integrate.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "group.h"
#include "integrate.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/rank_error.h"
#include "lammps_util/restart_record.h"
#include "lammps_util/timed_dumps.h"
#include "memory.h"
#include "modify.h"
#include "stepping/make_stepper.h"
#include "stepping/styles_beside.h"
#include "update.h"

#include <algorithm>
#include <array>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace sphcloth;

/* ----------------------------------------------------------------------
   fix ID group sph/integrate [constant|global keyword value ...]
------------------------------------------------------------------------- */

FixSPHIntegrate::FixSPHIntegrate(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} sph/integrate", id)), fluid(nullptr),
    limits(lmp_, options), control(lmp_, options, label, groupbit), report(lmp_, options, groupbit),
    sound(lmp_), scheme(SteppingScheme::CONSTANT), run_style_drives(false), has_moved(false),
    restored_step(0.0)
{
  time_integrate = 1;
  nevery = 1;
  comm_forward = 3;
  comm_reverse = 4;
  restart_global = 1;
  restart_peratom = 1;
  create_attribute = 1;
  scalar_flag = vector_flag = 1;
  size_vector = StepReport::N_OUTPUTS;
  global_freq = 1;
  extscalar = extvector = 0;
  peratom_flag = 1;
  size_peratom_cols = UpdateRows::N_COLUMNS;
  peratom_freq = 1;
  dynamic_group_allow = 1;

  ArgReader args(lmp, label, narg, arg, 3);
  options.scheme = args.more() && !args.choice("scheme", {"constant", "global"})
      ? SteppingScheme::CONSTANT
      : SteppingScheme::GLOBAL;
  options.ceiling = update->dt;
  options.read(args, control.times);
  if (!(options.ceiling > 0.0))
    error->all(FLERR, "{}: max is the time step, {}: it must be above 0: give 'timestep DT' before",
               label, options.ceiling);
  if (options.min > options.ceiling)
    error->all(FLERR, "{}: min {} is above max {}: lower min or raise max (default: the timestep)",
               label, options.min, options.ceiling);

  use_scheme(options.scheme, BlockClock());
  FixSPHIntegrate::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++) FixSPHIntegrate::set_arrays(i);
}

FixSPHIntegrate::~FixSPHIntegrate()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  memory->destroy(rows.row);
}

int FixSPHIntegrate::setmask() { return INITIAL_INTEGRATE | END_OF_STEP | POST_RUN; }

void FixSPHIntegrate::init()
{
  fluid = FluidState::find(force);
  if (!fluid)
    error->all(FLERR, "{}: pair_style {} knows no density: use 'pair_style sph/tait'", label,
               force->pair_style ? force->pair_style : "none");
  if (modify->get_fix_by_style("^sph/integrate$").size() > 1)
    error->all(FLERR, "{}: there is another fix sph/integrate: keep one, with a group of all fluid",
               label);

  const auto *run_style = dynamic_cast<HasSteppingScheme *>(update->integrate);
  run_style_drives = run_style != nullptr;
  const SteppingScheme wanted = run_style ? run_style->stepping_scheme() : options.scheme;
  options.check(wanted, control.times, *fluid, label, error);
  if (update->whichflag == 1 && wanted == SteppingScheme::CONSTANT && !(update->dt > 0.0))
    error->all(FLERR, "{}: the time step is {}: it must be above 0: give 'timestep DT'", label,
               update->dt);
  check_styles_beside(lmp, label, wanted, *fluid);
  use_scheme(wanted, BlockClock());
  take_up_restored_step();
  if (update->whichflag == 2 && updates_some())
    error->all(FLERR,
               "{}: with run_style sph/adaptive {} minimize would update the particles that are "
               "due alone: use 'run_style verlet' before",
               label, scheme_name(scheme));
  sound.begin_run(fluid);
  limits.init(fluid, scheme);
  const bool scales = options.scales_mass(scheme);
  if (scales == springs.empty()) springs.create(scales ? 1 : 0, atom->nmax);
  if (scales) fluid->scaled_mass().want(groupbit, springs);
  control.init(fluid, limits.shortest_sound_time());
  const int change_here = static_cast<int>(first_kick.begin_run(atom, domain));
  int change;
  MPI_Allreduce(&change_here, &change, 1, MPI_INT, MPI_MAX, world);
  stepper->init(fluid, static_cast<Change>(change));
  // of a global step that comes later
  if (scheme != SteppingScheme::GLOBAL) control.watch.demand();
  fluid->take_pair_evaluations();    // before this run
  check_group();
}

// What the scheme before kept of particles is void, and they are all active; the same scheme goes
// on.

void FixSPHIntegrate::use_scheme(SteppingScheme wanted, const BlockClock &clock)
{
  if (stepper && wanted == scheme) return;
  if (stepper && !stepper->columns().empty())
    for (int i = 0; i < atom->nlocal; i++) rows[i][UpdateRows::ACTIVE] = 1.0;
  scheme = wanted;
  stepper =
      make_stepper(lmp, scheme, {this, options, rows, first_kick, limits, control, report}, clock);
}

void FixSPHIntegrate::check_group()
{
  if (const int type = fluid->foreign_type_in(groupbit))
    error->all(
        FLERR,
        "{}: group {} holds type {}, {}: integrate cloth with fix pbd/cloth, leave walls out",
        label, group->names[igroup], type, fluid->kind(type));
}

// The step of the script is the ceiling.  How far ghosts reach, and by that the order of sums,
// follows from the step before setup() chooses one.

void FixSPHIntegrate::take_up_restored_step()
{
  if (restored_step > 0.0 && scheme != SteppingScheme::CONSTANT)
    control.resume(restored_step, this);
  restored_step = 0.0;
}

/* ----------------------------------------------------------------------
   steps
------------------------------------------------------------------------- */

void FixSPHIntegrate::setup(int)
{
  if (!run_style_drives) begin_steps();
}

// Forces are complete where the run style calls this.

void FixSPHIntegrate::begin_steps()
{
  const double now = physical_time(update), jump = control.jump(now);
  if (jump != 0.0) stepper->shift_times(jump);
  control.set_time(now);
  has_moved = false;
  stepper->choose_step();
  control.times.look_for_end();
}

void FixSPHIntegrate::initial_integrate(int)
{
  if (control.jump(physical_time(update) - update->dt) != 0.0)
    error->all(FLERR, "{}: the time has been reset since the last step: leave 'pre no' out of run",
               label);
  has_moved = true;
  sound.elapsed += update->dt;
  if (stepper->updates_all_next() && sound.update()) {
    limits.take_materials();
    control.set_sound_time(limits.shortest_sound_time());
    stepper->forget_stability();
  }
  control.begin_step();
  fluid->advance(update->dt);
  stepper->move();
}

// Rerun evaluates without steps.

void FixSPHIntegrate::end_of_step()
{
  if (!has_moved && updates_some())
    error->all(FLERR,
               "{}: with run_style sph/adaptive {} rerun would update the particles that are due "
               "alone: use 'run_style verlet' before",
               label, scheme_name(scheme));
  if (!has_moved && fluid->integrates_density())
    error->all(FLERR,
               "{}: rerun reads no densities, and 'density continuity' would take those of before: "
               "use 'density summation' or 'density calibrated'",
               label);
  if (!run_style_drives) finish_step();
}

void FixSPHIntegrate::finish_step()
{
  control.end_step();
  report.count_step(control.limited_by());
  report.pair_evaluations += fluid->take_pair_evaluations();
  stepper->end_step();
  stepper->choose_step();
  control.times.look_for_end();
  renew_computes_for_timed_dumps(lmp);
}

/* ----------------------------------------------------------------------
   output
------------------------------------------------------------------------- */

void FixSPHIntegrate::post_run()
{
  control.times.end_run();
  first_kick.end_run(atom);
  control.watch.end_run([this] { return limits.settings(); });
  if (scheme == SteppingScheme::CONSTANT) return;
  const std::string waits = scheme == SteppingScheme::INDIVIDUAL ? label + report.waits_in_words()
                                                                 : "";
  if (comm->me) return;
  utils::logmesg(lmp, "{}: steps by limit:{}\n{}", label, report.steps_in_words(), waits);
}

double FixSPHIntegrate::own_step(int i) const
{
  // no limits are found where the step is constant
  return scheme == SteppingScheme::CONSTANT ? update->dt : rows[i][UpdateRows::OWN_STEP];
}

double FixSPHIntegrate::compute_scalar() { return update->dt; }

double FixSPHIntegrate::compute_vector(int n)
{
  return report.output(n, *stepper, control, sound, rows);
}

/* ----------------------------------------------------------------------
   restart: the step before, the ceiling unless it is given anew, the counters
------------------------------------------------------------------------- */

struct FixSPHIntegrate::Record {
  double previous, next, ceiling, updates, ideal_updates, waits, longest_wait, largest_before;
  Limit limited_by;
  bigint steps;
  double time;
  StabilityWatch::State watch;
  std::array<double, N_LIMITS> steps_by_limit;
  BlockClock clock;
  SteppingScheme scheme;
  double sound_work, sound_elapsed;
  int sound_columns;
  double pair_evaluations;
  int spring_columns;
};

void FixSPHIntegrate::write_restart(FILE *fp)
{
  control.watch.end_run([this] { return limits.settings(); });
  const double mine[5] = {report.updates, report.ideal_updates, report.waits, sound.work,
                          report.pair_evaluations};
  double all[5] = {0.0, 0.0, 0.0, 0.0, 0.0}, longest_wait = 0.0;
  MPI_Reduce(mine, all, 5, MPI_DOUBLE, MPI_SUM, 0, world);
  MPI_Reduce(&report.longest_wait, &longest_wait, 1, MPI_DOUBLE, MPI_MAX, 0, world);
  if (comm->me) return;
  const StepControl::State state = control.state();
  const Record record{state.previous,
                      update->dt,
                      options.ceiling,
                      all[0],
                      all[1],
                      all[2],
                      longest_wait,
                      state.largest_before,
                      state.limited_by,
                      state.steps,
                      state.time,
                      state.watch,
                      report.steps_by_limit,
                      stepper->clock() ? *stepper->clock() : BlockClock(),
                      scheme,
                      all[3],
                      sound.elapsed,
                      sound.columns.count(),
                      all[4],
                      springs.count()};
  write_record(fp, record);
}

void FixSPHIntegrate::restart(char *buf)
{
  const auto record = read_record<Record>(buf, label, error);
  keep_restored_time(update);
  control.restore({record.previous, record.largest_before, record.limited_by, record.steps,
                   record.time, record.watch});
  restored_step = record.next;
  // the time step that LAMMPS restored is the last one that was taken, no ceiling
  if (!options.ceiling_given) options.ceiling = record.ceiling;
  report.updates = comm->me == 0 ? record.updates : 0.0;
  report.ideal_updates = comm->me == 0 ? record.ideal_updates : 0.0;
  report.waits = comm->me == 0 ? record.waits : 0.0;
  report.pair_evaluations = comm->me == 0 ? record.pair_evaluations : 0.0;
  report.longest_wait = record.longest_wait;
  report.steps_by_limit = record.steps_by_limit;
  sound.work = comm->me == 0 ? record.sound_work : 0.0;
  sound.elapsed = record.sound_elapsed;
  sound.columns.create(record.sound_columns, atom->nmax);
  springs.create(record.spring_columns, atom->nmax);
  // what each scheme keeps of the atoms follows, see unpack_restart(): a uniform step keeps nothing
  if (record.scheme == SteppingScheme::INDIVIDUAL || record.scheme == SteppingScheme::BLOCK)
    use_scheme(record.scheme, record.clock);
}

/* ----------------------------------------------------------------------
   atoms: a row, then what the scheme keeps
------------------------------------------------------------------------- */

void FixSPHIntegrate::grow_arrays(int nmax)
{
  memory->grow(rows.row, nmax, UpdateRows::N_COLUMNS, "sph/integrate:rows");
  array_atom = rows.row;
  first_kick.columns.grow(nmax);
  sound.columns.grow(nmax);
  springs.grow(nmax);
  stepper->grow(nmax);
}

void FixSPHIntegrate::copy_arrays(int i, int j, int)
{
  std::copy(rows[i], rows[i] + UpdateRows::N_COLUMNS, rows[j]);
  first_kick.columns.copy(i, j);
  sound.columns.copy(i, j);
  springs.copy(i, j);
  stepper->columns().copy(i, j);
}

void FixSPHIntegrate::set_arrays(int i)
{
  std::fill_n(rows[i], UpdateRows::N_COLUMNS, 0.0);
  rows[i][UpdateRows::ACTIVE] = 1.0;
  first_kick.add_particle(i, update->whichflag != 0);
  sound.columns.clear(i);
  springs.clear(i);
  stepper->columns().clear(i);
  stepper->add_particle(i);
}

int FixSPHIntegrate::pack_exchange(int i, double *buf)
{
  double *end = std::copy(rows[i], rows[i] + UpdateRows::N_COLUMNS, pack_always_kept(i, buf));
  return static_cast<int>(stepper->columns().pack(i, end) - buf);
}

int FixSPHIntegrate::unpack_exchange(int i, double *buf)
{
  buf = unpack_always_kept(i, buf);
  std::copy(buf, buf + UpdateRows::N_COLUMNS, rows[i]);
  stepper->columns().unpack(i, buf + UpdateRows::N_COLUMNS);
  return n_exchanged();
}

// What every scheme keeps; both return where the rest begins.

double *FixSPHIntegrate::pack_always_kept(int i, double *buf) const
{
  return springs.pack(i, sound.columns.pack(i, first_kick.columns.pack(i, buf)));
}

double *FixSPHIntegrate::unpack_always_kept(int i, double *buf)
{
  first_kick.columns.unpack(i, buf);
  sound.columns.unpack(i, buf + first_kick.columns.count());
  springs.unpack(i, buf + first_kick.columns.count() + sound.columns.count());
  return buf + n_always_kept();
}

// The first value of a record is its length.  A uniform step keeps no more than whether the
// velocity is staggered; restart() has read the scheme that has written the columns.

int FixSPHIntegrate::pack_restart(int i, double *buf)
{
  buf[0] = maxsize_restart();
  if (stepper->columns().empty())
    pack_always_kept(i, buf + 1);
  else
    pack_exchange(i, buf + 1);
  return static_cast<int>(buf[0]);
}

void FixSPHIntegrate::unpack_restart(int i, int nth)
{
  double *record = atom->extra[i];
  for (int k = 0; k < nth; k++) record += static_cast<int>(*record);
  if (static_cast<int>(*record) != maxsize_restart())
    rank_error(lmp, FLERR,
               "{}: atom {} has {} numbers in the restart file, {} are kept here: its record is "
               "damaged, or of another release of sphcloth: take another file",
               label, atom->tag[i], *record, maxsize_restart());
  if (stepper->columns().empty())
    unpack_always_kept(i, record + 1);
  else
    unpack_exchange(i, record + 1);
}

int FixSPHIntegrate::size_restart(int) { return maxsize_restart(); }

int FixSPHIntegrate::maxsize_restart()
{
  return 1 + (stepper->columns().empty() ? n_always_kept() : n_exchanged());
}

double FixSPHIntegrate::memory_usage()
{
  return static_cast<double>(sizeof(double)) * UpdateRows::N_COLUMNS * atom->nmax +
      first_kick.columns.bytes() + sound.columns.bytes() + springs.bytes() + stepper->bytes();
}
