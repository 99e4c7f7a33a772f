// SPDX-License-Identifier: GPL-2.0-or-later
// What the parts of block steps share.

#include "stepping/block_state.h"

#include "atom.h"
#include "comm.h"
#include "core/util/bytes.h"
#include "fluid/fluid_state.h"
#include "lammps_util/atom_tools.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

using Columns = BlockColumns;

BlockState::BlockState(LAMMPS *lmp_, Fix *fix_, const BlockOptions &options_) :
    Pointers(lmp_), fix(fix_), options(options_), fluid(nullptr), coarsest(0), stage(BINS),
    inactive_known(false)
{
}

void BlockState::init(FluidState *style)
{
  fluid = style;
  inactive_known = false;
}

double BlockState::half_step(int i) const
{
  return 0.5 * static_cast<double>(TimeBins::ticks(columns.bin(i)));
}

/* ----------------------------------------------------------------------
   one particle
------------------------------------------------------------------------- */

void BlockState::add_particle(int i)
{
  columns[Columns::BIN][i] = clock.deepest;
  columns[Columns::BIN_BEFORE][i] = StepKey::FIRST;
  columns[Columns::EVENT][i] = Columns::NEW;
  columns[Columns::SLOW_SINCE][i] = physical_time(update);
  if (clock.chosen) begin_own_step(i);
}

// Its impulses reach to the middle of the step that begins; before its first step, to its begin
// less a half, as if steps of the same length came before.

void BlockState::begin_own_step(int i)
{
  const double now = static_cast<double>(clock.line.now), half = half_step(i);
  const bool is_new = columns[Columns::EVENT][i] == Columns::NEW;
  const double ahead = is_new ? -half : columns[Columns::REACH][i] - now;
  columns[Columns::AHEAD][i] = ahead;
  columns[Columns::TAKEN_BACK][i] = columns[Columns::P_OVER_RHO2][i] * std::max(0.0, ahead);
  columns[Columns::REACH][i] = now + half;
  columns[Columns::EVENT][i] = Columns::NONE;
}

/* ----------------------------------------------------------------------
   arrays by atom
------------------------------------------------------------------------- */

void BlockState::make_room()
{
  const std::size_t n = atom->nmax;
  for (std::vector<int> *list : {&bin, &key, &mark}) list->resize(n, 0);
  for (std::vector<double> *list : {&span, &impulse}) list->resize(n, 0.0);
  kicks.resize(3 * n, 0.0);
  if (neighbor->ago == 0) inactive_known = false;
}

void BlockState::refresh_inactive()
{
  if (inactive_known) return;
  inactive_known = true;
  boundaries.clear();
  impelled.clear();
  for (int i = 0; i < atom->nlocal; i++) {
    mark[i] = NOT_MARKED;
    if (fluid->is_fluid(atom->type[i]))
      bin[i] = columns.bin(i);
    else
      boundaries.push_back(i);
    set_inactive(i);
  }
}

void BlockState::select_impelled()
{
  refresh_inactive();
  for (const int i : impelled) set_inactive(i);
  for (const int i : boundaries) set_inactive(i);
  impelled = fluid->active_particles();
}

// An inactive particle has no impulse, but the pressure of a boundary, or of a sleeping particle,
// acts as long as its partner's.

void BlockState::set_inactive(int i)
{
  const bool is_fluid = fluid->is_fluid(atom->type[i]), asleep = is_fluid && is_asleep(i);
  span[i] = asleep ? -1.0 : 0.0;
  impulse[i] = is_fluid && !asleep ? 0.0 : fluid->p_over_rho2_of_all()[i];
  key[i] = asleep ? StepKey::of(0, StepKey::SLEEPING)
      : is_fluid  ? StepKey::of(columns.bin(i), StepKey::INACTIVE)
                  : StepKey::BOUNDARY;
}

void BlockState::mark_atom(int i, int how)
{
  if (mark[i] == NOT_MARKED && i < atom->nlocal) marked.push_back(i);
  mark[i] |= how;
}

void BlockState::clear_ghost_marks()
{
  std::fill_n(mark.begin() + atom->nlocal, atom->nghost, NOT_MARKED);
}

double BlockState::bytes() const
{
  return columns.bytes() + bytes_of(bin, key, mark, marked, boundaries, impelled) +
      bytes_of(span, impulse, kicks);
}

/* ----------------------------------------------------------------------
   ghosts
------------------------------------------------------------------------- */

void BlockState::forward_bins()
{
  stage = BINS;
  comm->forward_comm(fix, 1);
}

void BlockState::forward_impulses()
{
  stage = IMPULSES;
  comm->forward_comm(fix, 3);
}

void BlockState::forward_kicks()
{
  stage = KICKS;
  comm->forward_comm(fix, 3);
}

void BlockState::reverse_marks() { comm->reverse_comm(fix, 1); }

int BlockState::pack_forward(int n, const int *list, double *buf) const
{
  int m = 0;
  for (int k = 0; k < n; k++) {
    const int i = list[k];
    switch (stage) {
      case BINS: buf[m++] = bin[i]; break;
      case IMPULSES:
        buf[m++] = key[i];
        buf[m++] = span[i];
        buf[m++] = impulse[i];
        break;
      case KICKS:
        for (int d = 0; d < 3; d++) buf[m++] = kicks[3 * i + d];
    }
  }
  return m;
}

void BlockState::unpack_forward(int n, int first, const double *buf)
{
  for (int i = first; i < first + n; i++) switch (stage) {
      case BINS: bin[i] = static_cast<int>(*buf++); break;
      case IMPULSES:
        key[i] = static_cast<int>(*buf++);
        span[i] = *buf++;
        impulse[i] = *buf++;
        break;
      case KICKS:    // kept, since a ghost may be the source of another
        for (int d = 0; d < 3; d++) atom->v[i][d] += kicks[3 * i + d] = *buf++;
    }
}

int BlockState::pack_reverse(int n, int first, double *buf) const
{
  for (int k = 0; k < n; k++) buf[k] = mark[first + k];
  return n;
}

void BlockState::unpack_reverse(int n, const int *list, const double *buf)
{
  for (int k = 0; k < n; k++)
    if (const int how = static_cast<int>(buf[k]); how != NOT_MARKED) mark_atom(list[k], how);
}
