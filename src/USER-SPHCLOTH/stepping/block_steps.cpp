// Power-of-two steps of individual particles, see stepping/block_steps.h.

#include "stepping/block_steps.h"

#include "atom.h"
#include "comm.h"
#include "core/util/bytes.h"
#include "fix_sph_integrate.h"
#include "lammps_util/atom_tools.h"
#include "neighbor.h"
#include "pair_sph_tait.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

// what a step of the scene costs beside its updates, in updates per particle: drift, ghosts
static constexpr double OVERHEAD = 0.1;
// and what projection and contact of a vertex cost in it
static constexpr int UPDATES_PER_VERTEX = 2;
// To go from one step for all to unequal ones and back costs some steps: who takes them keeps them until they gain
// less than this share of what is asked for.
static constexpr double KEEPS = 0.8;

BlockSteps::BlockSteps(LAMMPS *lmp_, FixSPHIntegrate *fix_, ParticleColumns &rows_) :
    Pointers(lmp_), fix(fix_), pair(nullptr), rows(rows_), apart(1), coarsest(0), finest_vertex(0),
    ideal(0.0), stage(LEVELS), known(false)
{
}

void BlockSteps::init(PairSPHTait *style)
{
  pair = style;
  pair->set_step_hooks(this);
  known = false;
  apart = options.ratio == 4 ? 2 : 1;
  const int n = atom->ntypes + 1;
  apart_of.assign(n * n, apart);
  for (int t = 1; t < n; t++)
    for (int u = 1; u < n; u++) apart_of[t * n + u] = find_apart(t, u);
}

// How many levels may a particle be above a neighbour of another type?  What a coarse one gives for its
// whole step comes at once, and a fine one bears that no longer than about twice its own acoustic
// step: while pressures balance, it moves to and fro by p/(2 rho H) times the square of that time.

int BlockSteps::find_apart(int type, int neighbor_type) const
{
  if (!pair->is_fluid(type) || !pair->is_fluid(neighbor_type)) return apart;
  const double octaves = std::round(std::log2(pair->support(type) / pair->support(neighbor_type)));
  return octaves > 0.0 ? std::clamp(2 - static_cast<int>(octaves), 0, apart) : apart;
}

void BlockSteps::make_room()
{
  const std::size_t n = atom->nmax;
  for (std::vector<int> *list : {&level, &pace, &mark}) list->resize(n, 0);
  for (std::vector<double> *list : {&span, &impulse, &wanted}) list->resize(n, 0.0);
  for (std::vector<double> *list : {&from_particles, &handed, &kicks}) list->resize(3 * n, 0.0);
  if (neighbor->ago == 0) known = false;
}

// what is kept of those who are not updated, where it is not known any more

void BlockSteps::know_all()
{
  if (known) return;
  known = true;
  boundaries.clear();
  impelled.clear();
  for (int i = 0; i < atom->nlocal; i++) {
    mark[i] = UNTOUCHED;
    if (pair->is_fluid(atom->type[i]))
      level[i] = static_cast<int>(rows[LEVEL][i]);
    else
      boundaries.push_back(i);
    rest(i);
  }
}

// It takes part in the shortest step until it chooses its own.

void BlockSteps::set_new(int i)
{
  rows[LEVEL][i] = at.deepest;
  rows[BEFORE][i] = Pace::FIRST;
  rows[CALL][i] = NEW;
  if (at.chosen) begin_own_step(i);
}

/* ----------------------------------------------------------------------
   time
------------------------------------------------------------------------- */

void BlockSteps::begin_step()
{
  at.line.now += TimeBins::ticks(at.deepest);
  at.chosen = false;
  at.owes = false;
  coarsest = at.line.coarsest();
}

std::pair<int, int> BlockSteps::mark_due(double **of, int column) const
{
  const double *its_level = rows[LEVEL], *call = rows[CALL];
  int n_due = 0, n = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!pair->is_fluid(atom->type[i])) continue;
    const bool due = its_level[i] >= coarsest || call[i] != NONE;
    of[i][column] = due;
    n_due += due;
    n++;
  }
  return {n_due, n - n_due};
}

bool BlockSteps::ends_root() const
{
  return at.line.now + TimeBins::ticks(at.deepest) == TimeBins::ticks(0);
}

// The last one before an output time ends there, whatever was rounded on the way.

double BlockSteps::next_step() const
{
  return arrives() ? at.output_time - physical_time(update) : at.line.step(at.deepest);
}

/* ----------------------------------------------------------------------
   the step of each
------------------------------------------------------------------------- */

void BlockSteps::choose()
{
  if (!begun()) fix->limit_vertices();
  if (!begun() || at.line.ended())
    begin_root();
  else {
    want_steps(pair->active_particles(), true);
    find_step_of_scene();
  }
  if (!at.alike) respect_neighbors();
  book();
  if (options.sleep > 0.0) fall_asleep();
  at.chosen = true;
}

// The tightest of them.  Who flies freely looks for neighbours under pressure, unless their steps will be its
// own.

StepLimit BlockSteps::want_steps(const std::vector<int> &of, bool looks_around)
{
  const double *its_level = rows[LEVEL];
  const double *external[3] = {rows[EXTERNAL], rows[EXTERNAL + 1], rows[EXTERNAL + 2]};
  for (const int i : of) wanted[i] = at.line.step(static_cast<int>(its_level[i]));
  return fix->find_steps(of, external, looks_around, wanted.data(), rows[BY]);
}

// Everybody begins a step: it may be of any length, but roots end at output times.  Where one step for all
// goes on nobody's level changes, and all impulses reach equally far; who is new takes part in that.

void BlockSteps::begin_root()
{
  const std::vector<int> &active = pair->active_particles();
  StepLimit tightest = want_steps(active, false);
  Root root = find_root(tightest);
  if (!root.one_for_all) {
    marked.clear();
    for (const int i : active)
      if (pair->p_over_rho2()[i] == 0.0) marked.push_back(i);
    const StepLimit among_neighbors = want_steps(marked, true);
    tightest.tighten(among_neighbors.dt, among_neighbors.by);
    root = find_root(tightest);
  }
  const bool goes_on = begun() && at.alike && at.deepest == 0 && root.one_for_all;
  const double end = static_cast<double>(TimeBins::ticks(0)), ratio = at.line.root / root.step;
  double *until = rows[UNTIL];
  if (goes_on)
    at.span_of_all = 0.5 - (0.5 * end - end) * ratio / end;
  else
    for (const int i : active) until[i] = (until[i] - end) * ratio;
  at.line = {root.step, 0};
  coarsest = 0;
  at.reaches_output = root.step == root.remaining;
  at.output_time = root.output_time;
  if (!goes_on) find_step_of_scene();
  if (root.one_for_all) at.limit = root.by;
}

BlockSteps::Root BlockSteps::find_root(StepLimit tightest) const
{
  const StepLimit &vertex = fix->tightest_vertex();
  tightest.tighten(vertex.dt, vertex.by);
  struct {
    double dt;
    int by;
  } mine = {tightest.dt, static_cast<int>(tightest.by)}, all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE_INT, MPI_MINLOC, world);
  const double least = std::min(all.dt, fix->longest_step());

  Root root;
  root.by = static_cast<Limit>(all.by);
  root.output_time = fix->next_output_time(least);
  root.remaining = root.output_time - physical_time(update);
  root.one_for_all = true;
  const double gain = at.alike ? options.gain : std::max(1.0, KEEPS * options.gain);
  if (!may_gain(least, gain)) {
    root.step = step_towards(root.remaining, least);
    return root;
  }
  WantedSteps here, anywhere;
  for (const int i : pair->active_particles()) here.add(wanted[i], least);
  here.count[0] += UPDATES_PER_VERTEX * fix->count_vertices();    // whatever they want
  MPI_Allreduce(here.count.data(), anywhere.count.data(), WantedSteps::N, MPI_INT, MPI_SUM, world);
  root.step = anywhere.root_towards(root.remaining, least, OVERHEAD, gain);
  root.one_for_all = root.step <= least;
  return root;
}

// Could unequal steps gain enough, if everybody took exactly what it wants?

bool BlockSteps::may_gain(double least, double gain) const
{
  const std::vector<int> &active = pair->active_particles();
  const double of_vertices = UPDATES_PER_VERTEX * fix->count_vertices();
  double exact = of_vertices;    // updates while one step for all has `equal` of them
  for (const int i : active) exact += least / wanted[i];
  const double equal = of_vertices + static_cast<double>(active.size());
  const double mine[2] = {exact, equal};
  double all[2];
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, world);
  return (1.0 + OVERHEAD) * all[1] > gain * (all[0] + OVERHEAD * all[1]);
}

// The step of each, the shortest, and whether it is everybody's.  Who is new, and lengthens its step, asks
// for no step of the scene where others ask for the same: of limits at the shortest step the first in the
// list counts.

void BlockSteps::find_step_of_scene()
{
  constexpr int LIMITS = 64;
  const auto rank = [](int depth, int by) { return LIMITS * depth + LIMITS - 1 - by; };
  constexpr double FAR = std::numeric_limits<double>::max();
  static_assert(N_LIMITS < LIMITS);
  const StepLimit vertex = fix->tightest_vertex();
  const int of_vertices = std::max(coarsest, at.line.level_of(vertex.dt));
  int finest = rank(of_vertices, static_cast<int>(vertex.by));
  int slowest = TimeBins::DEEPEST;
  double until[2] = {-FAR, -FAR};    // -least, most
  const double *by = rows[BY], *call = rows[CALL], *its_until = rows[UNTIL];
  double *its_level = rows[LEVEL], *before = rows[BEFORE];
  for (const int i : pair->active_particles()) {
    before[i] = call[i] == NEW ? Pace::FIRST : call[i] == WOKEN ? Pace::BROKEN : its_level[i];
    const int own = std::max(coarsest, at.line.level_of(wanted[i]));
    its_level[i] = own;
    slowest = std::min(slowest, own);
    finest = std::max(finest, rank(own, static_cast<int>(by[i])));
    until[0] = std::max(until[0], -its_until[i]);
    until[1] = std::max(until[1], its_until[i]);
  }
  const double mine[5] = {static_cast<double>(finest), -static_cast<double>(slowest), until[0],
                          until[1], static_cast<double>(of_vertices)};
  double all[5];
  MPI_Allreduce(mine, all, 5, MPI_DOUBLE, MPI_MAX, world);
  at.deepest = static_cast<int>(all[0]) / LIMITS;
  at.limit = static_cast<Limit>(LIMITS - 1 - static_cast<int>(all[0]) % LIMITS);
  finest_vertex = static_cast<int>(all[4]);
  at.alike = at.line.now == 0 && -all[1] >= at.deepest && all[3] == -all[2] && options.sleep == 0.0;
  // none of a new particle reaches anywhere yet
  at.span_of_all = all[3] == 0.0 ? 1.0
                                 : 0.5 - all[3] / static_cast<double>(TimeBins::ticks(at.deepest));
}

// Nobody's step is longer than `ratio` times a neighbour's, or than that of a vertex that it wets;
// who is beside a mesh takes the vertex with the shortest step for all.

void BlockSteps::respect_neighbors()
{
  know_all();
  for (const int i : boundaries) level[i] = vertex_level(i);
  for (const int i : pair->active_particles()) {
    level[i] = static_cast<int>(rows[LEVEL][i]);
    if (pair->is_beside_mesh(i)) rows[LEVEL][i] = level[i] = std::max(level[i], finest_vertex);
  }
  stage = LEVELS;
  comm->forward_comm(fix, 1);
  if (everyone_begins()) pair->order().measure_block_ranges(level.data());
  for (const int i : pair->active_particles())
    if (is_too_coarse(i)) rows[LEVEL][i] = std::min(at.deepest, level_beside(i));
  for (const int i : pair->active_particles()) level[i] = static_cast<int>(rows[LEVEL][i]);
}

// for a neighbour, or for somebody a little outside the support?

bool BlockSteps::is_too_coarse(int i)
{
  DualLists &lists = pair->order();
  const int slot = lists.slot(i), own = atom->type[i];
  for (int t = 1; t <= atom->ntypes; t++)
    if (lists.any_above(level[i] + levels_apart(own, t), slot, t, level.data(), everyone_begins()))
      return true;
  return false;
}

int BlockSteps::level_beside(int i)
{
  int own = level[i];
  for (int t = 1; t <= atom->ntypes; t++) {
    const int most = levels_apart(atom->type[i], t);
    const NeighborSpan near = pair->neighbors(i, t);
    for (int k = 0; k < near.n; k++)
      if (const int j = near.of[k]; level[j] - most > own && pair->inside_support(i, j))
        own = level[j] - most;
  }
  return own;
}

// of a vertex of cloth, as for a neighbour whose step may be `ratio` times as long; a wall has none

int BlockSteps::vertex_level(int i) const
{
  const double dt = fix->vertex_step(i);
  return dt > 0.0 ? at.line.level_of(dt) + apart : 0;
}

void BlockSteps::book()
{
  const double now = physical_time(update);
  const double *term = pair->p_over_rho2(), *its_level = rows[LEVEL];
  const double half_of_all = 0.5 * static_cast<double>(TimeBins::ticks(at.deepest));
  double *last_term = rows[TERM], *until = rows[UNTIL], *call = rows[CALL];
  for (const int i : pair->active_particles()) {
    if (at.alike) {    // nobody's impulses differ from others'
      until[i] = half_of_all;
      call[i] = NONE;
    } else
      begin_own_step(i);
    last_term[i] = term[i];
    const double own = at.line.step(static_cast<int>(its_level[i]));
    fix->set_own_step(i, own, now);
    ideal += own / wanted[i];
  }
}

// Its impulses reach to the middle of the step that begins; before its first step, to its begin less
// a half, as if steps of the same length came before.

void BlockSteps::begin_own_step(int i)
{
  const double now = static_cast<double>(at.line.now), half = half_step(i);
  const bool is_new = rows[CALL][i] == NEW;
  rows[AHEAD][i] = is_new ? -half : rows[UNTIL][i] - now;
  rows[TAKEN_BACK][i] = rows[TERM][i] * std::max(0.0, rows[AHEAD][i]);
  rows[UNTIL][i] = now + half;
  rows[CALL][i] = NONE;
}

double BlockSteps::half_step(int i) const
{
  return 0.5 * static_cast<double>(TimeBins::ticks(static_cast<int>(rows[LEVEL][i])));
}

/* ----------------------------------------------------------------------
   Sleep: water at rest keeps its place, density and pressure, and is a wall for its neighbours.
------------------------------------------------------------------------- */

// How long it is slow before it sleeps, and sleeps beside water that is awake before it is asked again
// whether it rests: times that sound needs across the support.

static constexpr double PATIENCE = 20.0, NAP = 100.0;

bool BlockSteps::is_slow(int i) const
{
  const double *v = atom->v[i];
  return v[0] * v[0] + v[1] * v[1] + v[2] * v[2] < options.sleep * options.sleep;
}

bool BlockSteps::rests_among_others(int i)
{
  const double now = physical_time(update);
  if (!is_slow(i)) rows[SINCE][i] = now;
  if (now - rows[SINCE][i] < PATIENCE * fix->sound_time(i) || pair->feels_moving_wall(i))
    return false;
  bool others = true;
  for_neighbors(i, [&](int j) { others = others && (is_slow(j) || !pair->inside_support(i, j)); });
  return others;
}

void BlockSteps::fall_asleep()
{
  marked.clear();
  for (const int i : pair->active_particles())
    if (rests_among_others(i)) marked.push_back(i);
  for (const int i : marked) {
    rows[LEVEL][i] = level[i] = ASLEEP;
    rows[SINCE][i] = physical_time(update);
    std::fill_n(atom->v[i], 3, 0.0);
  }
}

// Contact or a command has given it speed, another force acts on it than when it fell asleep, or a
// wall beside it moves.

void BlockSteps::wake_moved()
{
  if (options.sleep == 0.0) return;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!pair->is_fluid(atom->type[i]) || !sleeps(i)) continue;
    double change_sq = 0.0;
    for (int d = 0; d < 3; d++) {
      const double change = atom->f[i][d] - rows[EXTERNAL + d][i];
      change_sq += change * change;
    }
    if (!is_slow(i) || gains_speed(i, change_sq) || pair->feels_moving_wall(i)) wake(i);
  }
}

// from a force, squared, for as long as water has to be slow before it sleeps

bool BlockSteps::gains_speed(int i, double force_sq) const
{
  if (force_sq == 0.0) return false;
  const double accel = fix->acceleration(i, std::sqrt(force_sq));
  return PATIENCE * fix->sound_time(i) * accel > options.sleep;
}

// as a particle that is new

void BlockSteps::wake(int i)
{
  if (sleeps(i)) {
    rows[LEVEL][i] = at.deepest;
    rows[CALL][i] = NEW;
    rows[SINCE][i] = physical_time(update);
  } else
    rows[CALL][i] = WOKEN;
}

void BlockSteps::wake_beside_moving_boundaries()
{
  for (const int i : boundaries)
    if (!is_slow(i))
      for_neighbors(i, [&](int j) {
        if (Pace::before(pace[j]) == Pace::SLEEPER && pair->inside_support(i, j)) touch(j, WAKE);
      });
}

/* ----------------------------------------------------------------------
   output times
------------------------------------------------------------------------- */

bool BlockSteps::correct_velocities()
{
  if (at.chosen || !at.reaches_output || !at.line.ended() || at.alike) return false;
  make_room();
  measure_arrears();
  stage = IMPULSES;
  comm->forward_comm(fix, 3);

  for (int i = 0; i < atom->nlocal; i++) {
    std::copy_n(atom->f[i], 3, from_particles.begin() + 3 * i);
    std::fill_n(atom->f[i], 3, 0.0);
  }
  slots.clear();
  for (const int i : pair->active_particles()) {
    if (span[i] > 0.0) pair->push_walls_more(i, impulse[i], span[i]);
    slots.push_back(pair->order().slot(i));
  }
  for (const int i : boundaries)
    if (pair->is_boundary(atom->type[i])) slots.push_back(pair->order().slot(i));
  pair->give_impulses(slots, impulse.data(), span.data());
  kick();
  for (int i = 0; i < atom->nlocal; i++) std::copy_n(from_particles.begin() + 3 * i, 3, atom->f[i]);

  stage = KICKS;
  comm->forward_comm(fix, 3);
  return true;
}

// How far is the end of its impulses behind that of who takes the shortest steps?

void BlockSteps::measure_arrears()
{
  const double scene = static_cast<double>(TimeBins::ticks(at.deepest));
  const double until = static_cast<double>(at.line.now) - 0.5 * scene;
  impel_active();
  for (const int i : impelled) {
    const bool integrated = atom->mask[i] & fix->groupbit;
    const double behind = integrated && rows[CALL][i] != NEW ? until - rows[UNTIL][i] : 0.0;
    span[i] = std::max(0.0, behind) / scene;
    impulse[i] = span[i] * pair->p_over_rho2()[i];
    if (behind > 0.0) rows[UNTIL][i] = until;
  }
}

// The fluid now, vertices later: the velocity of a light one would only be known with what holds it.

void BlockSteps::kick()
{
  const double scene = at.line.step(at.deepest);
  std::fill_n(kicks.begin(), 3 * atom->nlocal, 0.0);
  for (const int i : pair->active_particles()) {
    if (!(atom->mask[i] & fix->groupbit)) continue;
    for (int d = 0; d < 3; d++) {
      kicks[3 * i + d] = scene * fix->acceleration(i, atom->f[i][d]);
      atom->v[i][d] += kicks[3 * i + d];
    }
  }
  at.owes = true;
  for (const int i : boundaries)
    for (int d = 0; d < 3; d++) rows[OWED + d][i] = scene * atom->f[i][d];
  pair->hand_over_pushes([&](int i, const Eigen::Vector3d &push) {
    for (int d = 0; d < 3; d++) rows[OWED + d][i] += scene * push[d];
  });
}

void BlockSteps::pay()
{
  if (!at.owes) return;
  know_all();
  const double step = at.line.step(at.deepest);
  for (const int i : boundaries)
    for (int d = 0; d < 3; d++) atom->f[i][d] += rows[OWED + d][i] / step;
}

/* ----------------------------------------------------------------------
   forces become impulses
------------------------------------------------------------------------- */

void BlockSteps::note_pair_forces()
{
  make_room();
  keep_forces(from_particles);
}

// on those who are active, at least

void BlockSteps::keep_forces(std::vector<double> &in) const
{
  const std::vector<int> &active = pair->active_particles();
  const std::size_t n = atom->nlocal;
  if (2 * active.size() > n) {
    std::copy_n(atom->f[0], 3 * n, in.begin());
    return;
  }
  for (const int i : active) std::copy_n(atom->f[i], 3, in.begin() + 3 * i);
}

void BlockSteps::apply_impulses()
{
  if (!at.chosen) choose();
  if (at.alike)
    share_equally();
  else
    share_impulses();
  pay();
  if (needs_external()) keep_forces(handed);
}

bool BlockSteps::needs_external() const { return fix->wants_force() || options.sleep > 0.0; }

void BlockSteps::note_external_forces()
{
  if (!needs_external()) return;
  double *external[3] = {rows[EXTERNAL], rows[EXTERNAL + 1], rows[EXTERNAL + 2]};
  for (const int i : pair->active_particles())
    for (int d = 0; d < 3; d++) external[d][i] = atom->f[i][d] - handed[3 * i + d];
}

// Whose neighbours all take its step, and took the same before, has the force itself for all of its
// time.  For others it is summed anew, pair by pair.

void BlockSteps::share_impulses()
{
  measure_impulses();
  stage = IMPULSES;
  comm->forward_comm(fix, 3);
  if (everyone_begins()) pair->order().measure_block_ranges(pace.data());
  std::fill_n(mark.begin() + atom->nlocal, atom->nghost, UNTOUCHED);
  marked.clear();
  slots.clear();
  for (const int i : pair->active_particles()) {
    if (sleeps(i))    // since now
      std::fill_n(atom->f[i], 3, 0.0);
    else if (look_around(i))
      prolong(i, span[i] - 1.0);
    else {
      prolong(i, -1.0);
      slots.push_back(pair->order().slot(i));
    }
  }
  if (options.sleep > 0.0) wake_beside_moving_boundaries();
  comm->reverse_comm(fix, 1);
  wake_marked();
  pair->give_impulses(slots, impulse.data(), span.data());
}

// Everybody takes the same step: forces are impulses, but for a step that differs from the last one.

void BlockSteps::share_equally()
{
  known = false;
  pair->push_boundaries();
  const double times = at.span_of_all;
  if (times == 1.0) return;
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) atom->f[i][d] *= times;
  pair->prolong_walls(times);
}

// the force of other particles, `times` more of it, and what walls do beside it

void BlockSteps::prolong(int i, double times)
{
  if (times != 0.0)
    for (int d = 0; d < 3; d++) atom->f[i][d] += times * from_particles[3 * i + d];
  const double term = pair->p_over_rho2()[i];
  if (span[i] != 1.0 || impulse[i] != term)
    pair->push_walls_more(i, impulse[i] - term, span[i] - 1.0);
}

// For how long does the energy of each act?  What an impulse before gave too much is taken back, but
// friction does not run backwards.

void BlockSteps::measure_impulses()
{
  const double scene = static_cast<double>(TimeBins::ticks(at.deepest));
  const double *term = pair->p_over_rho2();
  impel_active();
  for (const int i : impelled) {
    if (sleeps(i)) {
      rest(i);
      continue;
    }
    const double half = half_step(i), ahead = rows[AHEAD][i];
    span[i] = std::max(0.0, half - ahead) / scene;
    impulse[i] = ahead > 0.0 ? (half * term[i] - rows[TAKEN_BACK][i]) / scene : span[i] * term[i];
    pace[i] = Pace::of(static_cast<int>(rows[LEVEL][i]), static_cast<int>(rows[BEFORE][i]));
  }
}

// They are to be given impulses, and nobody else.

void BlockSteps::impel_active()
{
  know_all();
  for (const int i : impelled) rest(i);
  for (const int i : boundaries) rest(i);
  impelled = pair->active_particles();
}

// Who is not updated has no impulse, but the pressure of a boundary, or of who sleeps, acts as long as
// its partner's.

void BlockSteps::rest(int i)
{
  const bool fluid = pair->is_fluid(atom->type[i]), asleep = fluid && sleeps(i);
  span[i] = asleep ? -1.0 : 0.0;
  impulse[i] = fluid && !asleep ? 0.0 : pair->p_over_rho2()[i];
  pace[i] = asleep ? Pace::of(0, Pace::SLEEPER)
      : fluid      ? Pace::of(static_cast<int>(rows[LEVEL][i]), Pace::INACTIVE)
                   : Pace::BOUNDARY;
}

template <class Do> void BlockSteps::for_neighbors(int i, Do something)
{
  for (int t = 1; t <= atom->ntypes; t++) {
    const NeighborSpan near = pair->neighbors(i, t);
    for (int k = 0; k < near.n; k++) something(near.of[k]);
  }
}

// Do it and its neighbours have impulses for the same time?  Those who have none are told that they
// feel one.

bool BlockSteps::look_around(int i)
{
  DualLists &lists = pair->order();
  const int slot = lists.slot(i), own = pace[i];
  bool in_step = Pace::before(own) != Pace::BROKEN;
  for (int t = 1; t <= atom->ntypes; t++) {
    const NeighborSpan others = lists.others(own, slot, t, pace.data(), everyone_begins());
    if (others.n > 0) in_step = look_at(i, t, others) && in_step;
  }
  return in_step;
}

// at those of one type who have another pace.  Where everybody begins a step nobody waits for an impulse.

bool BlockSteps::look_at(int i, int type, const NeighborSpan &others)
{
  if (everyone_begins() && options.sleep == 0.0 && pair->is_fluid(type)) return false;
  const int own = pace[i];
  bool in_step = true;
  for (int k = 0; k < others.n; k++) {
    const int j = others.of[k];
    if (pace[j] == Pace::BOUNDARY) {
      touch(j, TOUCHED);
      continue;
    }
    if (Pace::before(pace[j]) == Pace::SLEEPER) {
      disturb(i, j);
      continue;
    }
    in_step = false;
    if (Pace::before(pace[j]) != Pace::INACTIVE) continue;
    const bool slow = Pace::level(own) - Pace::level(pace[j]) > apart;
    touch(j, options.waking && slow && pair->inside_support(i, j) ? TOUCHED | WAKE : TOUCHED);
  }
  return in_step;
}

void BlockSteps::disturb(int i, int j)
{
  if (!options.waking || !pair->inside_support(i, j)) return;
  touch(j, is_slow(i) ? TOUCHED : WAKE);
}

void BlockSteps::touch(int j, int mark_of_it)
{
  if (mark[j] == UNTOUCHED && j < atom->nlocal) marked.push_back(j);
  mark[j] |= mark_of_it;
}

void BlockSteps::wake_marked()
{
  const double now = physical_time(update);
  for (const int i : marked) {
    const bool asleep = Pace::before(pace[i]) == Pace::SLEEPER;
    if (!asleep) slots.push_back(pair->order().slot(i));
    const bool napped = asleep && now - rows[SINCE][i] > NAP * fix->sound_time(i);
    if (mark[i] & WAKE || napped) wake(i);
    mark[i] = UNTOUCHED;
  }
}

/* ----------------------------------------------------------------------
   ghosts
------------------------------------------------------------------------- */

int BlockSteps::pack_forward(int n, const int *list, double *buf) const
{
  int m = 0;
  for (int k = 0; k < n; k++) {
    const int i = list[k];
    switch (stage) {
      case LEVELS: buf[m++] = level[i]; break;
      case IMPULSES:
        buf[m++] = pace[i];
        buf[m++] = span[i];
        buf[m++] = impulse[i];
        break;
      case KICKS:
        for (int d = 0; d < 3; d++) buf[m++] = kicks[3 * i + d];
    }
  }
  return m;
}

void BlockSteps::unpack_forward(int n, int first, const double *buf)
{
  for (int i = first; i < first + n; i++) switch (stage) {
      case LEVELS: level[i] = static_cast<int>(*buf++); break;
      case IMPULSES:
        pace[i] = static_cast<int>(*buf++);
        span[i] = *buf++;
        impulse[i] = *buf++;
        break;
      case KICKS:
        for (int d = 0; d < 3; d++) atom->v[i][d] += kicks[3 * i + d] = *buf++;    // may go on
    }
}

int BlockSteps::pack_reverse(int n, int first, double *buf) const
{
  for (int k = 0; k < n; k++) buf[k] = mark[first + k];
  return n;
}

void BlockSteps::unpack_reverse(int n, const int *list, const double *buf)
{
  for (int k = 0; k < n; k++)
    if (const int its = static_cast<int>(buf[k]); its != UNTOUCHED) touch(list[k], its);
}

void BlockSteps::find_intervals(std::vector<double> &of_type) const
{
  if (!begun()) return;
  std::vector<double> updates(of_type.size(), 0.0), particles = updates;
  for (int i = 0; i < atom->nlocal; i++) {
    const int type = atom->type[i];
    if (!pair->is_fluid(type) || sleeps(i)) continue;
    updates[type] += std::ldexp(1.0, static_cast<int>(rows[LEVEL][i]) - at.deepest);
    particles[type] += 1.0;
  }
  for (std::size_t t = 0; t < of_type.size(); t++)
    if (updates[t] > 0.0) of_type[t] = std::max(1.0, particles[t] / updates[t]);
}

int BlockSteps::sleepers() const
{
  int n = 0;
  for (int i = 0; i < atom->nlocal; i++) n += pair->is_fluid(atom->type[i]) && sleeps(i);
  return n;
}

double BlockSteps::bytes() const
{
  return bytes_of(level, pace, mark, marked, slots, boundaries, impelled) +
      bytes_of(span, impulse, wanted, from_particles, handed, kicks);
}
