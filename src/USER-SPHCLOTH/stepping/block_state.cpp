// SPDX-License-Identifier: GPL-2.0-or-later
// What the parts of block steps share.

#include "stepping/block_state.h"

#include "atom.h"
#include "comm.h"
#include "core/neighbor/dual_lists.h"
#include "core/util/bytes.h"
#include "fluid/fluid_state.h"
#include "lammps_util/atom_tools.h"
#include "modify.h"
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
  held.begin_run(modify);
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
  columns[Columns::EVENT][i] = Columns::NEW;
  columns[Columns::SLOW_SINCE][i] = physical_time(update);
  forget_frequencies(i);
  if (clock.chosen) begin_own_step(i);
}

// Its impulses reach to the middle of the step that begins; before its first step, to its begin
// less a half, as if steps of the same length came before.

double BlockState::ahead(int i) const
{
  if (is_new(i)) return -half_step(i);
  return columns[Columns::REACH][i] - static_cast<double>(clock.line.now);
}

void BlockState::forget_frequencies(int i)
{
  columns[Columns::INTERVAL][i] = columns[Columns::WAIT][i] = 0.0;
}

void BlockState::begin_own_step(int i)
{
  const double reaches = ahead(i);
  columns[Columns::AHEAD][i] = reaches;
  columns[Columns::TAKEN_BACK][i] = columns[Columns::P_OVER_RHO2][i] * std::max(0.0, reaches);
  columns[Columns::REACH][i] = static_cast<double>(clock.line.now) + half_step(i);
  columns[Columns::EVENT][i] = Columns::NONE;
}

/* ----------------------------------------------------------------------
   arrays by atom
------------------------------------------------------------------------- */

void BlockState::make_room()
{
  const std::size_t n = atom->nmax;
  for (std::vector<int> *list : {&bin, &mark}) list->resize(n, 0);
  for (std::vector<double> *list : {&span, &impulse}) list->resize(n, 0.0);
  given.resize(Impulses::STRIDE * n, 0.0);
  kicks.resize(3 * n, 0.0);
  ranges_known = false;
  if (neighbor->ago == 0) inactive_known = false;
}

void BlockState::refresh_inactive()
{
  if (inactive_known) return;
  inactive_known = true;
  boundaries.clear();
  for (int i = 0; i < atom->nlocal; i++) {
    mark[i] = NOT_MARKED;
    if (fluid->is_fluid(atom->type[i]))
      bin[i] = columns.bin(i);
    else
      boundaries.push_back(i);
  }
}

void BlockState::select_giving()
{
  giving.clear();
  for (const int i : fluid->active_particles())
    if (!was_asleep(i)) giving.push_back(i);
}

void BlockState::begin_giving()
{
  const std::vector<int> *few = fluid->touched_particles();
  all_touched = few == nullptr;
  touched.clear();
  touched_ghosts.clear();
  if (all_touched) return;
  is_touched.resize(atom->nmax, 0);
  for (const int i : *few) touch(i);
}

// Ghosts get impulses from ghosts of theirs.

void BlockState::touch(int i)
{
  if (is_touched[i]) return;
  is_touched[i] = 1;
  (i < atom->nlocal ? touched : touched_ghosts).push_back(i);
}

void BlockState::end_giving()
{
  if (all_touched) {
    const std::size_t n = static_cast<std::size_t>(atom->nlocal) + atom->nghost;
    std::fill_n(given.begin(), Impulses::STRIDE * n, 0.0);
    return;
  }
  for (const std::vector<int> *list : {&touched, &touched_ghosts})
    for (const int i : *list) {
      std::fill_n(&given[Impulses::STRIDE * i], 3, 0.0);
      is_touched[i] = 0;
    }
}

Impulses BlockState::impulses(const std::vector<int> &of, bool with_forces)
{
  return {&of,          impulse.data(), span.data(), any_asleep ? asleep.data() : nullptr,
          given.data(), with_forces};
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
  return columns.bytes() + bytes_of(bin, mark, asleep, marked, boundaries, giving) +
      bytes_of(touched, touched_ghosts, is_touched) + bytes_of(span, impulse, given, kicks);
}

/* ----------------------------------------------------------------------
   ghosts
------------------------------------------------------------------------- */

void BlockState::forward_bins()
{
  stage = BINS;
  comm->forward_comm(fix, 1);
}

void BlockState::measure_ranges()
{
  constexpr std::size_t MANY = 8;    // those of few are not worth a pass over all
  ranges_known = MANY * fluid->active_particles().size() > static_cast<std::size_t>(atom->nlocal);
  if (ranges_known) fluid->order().measure_block_ranges(bin.data());
}

// What the same evaluation has woken before is new since: one that enters begins its step at once
// where steps have been chosen.

void BlockState::find_sleeping()
{
  refresh_inactive();
  for (int i = 0; i < atom->nlocal; i++)
    if (fluid->is_fluid(atom->type[i]))
      bin[i] = clock.chosen && is_new(i) ? Columns::ASLEEP : columns.bin(i);
  forward_bins();
  asleep.resize(atom->nmax);
  any_asleep = false;
  for (int i = 0; i < atom->nlocal + atom->nghost; i++) {
    asleep[i] = bin[i] == Columns::ASLEEP;
    any_asleep |= asleep[i];
  }
}

void BlockState::forward_kicks()
{
  stage = KICKS;
  comm->forward_comm(fix, 3);
}

void BlockState::reverse_given() { comm->reverse_comm(fix, 4); }

int BlockState::pack_forward(int n, const int *list, double *buf) const
{
  int m = 0;
  for (int k = 0; k < n; k++) {
    const int i = list[k];
    switch (stage) {
      case BINS: buf[m++] = bin[i]; break;
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
      case KICKS:    // kept, since a ghost may be the source of another
        for (int d = 0; d < 3; d++) atom->v[i][d] += kicks[3 * i + d] = *buf++;
    }
}

int BlockState::pack_reverse(int n, int first, double *buf) const
{
  int m = 0;
  for (int i = first; i < first + n; i++) {
    buf[m++] = mark[i];
    for (int d = 0; d < 3; d++) buf[m++] = given_to(i)[d];
  }
  return m;
}

void BlockState::unpack_reverse(int n, const int *list, const double *buf)
{
  for (int k = 0; k < n; k++) {
    const int i = list[k];
    if (const int how = static_cast<int>(*buf++); how != NOT_MARKED) mark_atom(i, how);
    const bool none = buf[0] == 0.0 && buf[1] == 0.0 && buf[2] == 0.0;
    if (!none && !all_touched) touch(i);
    for (int d = 0; d < 3; d++) given[Impulses::STRIDE * i + d] += *buf++;
  }
}
