// SPDX-License-Identifier: GPL-2.0-or-later
// Each chamber is known by a few numbers that all ranks share; what they do to the vertices is in
// cloth/gas_chambers.h.  The pressure of a step is implicit in the volume (core/pbd/gas_law.h): the
// breathing of light cloth on a stiff gas does not limit the step.

#include "fix_cloth_gas.h"

#include "atom.h"
#include "comm.h"
#include "contact/contact_mesh.h"
#include "error.h"
#include "force.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/restart_record.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace sphcloth;

static constexpr int N_COLUMNS = 6;    // of the array
static constexpr double NEVER = std::numeric_limits<double>::infinity();

static std::string in_words(const GasChambers::Vec3 &v)
{
  return fmt::format("{:g} {:g} {:g}", v[0], v[1], v[2]);
}

/* ----------------------------------------------------------------------
   fix ID group cloth/gas pressure p | polytropic n p0 ambient  keyword value ...
------------------------------------------------------------------------- */

FixClothGas::FixClothGas(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} cloth/gas", id)), has_law(false), burst(NEVER),
    chambers(lmp_, label, options)
{
  restart_global = 1;
  scalar_flag = vector_flag = array_flag = 1;
  size_vector = 6;
  size_array_cols = N_COLUMNS;
  global_freq = 1;
  extscalar = 1;
  extvector = extarray = 0;
  energy_global_flag = 1;

  if (atom->molecular != Atom::MOLECULAR || !atom->num_angle)
    error->all(FLERR,
               "{}: atom_style {} has no angles, which are triangles: use atom_style molecular, or "
               "hybrid sph molecular",
               label, atom->atom_style);
  ArgReader args(lmp, label, narg, arg, 3);
  read(args);
  chambers.gather(groupbit, true);
  if (options.toward != GasChambers::Vec3::Zero() && !chambers.any_open())
    args.fail("toward", in_words(options.toward),
              "the mesh is closed, and gas pushes outward: leave it out");
  size_array_rows = chambers.count();
  begin_chambers();
}

void FixClothGas::read(ArgReader &args)
{
  has_law = args.choice("law", {"pressure", "polytropic"});
  if (has_law) {
    law.exponent = args.number("exponent n");
    if (law.exponent < 1.0)
      args.fail("exponent n", fmt::format("{:g}", law.exponent),
                "give 1 for a gas that keeps its temperature, or up to its ratio of heats, 1.4 of "
                "air");
    law.start = args.positive("pressure p0 of the start");
    law.ambient = args.at_least("ambient pressure", 0.0);
  } else
    constant.read(args, "pressure", 0.0);
  options.needs_volume = has_law;
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "inflow") {
      inflow.read(args, keyword, 0.0);
      has_inflow = true;
    } else if (keyword == "valve")
      law.limit = args.positive(keyword);
    else if (keyword == "burst")
      burst = args.positive(keyword);
    else if (keyword == "close")
      options.closes_holes = args.choice(keyword, {"no", "yes"});
    else if (keyword == "toward") {
      for (double &part : options.toward) part = args.number(keyword);
      if (options.toward.norm() == 0.0)
        args.fail(keyword, "0 0 0", "give the direction to which the gas pushes the mesh");
    } else
      args.unknown(keyword, "inflow, valve, burst, close, toward");
  }
  check(args);
}

void FixClothGas::check(ArgReader &args)
{
  const auto refuse = [&](const std::string &keyword, const std::string &value) {
    args.fail(keyword, value,
              "gas at a constant pressure does not follow its volume: leave it out, or use "
              "'polytropic'");
  };
  if (!has_law) {
    if (has_inflow) refuse("inflow", inflow.as_given());
    if (law.limit < NEVER) refuse("valve", fmt::format("{:g}", law.limit));
    if (burst < NEVER) refuse("burst", fmt::format("{:g}", burst));
    if (options.closes_holes)
      args.fail("close", "yes",
                "holes of a mesh at a constant pressure "
                "need no lids: leave it out");
    return;
  }
  if (options.toward != GasChambers::Vec3::Zero())
    args.fail("toward", in_words(options.toward), "polytropic gas pushes outward: leave it out");
  const double first = law.start - law.ambient;
  for (const auto &[name, value] : {std::make_pair("valve", law.limit), {"burst", burst}})
    if (value < first)
      args.fail(name, fmt::format("{:g}", value),
                fmt::format("the gas starts at p0 - ambient = {:g}: give at least that", first));
  if (burst < NEVER && law.limit < NEVER && law.limit < burst)
    args.fail(
        "burst", fmt::format("{:g}", burst),
        fmt::format("the valve keeps the pressure at {:g}: leave one of the two out", law.limit));
}

int FixClothGas::setmask()
{
  return POST_FORCE | MIN_POST_FORCE | POST_NEIGHBOR | MIN_POST_NEIGHBOR | PRE_EXCHANGE |
      MIN_PRE_EXCHANGE | POST_RUN;
}

void FixClothGas::init()
{
  takes_steps = false;
  for (NumberOrVariable *one : {&constant, &inflow}) one->check(lmp, label);
  chambers.gather(groupbit, false);
  chambers.require_ghosts();
  begin_chambers();
  cloths.clear();
  for (const Fix *fix : modify->get_fix_by_style("^pbd/cloth$"))
    cloths.push_back(dynamic_cast<const ContactMesh *>(fix));
}

// Those that are known go on, one also where its IDs are other ones now.

void FixClothGas::begin_chambers()
{
  const auto n = static_cast<std::size_t>(chambers.count());
  if (chambers.count() != size_array_rows)
    error->all(FLERR,
               "{}: the mesh has {} chambers, and had {} when the fix was defined: define it again",
               label, n, size_array_rows);
  states.resize(n);
  for (std::size_t c = 0; c < n; c++) {
    const auto first_id = static_cast<double>(chambers.first_id(static_cast<int>(c)));
    if (states[c].first_id == first_id) continue;
    const GasChambers::Frame &frame = chambers.new_frames()[c];
    if (states[c].first_id == 0.0)
      states[c].frame = frame;
    else if (n > 1)
      error->all(FLERR,
                 "{}: atoms have other IDs than in the last run, and the {} chambers cannot be "
                 "told apart: use 'reset_atoms id' before the fix is defined",
                 label, n);
    else if (has_law || !chambers.any_open())
      states[c].frame.side = frame.side;    // IDs decide it where half of the triangles are turned
    states[c].first_id = first_id;
  }
}

void FixClothGas::post_neighbor()
{
  chambers.collect([this](int i) { return inverse_mass(i); });
}

double FixClothGas::inverse_mass(int i) const
{
  for (const ContactMesh *cloth : cloths)
    if (cloth->has_vertex(i)) return cloth->inverse_mass(i);
  return 1.0 / atom_mass(atom, i);
}

/* ----------------------------------------------------------------------
   forces
------------------------------------------------------------------------- */

void FixClothGas::evaluate(Phase phase)
{
  takes_steps = takes_steps || phase == Phase::STEP;
  NumberOrVariable::evaluate(lmp, label, igroup, {&constant, &inflow});
  std::vector<GasChambers::Frame> frames;
  for (const Chamber &chamber : states) frames.push_back(chamber.frame);
  const auto volumes = chambers.measure(frames);
  std::vector<double> push;
  for (std::size_t c = 0; c < states.size(); c++) {
    follow(states[c], volumes[c], phase);
    push.push_back(states[c].applied / force->nktv2p);
  }
  chambers.push(push);
}

void FixClothGas::follow(Chamber &chamber, const GasChambers::Volume &now, Phase phase)
{
  check_volume(chamber, now.value);
  const bool begins = chamber.started == 0.0;
  if (begins) begin(chamber, now);
  const bool moved = phase == Phase::AGAIN && has_been_moved(chamber, now);
  if (begins || moved || phase == Phase::MINIMIZE)
    begin_steps(chamber, now);
  else if (phase == Phase::STEP) {
    chamber.earlier = chamber.before;
    chamber.before = chamber.volume;
    chamber.dt_before = chamber.dt;
    chamber.dt = update->dt;
    chamber.applied_before = chamber.applied;
    chamber.excess_before = chamber.excess;
  }
  chamber.volume = now.value;
  let_flow(chamber, phase);
  chamber.applied = phase == Phase::MINIMIZE ? chamber.excess
                                             : excess_of_step(chamber, now.mobility);
}

void FixClothGas::check_volume(const Chamber &chamber, double volume) const
{
  if (std::isfinite(volume) && (!has_law || volume > 0.0)) return;
  error->all(FLERR,
             "{}: the chamber of atom {:.0f} has a volume of {:g} in step {}: the mesh has "
             "collapsed, turned inside out or flown apart; give the gas more pressure, or take a "
             "smaller time step",
             label, chamber.first_id, volume, update->ntimestep);
}

void FixClothGas::begin(Chamber &chamber, const GasChambers::Volume &now) const
{
  chamber.started = 1.0;
  chamber.gas = now.value;
  chamber.excess = has_law ? law.start - law.ambient : constant.value();
}

// Other fixes may change velocities behind the forces.

void FixClothGas::record_rates()
{
  if (!takes_steps) return;
  const std::vector<double> rates = chambers.rates();
  for (std::size_t c = 0; c < states.size(); c++) states[c].rate = rates[c];
}

void FixClothGas::post_run()
{
  record_rates();
  takes_steps = false;
}

// Or have walls got other velocities between two runs?  Volumes of before say nothing of these.

bool FixClothGas::has_been_moved(const Chamber &chamber, const GasChambers::Volume &now) const
{
  constexpr double ROUNDING = 1e-9;
  const double by = std::max(std::fabs(now.value - chamber.volume),
                             chamber.dt * std::fabs(now.rate - chamber.rate));
  return by > ROUNDING * std::fabs(chamber.volume);
}

// as if no gas had pushed before

void FixClothGas::begin_steps(Chamber &chamber, const GasChambers::Volume &now) const
{
  chamber.dt = chamber.dt_before = update->dt;
  chamber.before = now.value - chamber.dt * now.rate;
  chamber.earlier = chamber.before - chamber.dt * now.rate;
  chamber.rate = now.rate;
  chamber.applied_before = 0.0;
  chamber.excess_before = chamber.excess;
  if (has_law && chamber.before > 0.0)
    chamber.excess_before = law.excess(chamber.gas, chamber.before);
}

// what comes in and goes out

void FixClothGas::let_flow(Chamber &chamber, Phase phase)
{
  const double by_volume = chamber.volume / force->nktv2p;
  if (!has_law) {
    chamber.received -= (constant.value() - chamber.excess) * by_volume;
    chamber.excess = constant.value();
    chamber.energy = -constant.value() * by_volume;
    return;
  }
  if (chamber.flow == BURST) return;
  if (phase == Phase::STEP && has_inflow)
    set_gas(chamber, chamber.gas + inflow.value() * update->dt);
  const double closed = law.pressure(chamber.gas, chamber.volume) - law.ambient;
  chamber.flow = closed > law.limit ? VENTING : CLOSED;
  if (chamber.flow == VENTING) set_gas(chamber, law.gas_at(law.limit, chamber.volume));
  chamber.excess = law.excess(chamber.gas, chamber.volume);
  chamber.energy = law.energy(chamber.gas, chamber.volume) / force->nktv2p;
  if (closed > burst) {
    chamber.flow = BURST;
    chamber.received -= chamber.energy;
    chamber.excess = chamber.energy = 0.0;
    chamber.gas = law.gas_at(0.0, chamber.volume);
  }
}

void FixClothGas::set_gas(Chamber &chamber, double gas) const
{
  if (!(gas > 0.0))
    error->all(FLERR,
               "{}: no gas is left in the chamber of atom {:.0f} in step {}: stop the "
               "outflow before",
               label, chamber.first_id, update->ntimestep);
  chamber.received +=
      (law.energy(gas, chamber.volume) - law.energy(chamber.gas, chamber.volume)) / force->nktv2p;
  chamber.gas = gas;
}

// The walls go on as in the last step, but for what the pressure changes; the next step is as long
// as the last one.

double FixClothGas::excess_of_step(const Chamber &chamber, double mobility) const
{
  if (!has_law || chamber.flow == BURST) return chamber.excess;
  const double rate = (chamber.volume - chamber.before) / chamber.dt;
  const double earlier = (chamber.before - chamber.earlier) / chamber.dt_before;
  ChamberMotion motion;
  motion.volume = chamber.volume;
  motion.excess_before = chamber.excess_before;
  motion.expected = chamber.volume + chamber.dt * (2.0 * rate - earlier);
  motion.last_excess = chamber.applied_before;
  motion.volume_by_excess = chamber.dt * chamber.dt * mobility * force->ftm2v / force->nktv2p;
  if (has_inflow) motion.inflow = inflow.value() * chamber.dt;
  return implicit_excess(law, chamber.gas, motion);
}

/* ----------------------------------------------------------------------
   output
------------------------------------------------------------------------- */

double FixClothGas::compute_scalar()
{
  double sum = 0.0;
  for (const Chamber &chamber : states) sum += chamber.energy;
  return sum;
}

// largest excess, volume, gas, energy received, chambers, those with an open valve or burst

double FixClothGas::compute_vector(int n)
{
  double largest = states.front().excess, volume = 0.0, gas = 0.0, received = 0.0, open = 0.0;
  for (const Chamber &chamber : states) {
    largest = std::max(largest, chamber.excess);
    volume += chamber.volume;
    gas += chamber.gas;
    received += chamber.received;
    open += chamber.flow != CLOSED ? 1.0 : 0.0;
  }
  const double all[] = {largest, volume, gas, received, static_cast<double>(states.size()), open};
  return all[n];
}

double FixClothGas::compute_array(int chamber, int column)
{
  const Chamber &c = states[chamber];
  const double all[N_COLUMNS] = {c.excess, c.volume, c.gas, c.received, c.energy, c.flow};
  return all[column];
}

/* ----------------------------------------------------------------------
   restart
------------------------------------------------------------------------- */

void FixClothGas::write_restart(FILE *fp)
{
  record_rates();
  if (comm->me == 0) write_records(fp, states);
}

void FixClothGas::restart(char *buf)
{
  states = read_records<Chamber>(buf, states.size(), label, error);
  keep_restored_time(update);
}
