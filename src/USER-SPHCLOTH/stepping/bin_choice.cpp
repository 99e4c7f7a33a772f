// SPDX-License-Identifier: GPL-2.0-or-later
// The time bin of each particle.

#include "stepping/bin_choice.h"

#include "core/neighbor/dual_lists.h"
#include "core/util/bytes.h"
#include "fluid/fluid_state.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/rank_error.h"
#include "stepping/step_report.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

using Columns = BlockColumns;

// what a smallest step costs beside its updates, in updates per particle: drift, ghosts
static constexpr double STEP_OVERHEAD = 0.1;
// and what projection and contact of a vertex cost in it
static constexpr int UPDATES_PER_VERTEX = 2;
// To go from uniform to unequal steps and back costs some steps: unequal steps go on until they
// gain less than this share of what is asked for.
static constexpr double GAIN_TO_GO_ON = 0.8;

BinChoice::BinChoice(LAMMPS *lmp_, const SteppingParts &parts_, BlockState &state_) :
    Pointers(lmp_), parts(parts_), state(state_), fluid(nullptr), max_difference(1),
    finest_vertex(0)
{
}

void BinChoice::init(FluidState *style)
{
  fluid = style;
  vertices.n = -1;
  max_difference = parts.options.block.max_bin_difference();
  const int n = atom->ntypes + 1;
  max_difference_of.assign(n * n, max_difference);
  for (int t = 1; t < n; t++)
    for (int u = 1; u < n; u++) max_difference_of[t * n + u] = find_max_difference(t, u);
}

// By how many bins may a particle's step be longer than that of a neighbor of another type?  The
// impulse of a coarse particle's whole step acts at once, and a fine particle tolerates that for no
// longer than about twice its own acoustic step: while pressures balance, it oscillates by p/(2 rho
// H) times the square of that time.

int BinChoice::find_max_difference(int type, int neighbor_type) const
{
  if (!fluid->is_fluid(type) || !fluid->is_fluid(neighbor_type)) return max_difference;
  const double octaves =
      std::round(std::log2(fluid->support(type) / fluid->support(neighbor_type)));
  return octaves > 0.0 ? std::clamp(2 - static_cast<int>(octaves), 0, max_difference)
                       : max_difference;
}

void BinChoice::choose()
{
  wanted.resize(atom->nmax, 0.0);
  BlockClock &clock = state.clock;
  if (!clock.begun()) limit_vertices();
  if (!clock.begun() || clock.line.ended())
    begin_base_step();
  else {
    want_steps(fluid->active_particles(), true);
    find_bins();
  }
  if (!clock.uniform) limit_differences();
  begin_steps();
}

/* ----------------------------------------------------------------------
   limits
------------------------------------------------------------------------- */

// Returns the tightest.  Particles in free flight have to ask neighbors under pressure where these
// may take shorter steps.

StepLimit BinChoice::want_steps(const std::vector<int> &of, bool ask_neighbors)
{
  const double *its_bin = state.columns[Columns::BIN];
  double *by = state.columns[Columns::BY];
  const double *external[3];
  for (int d = 0; d < 3; d++) external[d] = state.columns.external_force(d);
  ParticleLimits::Rates rates{external};
  if (state.clock.begun() && !state.clock.uniform)
    rates = {nullptr, state.columns[Columns::ACCEL_SQ], state.columns[Columns::DENSITY_RATE]};
  for (const int i : of) wanted[i] = state.clock.line.step(static_cast<int>(its_bin[i]));

  const StepControl &control = parts.control;
  const double controlled = state.clock.controlled;
  StepLimit tightest;
  parts.limits.ask_neighbors(ask_neighbors);
  parts.limits.for_particles(of, rates, [&](int i, const StepLimit &limit) {
    // what this fix does not move limits no step, as where all take the same
    const bool moves = atom->mask[i] & parts.fix->groupbit;
    StepLimit allowed = moves ? limit : StepLimit{parts.options.ceiling, Limit::CEILING};
    if (controlled > 0.0) allowed.tighten(controlled, Limit::FLUCTUATION);
    const StepLimit step = control.bounded(allowed, wanted[i]);
    if (control.is_too_short(step))
      rank_error(lmp, FLERR, control.too_short(allowed, atom->tag[i]));
    wanted[i] = step.dt;
    by[i] = static_cast<double>(step.by);
    tightest.tighten(step.dt, step.by);
  });
  return tightest;
}

void BinChoice::limit_vertices()
{
  const StepControl &control = parts.control;
  parts.limits.for_vertices([&](int i, const StepLimit &limit) {
    if (control.is_too_short(control.bounded(limit, 0.0)))
      rank_error(lmp, FLERR, control.too_short(limit, atom->tag[i]));
    parts.rows[i][UpdateRows::OWN_STEP] = std::max(limit.dt, parts.options.floor());
    state.columns[Columns::BY][i] = static_cast<double>(limit.by);
  });
  vertices.n = -1;
}

const BinChoice::Vertices &BinChoice::find_vertices()
{
  if (vertices.n >= 0) return vertices;
  vertices = {0, {parts.options.ceiling, Limit::CEILING}};
  parts.limits.for_moving_vertices([&](int i, const LimitedVertices &) {
    vertices.n++;
    const double dt = parts.rows[i][UpdateRows::OWN_STEP];
    if (dt > 0.0) vertices.tightest.tighten(dt, limit_of(state.columns[Columns::BY][i]));
  });
  return vertices;
}

/* ----------------------------------------------------------------------
   the base step
------------------------------------------------------------------------- */

// All particles are synchronized: choose a new base step, ending on the next output time if one is
// near.  While a uniform step continues, time bins do not change, and all impulses reach equally
// far; new particles join it.

void BinChoice::begin_base_step()
{
  BlockClock &clock = state.clock;
  const std::vector<int> &active = fluid->active_particles();
  control_step();
  StepLimit tightest = want_steps(active, false);
  BaseStep base = find_base_step(tightest);
  if (!base.uniform) {
    in_flight.clear();
    for (const int i : active)
      if (fluid->is_in_flight(i)) in_flight.push_back(i);
    const StepLimit among_neighbors = want_steps(in_flight, true);
    tightest.tighten(among_neighbors.dt, among_neighbors.by);
    base = find_base_step(tightest);
  }
  if (clock.controlled > 0.0) clock.longest = longest_wanted();
  const bool continues = clock.begun() && clock.uniform && clock.deepest == 0 && base.uniform;
  const double end = static_cast<double>(TimeBins::ticks(0));
  const double ratio = clock.line.base / base.length;
  double *reach = state.columns[Columns::REACH];
  if (continues)
    clock.uniform_span = 0.5 - (0.5 * end - end) * ratio / end;
  else
    for (const int i : active) reach[i] = (reach[i] - end) * ratio;
  clock.line = {base.length, 0};
  state.coarsest = 0;
  clock.reaches_output = base.length == base.remaining;
  clock.output_time = base.output_time;
  if (!continues) find_bins();
  if (base.uniform) clock.limit = base.by;
}

void BinChoice::control_step()
{
  BlockClock &clock = state.clock;
  clock.controlled = 0.0;
  if (!parts.control.controls()) return;
  clock.controlled = parts.control.controlled_step(clock.longest, clock.largest_compression);
  clock.largest_compression = parts.control.compression_found();
}

// Where other limits are tighter the controller goes on from them.  0: there is no fluid

double BinChoice::longest_wanted() const
{
  double mine = 0.0, all;
  for (const int i : fluid->active_particles()) mine = std::max(mine, wanted[i]);
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all;
}

BinChoice::BaseStep BinChoice::find_base_step(StepLimit tightest)
{
  const Vertices &cloth = find_vertices();
  tightest.tighten(cloth.tightest.dt, cloth.tightest.by);
  tightest = parts.control.tightest_of_ranks(tightest);
  const double shortest = std::min(tightest.dt, parts.options.ceiling);

  BaseStep base;
  base.by = tightest.by;
  base.output_time = parts.control.times.next(shortest);
  base.remaining = base.output_time - physical_time(update);
  base.uniform = true;
  const double asked = parts.options.block.gain;
  const double gain = state.clock.uniform ? asked : std::max(1.0, GAIN_TO_GO_ON * asked);
  const Sums sums = sum_everywhere(shortest);
  state.clock.some_sleep = sums.at_rest > 0.0;
  const double step = 1.0 + STEP_OVERHEAD;
  if (!(step * sums.equal > gain * (sums.exact + STEP_OVERHEAD * sums.equal))) {
    base.length = step_towards(base.remaining, shortest);
    return base;
  }
  WantedSteps here, anywhere;
  for (const int i : fluid->active_particles()) here.add(wanted[i], shortest);
  here.count[0] += UPDATES_PER_VERTEX * cloth.n;    // which move in every smallest step
  MPI_Allreduce(here.count.data(), anywhere.count.data(), WantedSteps::N, MPI_INT64_T, MPI_SUM,
                world);
  base.length = anywhere.base_step_towards(base.remaining, shortest, STEP_OVERHEAD, gain);
  base.uniform = base.length <= shortest;
  return base;
}

BinChoice::Sums BinChoice::sum_everywhere(double shortest)
{
  const std::vector<int> &active = fluid->active_particles();
  const double of_vertices = UPDATES_PER_VERTEX * find_vertices().n;
  double mine[3] = {of_vertices, of_vertices + static_cast<double>(active.size()),
                    static_cast<double>(state.n_at_rest)};
  sum_of_rates = 0.0;
  for (const int i : active) sum_of_rates += 1.0 / wanted[i];
  mine[0] += shortest * sum_of_rates;
  double all[3];
  MPI_Allreduce(mine, all, 3, MPI_DOUBLE, MPI_SUM, world);
  return {all[0], all[1], all[2]};
}

/* ----------------------------------------------------------------------
   bins
------------------------------------------------------------------------- */

// The bin of each active particle, the smallest step, and whether it is uniform.  Of the limits of
// particles in the finest bin the first in enum Limit is reported, so growth, of a new particle,
// comes after those that others have.

void BinChoice::find_bins()
{
  constexpr int LIMITS = 64;
  const auto rank = [](int bin, int by) { return LIMITS * bin + LIMITS - 1 - by; };
  constexpr double MAX = std::numeric_limits<double>::max();
  static_assert(N_LIMITS < LIMITS);
  BlockClock &clock = state.clock;
  BlockColumns &columns = state.columns;
  const StepLimit vertex = find_vertices().tightest;
  const int of_vertices = std::max(state.coarsest, clock.line.bin_of(vertex.dt));
  int finest = rank(of_vertices, static_cast<int>(vertex.by));
  int slowest = TimeBins::DEEPEST;
  double reach[2] = {-MAX, -MAX};    // -min, max
  const double *by = columns[Columns::BY];
  const double *its_reach = columns[Columns::REACH];
  double *its_bin = columns[Columns::BIN];
  for (const int i : fluid->active_particles()) {
    const int wanted_bin = std::max(state.coarsest, clock.line.bin_of(wanted[i]));
    its_bin[i] = wanted_bin;
    slowest = std::min(slowest, wanted_bin);
    finest = std::max(finest, rank(wanted_bin, static_cast<int>(by[i])));
    if (state.is_new(i)) continue;    // its impulses reach nowhere yet
    reach[0] = std::max(reach[0], -its_reach[i]);
    reach[1] = std::max(reach[1], its_reach[i]);
  }
  const double mine[5] = {static_cast<double>(finest), -static_cast<double>(slowest), reach[0],
                          reach[1], static_cast<double>(of_vertices)};
  double all[5];
  MPI_Allreduce(mine, all, 5, MPI_DOUBLE, MPI_MAX, world);
  clock.deepest = static_cast<int>(all[0]) / LIMITS;
  clock.limit = static_cast<Limit>(LIMITS - 1 - static_cast<int>(all[0]) % LIMITS);
  finest_vertex = static_cast<int>(all[4]);
  const bool all_new = all[3] == -MAX;
  const bool reach_equally = all_new || all[3] == -all[2];
  clock.uniform = clock.all_synchronized() && -all[1] >= clock.deepest && reach_equally;
  clock.uniform_span = all_new ? 1.0 : 0.5 - all[3] / clock.smallest_ticks();
}

// Time step limiter of Saitoh and Makino: no step is longer than `ratio` times a neighbor's, or
// than that of a vertex that the particle wets; beside a mesh the vertex with the shortest step
// counts for all.  What gets a part of the impulses of vertices moves with them, in every smallest
// step.

void BinChoice::limit_differences()
{
  state.refresh_inactive();
  std::vector<int> &bin = state.bin;
  double *its_bin = state.columns[Columns::BIN];
  const std::vector<int> &active = fluid->active_particles();
  const ScaledMass &scaled = fluid->scaled_mass();
  for (const int i : state.boundaries) bin[i] = vertex_bin(i);
  for (const int i : active) {
    bin[i] = static_cast<int>(its_bin[i]);
    if (fluid->is_beside_mesh(i)) its_bin[i] = bin[i] = std::max(bin[i], finest_vertex);
    if (scaled.on() && scaled.is_beside_vertices(i)) its_bin[i] = bin[i] = state.clock.deepest;
  }
  state.forward_bins();
  state.measure_ranges();
  for (const int i : active)
    if (is_too_coarse(i)) its_bin[i] = std::min(state.clock.deepest, bin_beside(i));
  for (const int i : active) bin[i] = static_cast<int>(its_bin[i]);
}

// for a neighbor?  Particles a little outside the support count as well

bool BinChoice::is_too_coarse(int i) const
{
  DualLists &lists = fluid->order();
  const int slot = lists.slot(i), type_i = atom->type[i];
  for (const int t : lists.present_types()) {
    const int finest = state.clock.deepest + (fluid->is_fluid(t) ? 0 : max_difference);
    const int allowed = state.bin[i] + allowed_difference(type_i, t);
    if (allowed < finest && lists.any_above(allowed, slot, t, state.bin.data(), state.ranges_known))
      return true;
  }
  return false;
}

int BinChoice::bin_beside(int i) const
{
  const std::vector<int> &bin = state.bin;
  int bin_i = bin[i];
  for (int t = 1; t <= atom->ntypes; t++) {
    const int allowed = allowed_difference(atom->type[i], t);
    const NeighborSpan near = fluid->neighbors(i, t);
    for (int k = 0; k < near.n; k++)
      if (const int j = near.of[k]; bin[j] - allowed > bin_i && fluid->inside_support(i, j))
        bin_i = bin[j] - allowed;
  }
  return bin_i;
}

// of a vertex of cloth, raised by the difference that the limiter allows, since no neighbor may
// take a longer step; walls limit no neighbor

int BinChoice::vertex_bin(int i) const
{
  const double dt = parts.rows[i][UpdateRows::OWN_STEP];
  if (fluid->is_fluid(atom->type[i]) || !(dt > 0.0)) return 0;
  return state.clock.line.bin_of(dt) + max_difference;
}

void BinChoice::begin_steps()
{
  if (state.clock.uniform) return begin_equal_steps();
  const double now = physical_time(update);
  BlockColumns &columns = state.columns;
  const double *p_over_rho2 = fluid->p_over_rho2_of_all(), *its_bin = columns[Columns::BIN];
  double *last = columns[Columns::P_OVER_RHO2];
  for (const int i : fluid->active_particles()) {
    state.begin_own_step(i);
    last[i] = p_over_rho2[i];
    const double step = state.clock.line.step(static_cast<int>(its_bin[i]));
    parts.rows[i][UpdateRows::OWN_STEP] = step;
    parts.rows[i][UpdateRows::LAST_UPDATE] = now;
    parts.report.ideal_updates += step / wanted[i];
  }
}

// What they want has been summed where the base step was chosen.

void BinChoice::begin_equal_steps()
{
  const double now = physical_time(update), step = state.clock.smallest_step();
  const double half_of_all = 0.5 * state.clock.smallest_ticks();
  double *reach = state.columns[Columns::REACH], *event = state.columns[Columns::EVENT];
  for (const int i : fluid->active_particles()) {
    if (reach[i] != half_of_all || event[i] != Columns::NONE) {
      reach[i] = half_of_all;
      event[i] = Columns::NONE;
    }
    parts.rows[i][UpdateRows::OWN_STEP] = step;
    parts.rows[i][UpdateRows::LAST_UPDATE] = now;
  }
  parts.report.ideal_updates += step * sum_of_rates;
}

double BinChoice::bytes() const { return bytes_of(wanted, in_flight); }
