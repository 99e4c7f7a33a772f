// Power-of-two steps of individual particles, see block_steps.h.

#include "block_steps.h"

#include "atom.h"
#include "atom_tools.h"
#include "comm.h"
#include "fix_sph_integrate.h"
#include "pair_sph_tait.h"
#include "update.h"

#include <algorithm>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

// what a step of the scene costs beside its updates, in updates per particle: drift, ghosts, cloth
static constexpr double OVERHEAD = 0.05;

BlockSteps::BlockSteps(LAMMPS *lmp, FixSPHIntegrate *fix, double **&rows) :
    Pointers(lmp), fix(fix), pair(nullptr), rows(rows), apart(1), stage(LEVELS)
{
}

void BlockSteps::init(PairSPHTait *style)
{
  pair = style;
  pair->set_blocks(this);
  apart = options.ratio == 4 ? 2 : 1;
}

void BlockSteps::make_room()
{
  const std::size_t n = atom->nmax;
  for (std::vector<int> *list : {&level, &mark}) list->resize(n, 0);
  for (std::vector<double> *list : {&span, &impulse, &wanted}) list->resize(n, 0.0);
  for (std::vector<double> *list : {&from_particles, &handed}) list->resize(3 * n, 0.0);
}

// It takes part in the shortest step until it chooses its own.

void BlockSteps::set_new(double *row) const
{
  row[LEVEL] = at.deepest;
  row[CALL] = NEW;
  if (at.chosen) begin_own_step(row);
}

/* ----------------------------------------------------------------------
   time
------------------------------------------------------------------------- */

void BlockSteps::begin_step()
{
  at.line.now += TimeLine::ticks(at.deepest);
  at.chosen = false;
}

bool BlockSteps::is_due(int i) const
{
  return rows[i][CALL] != NONE || at.line.begins(static_cast<int>(rows[i][LEVEL]));
}

bool BlockSteps::ends_root() const
{
  return at.line.now + TimeLine::ticks(at.deepest) == TimeLine::ticks(0);
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
  want_steps();
  if (!begun() || at.line.ended()) begin_root();
  choose_levels();
  find_step_of_scene();
  if (!at.alike) respect_neighbours();
  book();
  at.chosen = true;
}

void BlockSteps::want_steps()
{
  const double *approach = fix->wants_approach() ? pair->approach_speeds().data() : nullptr;
  for (const int i : pair->active_particles()) {
    const double before = at.line.step(static_cast<int>(rows[i][LEVEL]));
    const StepLimit own =
        fix->bounded_limit(i, &rows[i][EXTERNAL], approach ? approach[i] : 0.0, before);
    wanted[i] = own.dt;
    rows[i][BY] = static_cast<double>(own.by);
  }
}

// Everybody begins a step: it may be of any length.

void BlockSteps::begin_root()
{
  double least = fix->tightest_vertex().dt, least_of_all;
  for (const int i : pair->active_particles()) least = std::min(least, wanted[i]);
  MPI_Allreduce(&least, &least_of_all, 1, MPI_DOUBLE, MPI_MIN, world);
  least_of_all = std::min(least_of_all, fix->longest_step());
  WantedSteps mine, all;
  for (const int i : pair->active_particles()) mine.add(wanted[i], least_of_all);
  MPI_Allreduce(mine.count.data(), all.count.data(), WantedSteps::N, MPI_INT, MPI_SUM, world);

  fit_root(all.best_root(least_of_all, OVERHEAD), least_of_all);
}

// It ends at an output time, or before it where a shorter one fits.

void BlockSteps::fit_root(double best, double least)
{
  const double output = fix->next_output_time(least), remaining = output - physical_time(update);
  while (best > remaining && best > least) best *= 0.5;
  const double root = best <= least ? step_towards(remaining, best) : best;
  for (const int i : pair->active_particles())
    rows[i][UNTIL] = (rows[i][UNTIL] - TimeLine::ticks(0)) * at.line.root / root;
  at.line = {root, 0};
  at.reaches_output = root == remaining;
  at.output_time = output;
}

void BlockSteps::choose_levels()
{
  const int coarsest = at.line.coarsest();
  for (const int i : pair->active_particles())
    rows[i][LEVEL] = std::max(coarsest, at.line.level_of(wanted[i]));
}

// and whether it is the step of everybody

void BlockSteps::find_step_of_scene()
{
  constexpr int LIMITS = 64;
  constexpr double FAR = std::numeric_limits<double>::max();
  static_assert(N_LIMITS < LIMITS);
  const int coarsest = at.line.coarsest();
  const StepLimit vertices = fix->tightest_vertex();
  int finest =
      LIMITS * std::max(coarsest, at.line.level_of(vertices.dt)) + static_cast<int>(vertices.by);
  int slowest = TimeLine::DEEPEST;
  double until[2] = {-FAR, -FAR};    // -least, most
  for (const int i : pair->active_particles()) {
    const int own = static_cast<int>(rows[i][LEVEL]);
    slowest = std::min(slowest, own);
    finest = std::max(finest, LIMITS * own + static_cast<int>(rows[i][BY]));
    until[0] = std::max(until[0], -rows[i][UNTIL]);
    until[1] = std::max(until[1], rows[i][UNTIL]);
  }
  const double mine[4] = {static_cast<double>(finest), -static_cast<double>(slowest), until[0],
                          until[1]};
  double all[4];
  MPI_Allreduce(mine, all, 4, MPI_DOUBLE, MPI_MAX, world);
  at.deepest = static_cast<int>(all[0]) / LIMITS;
  at.limit = static_cast<Limit>(static_cast<int>(all[0]) % LIMITS);
  at.alike = at.line.now == 0 && -all[1] >= at.deepest && all[3] == -all[2];
  // none of a new particle reaches anywhere yet
  at.span_of_all = all[3] == 0.0 ? 1.0
                                 : 0.5 - all[3] / static_cast<double>(TimeLine::ticks(at.deepest));
}

// Nobody's step is longer than `ratio` times a neighbour's, or than that of a vertex that it wets.

void BlockSteps::respect_neighbours()
{
  for (int i = 0; i < atom->nlocal; i++)
    level[i] = pair->is_fluid(atom->type[i]) ? static_cast<int>(rows[i][LEVEL]) : vertex_level(i);
  stage = LEVELS;
  comm->forward_comm(fix, 1);
  for (const int i : pair->active_particles())
    rows[i][LEVEL] = std::min(at.deepest, std::max(level[i], level_beside(i)));
}

// of a vertex of cloth, as for a neighbour whose step may be `ratio` times as long; a wall has none

int BlockSteps::vertex_level(int i) const
{
  const double dt = fix->vertex_step(i);
  return dt > 0.0 ? at.line.level_of(dt) + apart : 0;
}

int BlockSteps::level_beside(int i)
{
  int finest = 0;
  for_neighbours(i, [&](int j) { finest = std::max(finest, level[j]); });
  return finest - apart;
}

void BlockSteps::book()
{
  const double *term = pair->pressure_term();
  for (const int i : pair->active_particles()) {
    begin_own_step(rows[i]);
    rows[i][TERM] = term[i];
    fix->set_own_step(i, at.line.step(static_cast<int>(rows[i][LEVEL])));
  }
}

// Its impulses reach to the middle of the step that begins; before its first step, to its begin less
// a half, as if steps of the same length came before.

void BlockSteps::begin_own_step(double *row) const
{
  const double now = static_cast<double>(at.line.now), half = half_step(row);
  row[AHEAD] = row[CALL] == NEW ? -half : row[UNTIL] - now;
  row[TAKEN_BACK] = row[TERM] * std::max(0.0, row[AHEAD]);
  row[UNTIL] = now + half;
  row[CALL] = NONE;
}

double BlockSteps::half_step(const double *row)
{
  return 0.5 * static_cast<double>(TimeLine::ticks(static_cast<int>(row[LEVEL])));
}

/* ----------------------------------------------------------------------
   forces become impulses
------------------------------------------------------------------------- */

void BlockSteps::note_forces()
{
  make_room();
  for (const int i : pair->active_particles())
    std::copy(atom->f[i], atom->f[i] + 3, &from_particles[3 * i]);
}

void BlockSteps::hand_out()
{
  if (!at.chosen) choose();
  measure_impulses();
  if (at.alike)
    share_equally();
  else
    share_impulses();
  for (const int i : pair->active_particles())
    std::copy(atom->f[i], atom->f[i] + 3, &handed[3 * i]);
}

void BlockSteps::note_external_forces()
{
  for (const int i : pair->active_particles())
    for (int d = 0; d < 3; d++) rows[i][EXTERNAL + d] = atom->f[i][d] - handed[3 * i + d];
}

// Whose neighbours all take its step, and took the same before, has the force itself for all of its
// time.  For others it is summed anew, pair by pair.

void BlockSteps::share_impulses()
{
  stage = IMPULSES;
  comm->forward_comm(fix, 3);
  std::fill_n(mark.begin(), atom->nlocal + atom->nghost, UNTOUCHED);
  marked.clear();
  slots.clear();
  for (const int i : pair->active_particles()) {
    if (look_around(i)) {
      prolong(i, span[i] - 1.0);
      continue;
    }
    prolong(i, -1.0);
    slots.push_back(pair->order().slot(i));
  }
  comm->reverse_comm(fix, 1);
  wake_marked();
  pair->give_impulses(slots, impulse.data(), span.data());
}

// Nobody has a neighbour with another step.

void BlockSteps::share_equally()
{
  pair->push_boundaries();
  if (at.span_of_all != 1.0)
    for (int i = 0; i < atom->nlocal; i++)
      if (!pair->is_fluid(atom->type[i]))
        for (int d = 0; d < 3; d++) atom->f[i][d] *= at.span_of_all;
  for (const int i : pair->active_particles()) prolong(i, span[i] - 1.0);
}

// the force of other particles, `times` more of it, and what walls do beside it

void BlockSteps::prolong(int i, double times)
{
  if (times != 0.0)
    for (int d = 0; d < 3; d++) atom->f[i][d] += times * from_particles[3 * i + d];
  const double term = pair->pressure_term()[i];
  if (span[i] != 1.0 || impulse[i] != term)
    pair->push_walls_more(i, impulse[i] - term, span[i] - 1.0);
}

// For how long does the energy of each act?  What an impulse before gave too much is taken back, but
// friction does not run backwards.

void BlockSteps::measure_impulses()
{
  const double scene = static_cast<double>(TimeLine::ticks(at.deepest));
  const double *term = pair->pressure_term();
  for (int i = 0; i < atom->nlocal; i++) {
    const bool fluid = pair->is_fluid(atom->type[i]);
    span[i] = 0.0;
    impulse[i] = fluid ? 0.0 : term[i];    // a boundary's pressure acts as long as its fluid's
    level[i] = fluid ? static_cast<int>(rows[i][LEVEL]) : 0;
  }
  for (const int i : pair->active_particles()) {
    const double half = half_step(rows[i]), ahead = rows[i][AHEAD];
    span[i] = std::max(0.0, half - ahead) / scene;
    impulse[i] = ahead > 0.0 ? (half * term[i] - rows[i][TAKEN_BACK]) / scene : span[i] * term[i];
  }
}

template <class Do> void BlockSteps::for_neighbours(int i, Do something)
{
  for (int t = 1; t <= atom->ntypes; t++) {
    const Stretch near = pair->neighbours(i, t);
    for (int k = 0; k < near.n; k++) something(near.of[k]);
  }
}

// Do it and its neighbours begin the same step?  Those who begin none are told that they feel one.

bool BlockSteps::look_around(int i)
{
  const double *term = pair->pressure_term();
  bool in_step = impulse[i] == span[i] * term[i];
  for_neighbours(i, [&](int j) {
    if (!pair->is_fluid(atom->type[j])) return touch(j, TOUCHED);
    if (span[j] == span[i] && impulse[j] == span[j] * term[j]) return;
    in_step = false;
    if (span[j] != 0.0 || impulse[j] != 0.0) return;
    touch(j, options.waking && level[i] - level[j] > apart ? TOUCHED | WAKE : TOUCHED);
  });
  return in_step;
}

void BlockSteps::touch(int j, int mark_of_it)
{
  if (mark[j] == UNTOUCHED && j < atom->nlocal) marked.push_back(j);
  mark[j] |= mark_of_it;
}

void BlockSteps::wake_marked()
{
  for (const int i : marked) {
    slots.push_back(pair->order().slot(i));
    if (mark[i] & WAKE) rows[i][WOKEN] = 1.0;
  }
}

/* ----------------------------------------------------------------------
   ghosts
------------------------------------------------------------------------- */

int BlockSteps::pack_forward(int n, const int *list, double *buf) const
{
  int m = 0;
  for (int k = 0; k < n; k++) {
    buf[m++] = level[list[k]];
    if (stage == LEVELS) continue;
    buf[m++] = span[list[k]];
    buf[m++] = impulse[list[k]];
  }
  return m;
}

void BlockSteps::unpack_forward(int n, int first, const double *buf)
{
  for (int i = first; i < first + n; i++) {
    level[i] = static_cast<int>(*buf++);
    if (stage == LEVELS) continue;
    span[i] = *buf++;
    impulse[i] = *buf++;
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

double BlockSteps::bytes() const
{
  return static_cast<double>(sizeof(int)) *
      static_cast<double>(level.capacity() + mark.capacity() + marked.capacity() +
                          slots.capacity()) +
      static_cast<double>(sizeof(double)) *
      static_cast<double>(span.capacity() + impulse.capacity() + wanted.capacity() +
                          from_particles.capacity() + handed.capacity());
}
