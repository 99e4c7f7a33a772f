// SPDX-License-Identifier: GPL-2.0-or-later
// A watchdog.  It looks every so many steps, and in every step at whose end LAMMPS writes a restart
// file, before it does: a state that has left the limits is never written over one that was within.

#include "fix_sph_watch.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix_pbd_cloth.h"
#include "fix_sph_drain.h"
#include "fix_sph_emit.h"
#include "fix_sph_integrate.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "group.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/restart_record.h"
#include "modify.h"
#include "output.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

using namespace LAMMPS_NS;
using namespace FixConst;

// atoms that an error names
static constexpr int MAX_SUSPECTS = 5;

// what is not finite
static constexpr int POSITION = 1, VELOCITY = 2, FORCE = 4, RHO = 8;

/* ----------------------------------------------------------------------
   fix ID group sph/watch keyword value ...
------------------------------------------------------------------------- */

FixSPHWatch::FixSPHWatch(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} sph/watch", id)), interval(20), keep(1000),
    fluid(nullptr), begun(false), scale{0.0, 0.0}, checks(0.0), seen{}
{
  nevery = 1;
  restart_global = 1;
  scalar_flag = vector_flag = 1;
  size_vector = N_LIMITS - 1;
  global_freq = 1;
  extscalar = extvector = 0;
  dynamic_group_allow = 1;
  allowed.fill(-1.0);
  allowed[FINITE] = 0.0;

  ArgReader args(lmp, label, narg, arg, 3);
  read_options(args);
  if (!file.empty()) keep_files();
}

// LAMMPS keeps one pair of files, beside single ones.

void FixSPHWatch::keep_files()
{
  std::vector<std::string> words{std::to_string(keep), file + ".1", file + ".2"};
  if (output->restart_flag_double &&
      (words[1] != output->restart2a || words[2] != output->restart2b))
    error->all(FLERR,
               "{}: restart {} would replace the command 'restart N {} {}' from before: leave the "
               "keyword out, or give 'restart N FILE' there",
               label, file, output->restart2a, output->restart2b);
  std::vector<char *> pointers;
  pointers.reserve(words.size());
  for (std::string &word : words) pointers.push_back(word.data());
  output->create_restart(static_cast<int>(pointers.size()), pointers.data());
}

void FixSPHWatch::read_options(ArgReader &args)
{
  const auto limit = [&](Limit which, const std::string &keyword) {
    const double max_value = args.at_least(keyword, 0.0);
    allowed[which] = max_value > 0.0 ? max_value : -1.0;
  };
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "every")
      interval = args.integer(keyword, 1, MAXSMALLINT);
    else if (keyword == "finite")
      allowed[FINITE] = args.choice(keyword, {"no", "yes"}) ? 0.0 : -1.0;
    else if (keyword == "density")
      limit(DENSITY, keyword);
    else if (keyword == "speed")
      limit(SPEED, keyword);
    else if (keyword == "mass")
      limit(MASS, keyword);
    else if (keyword == "momentum")
      limit(MOMENTUM, keyword);
    else if (keyword == "energy")
      limit(ENERGY, keyword);
    else if (keyword == "restart")
      file = args.word("restart file");
    else if (keyword == "keep")
      keep = args.integer(keyword, 1, MAXSMALLINT);
    else
      args.unknown(keyword, "every, finite, density, speed, mass, momentum, energy, restart, keep");
  }
}

int FixSPHWatch::setmask() { return END_OF_STEP; }

void FixSPHWatch::init()
{
  fluid = FluidState::find(force);
  if (is_on(DENSITY)) need_fluid();
  find_partners();
}

void FixSPHWatch::need_fluid()
{
  if (fluid) return;
  error->all(FLERR,
             "{}: density is {}, but pair_style {} knows no density: use 'pair_style sph/tait', or "
             "'density 0'",
             label, allowed[DENSITY], force->pair_style ? force->pair_style : "none");
}

// fixes that add or take out particles, and those that hold energy or momentum

void FixSPHWatch::find_partners()
{
  sources.clear();
  sinks.clear();
  cloths.clear();
  integrators.clear();
  if (!balances()) return;
  for (Fix *fix : modify->get_fix_list()) {
    auto *source = dynamic_cast<FixSPHEmit *>(fix);
    auto *sink = dynamic_cast<FixSPHDrain *>(fix);
    auto *cloth = dynamic_cast<FixPBDCloth *>(fix);
    auto *integrator = dynamic_cast<FixSPHIntegrate *>(fix);
    if ((source || sink) && !covers(fix))
      error->all(FLERR,
                 "{}: particles of fix {} come or go in group {}, their mass is balanced in group "
                 "{}: watch group all or {}",
                 label, fix->id, group->names[fix->igroup], group->names[igroup],
                 group->names[fix->igroup]);
    if (source) sources.push_back(source);
    if (sink) sinks.push_back(sink);
    if (cloth && covers(cloth)) cloths.push_back(cloth);
    if (integrator) integrators.push_back(integrator);
  }
}

bool FixSPHWatch::covers(const Fix *fix) const { return igroup == 0 || fix->igroup == igroup; }

/* ----------------------------------------------------------------------
   when
------------------------------------------------------------------------- */

// The first restart file is that of the begin.

void FixSPHWatch::setup(int)
{
  check();
  if (file.empty() || !saved.empty()) return;
  remember_file(true);
  output->write_restart(update->ntimestep);
}

// Cloth has its whole momentum from the end of its first step on, see cloth/half_kick_correction.h.

void FixSPHWatch::end_of_step()
{
  if (!begun && balances()) {
    begin = balance();
    scale = {begin.present, begin.flow};
  }
  begun = true;
  const bool writes = update->ntimestep == output->next_restart;
  if (update->ntimestep % interval != 0 && !writes) return;
  check();
  if (writes)
    remember_file(output->restart_flag_double && update->ntimestep == output->next_restart_double);
}

void FixSPHWatch::remember_file(bool one_of_two)
{
  std::string name = !one_of_two    ? output->restart1
      : output->restart_toggle == 0 ? output->restart2a
                                    : output->restart2b;
  if (const auto star = name.find('*'); star != std::string::npos)
    name.replace(star, 1, std::to_string(update->ntimestep));
  saved = fmt::format("{} (step {}, time {:.6g})", name, update->ntimestep, physical_time(update));
}

void FixSPHWatch::check()
{
  look_at_particles();
  if (begun && balances()) look_at_balance();
  checks++;
  for (int k = 0; k < N_LIMITS; k++)
    // not true of what is not a number
    if (const auto limit = static_cast<Limit>(k); is_on(limit) && !(seen[k] <= allowed[k]))
      end_run(limit);
}

/* ----------------------------------------------------------------------
   what
------------------------------------------------------------------------- */

void FixSPHWatch::look_at_particles()
{
  double mine[3] = {0.0, 0.0, 0.0};
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    if (is_on(FINITE) && wrong(i)) mine[FINITE] = 1.0;
    if (is_on(DENSITY)) mine[DENSITY] = std::max(mine[DENSITY], deviation(i));
    if (is_on(SPEED)) mine[SPEED] = std::max(mine[SPEED], speed(i));
  }
  MPI_Allreduce(mine, seen.data(), 3, MPI_DOUBLE, MPI_MAX, world);
}

// in bits

int FixSPHWatch::wrong(int i) const
{
  const auto infinite = [](const double *a) {
    return !std::isfinite(0.0 * a[0] + 0.0 * a[1] + 0.0 * a[2]);
  };
  return (infinite(atom->x[i]) ? POSITION : 0) | (infinite(atom->v[i]) ? VELOCITY : 0) |
      (infinite(atom->f[i]) ? FORCE : 0) |
      (atom->rho_flag && !std::isfinite(atom->rho[i]) ? RHO : 0);
}

double FixSPHWatch::speed(int i) const
{
  const double *v = atom->v[i];
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

// A sum over neighbors is small at a surface: only compression counts.

double FixSPHWatch::deviation(int i) const
{
  if (!fluid->is_fluid(atom->type[i])) return 0.0;
  const double relative = atom->rho[i] / fluid->equation_of_state(atom->type[i]).rho0 - 1.0;
  return fluid->integrates_density() ? std::fabs(relative) : relative;
}

void FixSPHWatch::look_at_balance()
{
  const Balance now = balance();
  scale.mass = std::max(scale.mass, now.present);
  scale.flow = std::max(scale.flow, now.flow);
  const auto share = [](double value, double of) { return value > 0.0 ? value / of : value; };
  seen[MASS] = share(std::fabs(now.mass - begin.mass), scale.mass);
  seen[MOMENTUM] = share((now.momentum - begin.momentum).norm(), scale.flow);
  seen[ENERGY] = now.energy - begin.energy;
}

FixSPHWatch::Balance FixSPHWatch::balance() const
{
  enum { MASS_OF_ALL, FLOW, KINETIC, STORED, VECTOR, N = VECTOR + 3 };
  double mine[N] = {}, all[N];
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double mass = atom_mass(atom, i), v = speed(i);
    mine[MASS_OF_ALL] += mass;
    mine[FLOW] += mass * v;
    mine[KINETIC] += 0.5 * mass * v * v;
    if (is_on(ENERGY) && fluid && fluid->is_fluid(atom->type[i]))
      mine[STORED] +=
          mass * fluid->stored_energy(fluid->equation_of_state(atom->type[i]), atom->rho[i]);
    for (int d = 0; d < 3; d++) mine[VECTOR + d] += mass * atom->v[i][d];
  }
  MPI_Allreduce(mine, all, N, MPI_DOUBLE, MPI_SUM, world);

  Balance b;
  b.mass = b.present = all[MASS_OF_ALL];
  b.flow = all[FLOW];
  b.energy = force->mvv2e * (all[KINETIC] + all[STORED]);
  b.momentum = {all[VECTOR], all[VECTOR + 1], all[VECTOR + 2]};
  take_off_exchanged(b);
  return b;
}

// What came in, what left, what another speed of sound has given, and what cloths have been given
// ahead of time.  What leaves takes energy along, which is not counted: energy may fall.

void FixSPHWatch::take_off_exchanged(Balance &b) const
{
  for (const FixSPHEmit *source : sources) {
    const FixSPHEmit::Poured &in = source->poured();
    b.mass -= in.mass;
    b.momentum -= Eigen::Vector3d(in.momentum);
    b.energy -= force->mvv2e * in.energy;
  }
  for (FixSPHDrain *sink : sinks) {
    b.mass += sink->compute_vector(0);
    for (int d = 0; d < 3; d++) b.momentum[d] += sink->compute_vector(1 + d);
  }
  for (FixSPHIntegrate *integrator : integrators)
    if (is_on(ENERGY)) b.energy -= integrator->compute_vector(StepReport::SOUND_WORK);
  for (FixPBDCloth *cloth : cloths) {
    for (int d = 0; is_on(MOMENTUM) && d < 3; d++) b.momentum[d] -= cloth->compute_vector(7 + d);
    if (is_on(ENERGY)) b.energy += cloth->compute_vector(6);
  }
}

/* ----------------------------------------------------------------------
   the end
------------------------------------------------------------------------- */

void FixSPHWatch::end_run(Limit limit)
{
  std::string blame;
  for (const Suspect &suspect : suspects(limit))
    blame += (blame.empty() ? "; look at " : ", ") + describe(suspect, limit);
  error->all(FLERR, "{}: {} in step {}, time {:.10g}{}; {}", label, breach(limit),
             update->ntimestep, physical_time(update), blame,
             saved.empty() ? "no restart file was written before: 'restart FILE' keeps one"
                           : "the last state within the limits is in " + saved);
}

std::string FixSPHWatch::breach(Limit limit) const
{
  const char *what = "";
  switch (limit) {
    case FINITE:
      return fmt::format("atoms of group {} are not finite, allowed is none", group->names[igroup]);
    case DENSITY: what = "density: the relative deviation"; break;
    case SPEED: what = "speed: the largest"; break;
    case MASS: what = "mass: the relative change"; break;
    case MOMENTUM: what = "momentum: the relative change"; break;
    case ENERGY: what = "energy: the growth"; break;
    case N_LIMITS: break;
  }
  return fmt::format("{} is {:.6g}, allowed is {:.6g}", what, seen[limit], allowed[limit]);
}

// the worst of all ranks, the worst first; of a sum the fastest

std::vector<FixSPHWatch::Suspect> FixSPHWatch::suspects(Limit limit) const
{
  std::vector<Suspect> mine;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double value = limit == FINITE ? wrong(i) : limit == DENSITY ? deviation(i) : speed(i);
    const double *x = atom->x[i];
    if (value > (limit == FINITE ? 0.0 : allowed[limit]) || limit > SPEED || std::isnan(value))
      mine.push_back({value, atom->tag[i], {x[0], x[1], x[2]}});
  }
  keep_worst(mine);
  std::vector<Suspect> all = allgather(mine, comm->nprocs, world);
  keep_worst(all);
  return all;
}

void FixSPHWatch::keep_worst(std::vector<Suspect> &list)
{
  const auto badness = [](const Suspect &s) {
    return std::isnan(s.value) ? std::numeric_limits<double>::infinity() : s.value;
  };
  std::sort(list.begin(), list.end(), [&](const Suspect &a, const Suspect &b) {
    return badness(a) != badness(b) ? badness(a) > badness(b) : a.tag < b.tag;
  });
  if (list.size() > MAX_SUSPECTS) list.resize(MAX_SUSPECTS);
}

std::string FixSPHWatch::describe(const Suspect &s, Limit limit) const
{
  const std::string atom_at =
      fmt::format("atom {} at ({:.6g}, {:.6g}, {:.6g})", s.tag, s.x[0], s.x[1], s.x[2]);
  if (limit == DENSITY) return fmt::format("{} with {:.6g}", atom_at, s.value);
  if (limit != FINITE) return fmt::format("{} of speed {:.6g}", atom_at, s.value);
  std::string names;
  const int bits = static_cast<int>(s.value);
  for (const auto &[bit, name] :
       {std::pair{POSITION, "x"}, {VELOCITY, "v"}, {FORCE, "f"}, {RHO, "rho"}})
    if (bits & bit) names += (names.empty() ? "" : " ") + std::string(name);
  return fmt::format("{} in {}", atom_at, names);
}

/* ----------------------------------------------------------------------
   restart: the balance of the begin and its scales
------------------------------------------------------------------------- */

struct FixSPHWatch::Record {
  double checks, begun, mass, energy, momentum[3], largest_mass, largest_flow;
};

void FixSPHWatch::write_restart(FILE *fp)
{
  if (comm->me) return;
  const Record record{checks,
                      begun ? 1.0 : 0.0,
                      begin.mass,
                      begin.energy,
                      {begin.momentum[0], begin.momentum[1], begin.momentum[2]},
                      scale.mass,
                      scale.flow};
  write_record(fp, record);
}

void FixSPHWatch::restart(char *buf)
{
  const auto record = read_record<Record>(buf, label, error);
  checks = record.checks;
  begun = record.begun != 0.0;
  begin.mass = record.mass;
  begin.energy = record.energy;
  begin.momentum = Eigen::Vector3d(record.momentum);
  scale.mass = record.largest_mass;
  scale.flow = record.largest_flow;
}
