// SPDX-License-Identifier: GPL-2.0-or-later
// Dual neighbor lists: outer lists that hold for many steps, and at the front of each its inner
// list, the neighbors that interact now.
//
// An outer list holds about twice as many particles as are inside the support.  Pruning moves those
// within the support and a small inner skin to its front, and the loops run over this inner list
// until particles may have approached each other by the inner skin.  The inner skin follows from
// the motion: each particle that it adds costs a little at every evaluation, and each evaluation
// that it lasts saves one pruning.  (Pall et al., J. Chem. Phys. 153 (2020) 134110.)  Measured in
// docs/evidence/speed.md, "Where the time goes": 183 ns per particle and step become 154.
//
// Each block of space has for each pair of types a displacement bound: how much nearer the
// particles may have come there since lists were built (core/neighbor/approach_bounds.h).  An inner
// list is valid up to a value of it, so particles that are evaluated seldom, rest, or move with
// those around them keep theirs while lists elsewhere are pruned.  The outer lists hold until the
// bound exceeds their skin.
//
// Nothing is kept from one build to the next, so a run that is continued from a restart file goes
// on with the same inner lists.  Every rank decides for itself.  Lists are pruned when they are
// read, from the positions at which the bounds were updated last, so particles that are not
// evaluated cost nothing.

#ifndef SPHCLOTH_CORE_NEIGHBOR_DUAL_LISTS_H
#define SPHCLOTH_CORE_NEIGHBOR_DUAL_LISTS_H

#include "core/neighbor/approach_bounds.h"
#include "core/neighbor/block_minmax.h"
#include "core/neighbor/cell_lists.h"

namespace sphcloth {

// The dimension, and what is known of the motion: velocities of all particles, [n_all][3], or null;
// the time from one evaluation to the next, about; and of each type, [n_types+1], the mean number
// of evaluations from one in which a particle is active to the next.

struct Motion {
  int dimension = 3;
  const double *v = nullptr;
  double step = 0.0;
  std::vector<double> interval;
};

class DualLists {
 public:
  // support: [(n_types+1)^2], up to where two types interact, 0: never.  No list needs a wider skin
  // than max_skin: lists are built again before particles have approached by more.
  void build(const Points &all, const double *support_of_all, double max_skin,
             const Motion &motion)
  {
    give_back(reference);    // its memory for what the lists are made of
    find_present(all);
    const Points p = by_present_type(all);
    types = p.n_types;
    dim = motion.dimension;
    interval.assign(types + 1, 0.0);
    std::vector<double> support((types + 1) * (types + 1), 0.0);
    for (int t = 1; t <= types; t++) {
      if (!motion.interval.empty()) interval[t] = motion.interval[present[t - 1]];
      for (int other = 1; other <= types; other++)
        support[pair(t, other)] =
            support_of_all[present[t - 1] * (all.n_types + 1) + present[other - 1]];
    }
    set_limits(support.data(), max_skin);
    set_blocks(p, max_skin, motion);
    const std::vector<double> near = inner_reach();
    outer.build(p, cutoff.data(), {near.data(), blocks.of_particle()}, n_inner);
    inner_until.resize(n_inner.size());
    slot_of.resize(p.n_owned);
    block.resize(outer.slots());
    for (int slot = 0; slot < outer.slots(); slot++) {
      slot_of[outer.at(slot)] = slot;
      block[slot] = blocks.of_particle()[outer.at(slot)];
    }
    current.assign(outer.slots(), 1);
    evaluation = 1;
    set_reference(p);
    longest_list = 0;
    note_lists([](int, int, int) { return true; });
    give_back(present_type);
  }

  // Types that have particles here, ascending: lists of others are empty.
  const std::vector<int> &present_types() const { return present; }

  // Once per evaluation but for the one for which lists are new, before they are read.  The
  // particles are those for which lists were built, where they are now.
  void follow(const Points &p)
  {
    if (outer.slots() == 0) return;
    begin_evaluation();
    steps++;
    displacements.measure(p.x, center, reference.data());
    bool inner_hold = true, outer_hold = true;
    for_each_bound([&](Bound &bound, int b, int t, int other) {
      const double nearer = displacements.between(b, t, other);
      bound.approach = bound.at_reference + (nearer > 0.0 ? nearer + 2.0 * rounding : 0.0);
      inner_hold = inner_hold && bound.approach <= bound.at_reference + bound.skin;
      outer_hold = outer_hold && bound.approach <= bound.outer_until;
    });
    if (inner_hold && outer_hold) return;
    for_each_bound([&](Bound &bound, int, int t, int other) {
      bound.skin = lasting_skin(t, other, (bound.approach - bound.at_reference) / steps);
      bound.at_reference = bound.approach;
    });
    set_reference(p);
    if (outer_hold) return;
    renew(by_present_type(p));
    give_back(present_type);
  }

  // makes all inner lists of one particle valid
  void refresh(int slot)
  {
    if (current[slot] == evaluation) return;
    current[slot] = static_cast<std::uint8_t>(evaluation);
    const int t = type_of(slot);
    const Bound *of_block = &at(block[slot], t, 1);
    for (int other = 1; other <= types; other++)
      if (of_block[other - 1].approach > inner_until[of(slot, other)]) prune(slot, t, other);
  }

  // Of a value of each particle: is that of a neighbor of one type above a limit, or below one?
  // Ranges of the value may be measured for whole blocks of space before; `ranges_known` says that
  // those are of this value.
  void measure_block_ranges(const int *value) { ranges.take(value); }
  bool any_above(int limit_of_value, int slot, int other, const int *value, bool ranges_known)
  {
    const int column = number[other];
    if (column == 0) return false;
    if (ranges_known && ranges.greatest(block[slot], column) <= limit_of_value) return false;
    refresh(slot);
    return greatest((*this)(slot, other), value) > limit_of_value;
  }
  bool any_below(int limit_of_value, int slot, int other, const int *value, bool ranges_known)
  {
    const int column = number[other];
    if (column == 0) return false;
    if (ranges_known && ranges.smallest(block[slot], column) >= limit_of_value) return false;
    refresh(slot);
    return smallest((*this)(slot, other), value) < limit_of_value;
  }

  // owned particles by type and in space, see CellLists
  int begin(int t) const { return outer.begin(n_before[t] + 1); }
  int slots() const { return outer.slots(); }
  int at(int slot) const { return outer.at(slot); }
  // all neighbors inside the support and some a little outside, as of the last refresh
  NeighborSpan operator()(int slot, int t) const
  {
    const int column = number[t];
    if (column == 0) return {nullptr, 0};
    return {outer(slot, column).of, n_inner[of(slot, column)]};
  }
  // The same for output, which must leave the order of lists, and so of sums, as it is: one that
  // does not hold is not pruned, but read as a whole.
  NeighborSpan without_pruning(int slot, int t) const
  {
    const int column = number[t];
    if (column == 0) return {nullptr, 0};
    const bool holds =
        at(block[slot], type_of(slot), column).approach <= inner_until[of(slot, column)];
    return holds ? (*this)(slot, t) : outer(slot, column);
  }
  int slot(int owned) const { return slot_of[owned]; }
  // of the inner list of one particle, if it were pruned now
  double inner_skin(int slot, int t) const
  {
    return number[t] == 0 ? 0.0 : at(block[slot], type_of(slot), number[t]).skin;
  }
  // list, of one particle and type
  int longest() const { return longest_list; }

  double bytes() const
  {
    return outer.bytes() + blocks.bytes() + displacements.bytes() + ranges.bytes() +
        bytes_of(present, number, n_before, reference, inner_until, n_inner, slot_of, block,
                 current, pair_bounds, due, due_block);
  }

 private:
  // of particles of a type in a block, in the lists of another type
  struct Bound {
    double approach = 0.0;    // maximum since lists were built: now
    double at_reference = 0.0;    // and at the reference positions
    double skin = 0.0;    // inner skin of lists that are pruned from these
    double outer_until = 0.0;    // the outer lists hold up to this approach
  };

  // cost of an entry of an outer list when it is pruned over that of an inner list in an
  // evaluation, about (measured)
  static constexpr double ENTRY_COST = 0.23;
  // Skin of the lists over support: narrow lists are quick to read, wide ones last.  Between 0.2
  // and 0.4 all cost the same (measured).
  static constexpr double LIST_SKIN = 0.3;
  // minimum inner skin over support while nothing is known of the motion
  static constexpr double FIRST_SKIN = 0.02;

  // Inside, types are numbered by those that are present: a type without particles costs nothing.
  std::vector<int> present;    // types, ascending
  std::vector<int> number;    // of a type among them, from 1; 0: it has no particles
  std::vector<int> n_before;    // of a type: how many of those present are below it
  std::vector<int> present_type;    // of each particle, while lists are made

  CellLists outer;
  int types = 0;
  std::vector<int> n_inner, slot_of;    // [slot][type], [owned particle]
  std::vector<double> inner_until;    // [slot][type], approach up to which inner lists hold
  std::vector<std::uint8_t> current;    // [slot], the evaluation in which it was refreshed
  std::vector<int> block;    // [slot]
  std::vector<Bound> pair_bounds;    // [block][type][type]
  std::vector<char> due, due_block;    // of these, and of blocks: lists that are made anew
  // of a pair of types: support, 0: never; cutoff of the outer lists; their skin, and how much of
  // it may be used up; cost of pruning
  std::vector<double> limit, cutoff, widest, lasting, cost;
  std::vector<double> interval;    // of a type
  Blocks blocks;
  ApproachBounds displacements{blocks};
  BlockMinMax ranges{blocks};
  AlignedVector<ApproachBounds::Position> reference;    // positions from which lists are pruned
  std::array<double, 3> center{};
  AlignedVector<float> key;
  std::vector<int> spare;

  int dim = 3;
  int longest_list = 0;
  int evaluation = 0;    // 1 to 255
  int steps = 0;    // evaluations since the reference positions
  double rounding = 0.0;    // of a distance in single precision

  std::size_t of(int slot, int t) const { return static_cast<std::size_t>(slot) * types + t - 1; }
  int pair(int t, int other) const { return t * (types + 1) + other; }
  Bound &at(int b, int t, int other)
  {
    return pair_bounds[(b * types + t - 1) * types + other - 1];
  }
  const Bound &at(int b, int t, int other) const
  {
    return pair_bounds[(b * types + t - 1) * types + other - 1];
  }
  template <class Do> void for_each_bound(Do something)
  {
    for (int b = 0; b < blocks.count(); b++)
      for (int t = 1; t <= types; t++) {
        if (blocks.in(blocks.row(b, t)).empty()) continue;
        for (int other = 1; other <= types; other++)
          if (limit[pair(t, other)] > 0.0) something(at(b, t, other), b, t, other);
      }
  }

  void find_present(const Points &p)
  {
    number.assign(p.n_types + 1, 0);
    for (int i = 0; i < p.n_all; i++) number[p.type[i]] = 1;
    present.clear();
    n_before.assign(p.n_types + 2, 0);
    for (int t = 1; t <= p.n_types; t++) {
      if (number[t] != 0) {
        present.push_back(t);
        number[t] = static_cast<int>(present.size());
      }
      n_before[t + 1] = static_cast<int>(present.size());
    }
  }

  Points by_present_type(const Points &p)
  {
    Points q = p;
    q.n_types = static_cast<int>(present.size());
    if (q.n_types == p.n_types) return q;
    present_type.resize(p.n_all);
    for (int i = 0; i < p.n_all; i++) present_type[i] = number[p.type[i]];
    q.type = present_type.data();
    return q;
  }

  void set_limits(const double *support, double max_skin)
  {
    const int n = (types + 1) * (types + 1);
    limit.assign(support, support + n);
    for (std::vector<double> *of_pair : {&cutoff, &widest, &lasting, &cost})
      of_pair->assign(n, 0.0);
    for (int k = 0; k < n; k++) {
      if (limit[k] == 0.0) continue;
      widest[k] = std::min(max_skin, LIST_SKIN * limit[k]);
      lasting[k] = widest[k] < max_skin ? widest[k] : std::numeric_limits<double>::max();
      cutoff[k] = limit[k] + widest[k];
      cost[k] = ENTRY_COST * std::pow(cutoff[k] / limit[k], dim);
    }
  }

  // Blocks stay as they are while lists are renewed: particles that may interact until lists are
  // built again must be in blocks beside each other now.
  void set_blocks(const Points &p, double max_skin, const Motion &motion)
  {
    constexpr double ROUNDING = 1e-6;
    const double longest = *std::max_element(limit.begin(), limit.end()) + max_skin;
    blocks.divide(p, longest * (1.0 + ROUNDING));
    pair_bounds.assign(static_cast<std::size_t>(blocks.count()) * types * types, Bound());
    if (motion.v) displacements.measure(motion.v, {0.0, 0.0, 0.0}, nullptr);
    for_each_bound([&](Bound &bound, int b, int t, int other) {
      const double displacement = motion.v ? displacements.between(b, t, other) * motion.step : 0.0;
      const int k = pair(t, other);
      bound.skin = std::min(widest[k],
                            std::max(FIRST_SKIN * limit[k], lasting_skin(t, other, displacement)));
      bound.outer_until = lasting[k];
    });
  }

  // the outer lists of those blocks where a neighbor may be missing
  void renew(const Points &p)
  {
    const std::vector<double> near = inner_reach();
    due.assign(pair_bounds.size(), false);
    due_block.assign(blocks.count(), false);
    for_each_bound([&](Bound &bound, int b, int t, int other) {
      if (bound.at_reference <= bound.outer_until) return;
      bound.outer_until = bound.at_reference + lasting[pair(t, other)];
      due[&bound - pair_bounds.data()] = due_block[b] = true;
    });
    const auto is_due = [this](int slot, int t, int other) {
      return due_block[block[slot]] && due[&at(block[slot], t, other) - pair_bounds.data()];
    };
    outer.renew(p, cutoff.data(), {near.data(), blocks.of_particle()}, n_inner, is_due);
    note_lists(is_due);
  }

  // cutoff of the inner lists: [block][(n_types+1)^2]
  std::vector<double> inner_reach()
  {
    std::vector<double> near(blocks.count() * limit.size());
    for_each_bound([&](const Bound &bound, int b, int t, int other) {
      near[b * limit.size() + pair(t, other)] = limit[pair(t, other)] + bound.skin;
    });
    return near;
  }

  // after those that are is_new(slot, type, other) were made
  template <class New> void note_lists(New is_new)
  {
    for (int slot = 0, t = 1; slot < outer.slots(); slot++) {
      while (slot >= outer.begin(t + 1)) t++;
      for (int other = 1; other <= types; other++) {
        if (!is_new(slot, t, other)) continue;
        longest_list = std::max(longest_list, outer(slot, other).n);
        const Bound &bound = at(block[slot], t, other);
        inner_until[of(slot, other)] = bound.at_reference + bound.skin;
      }
    }
    key.resize(whole_groups(longest_list) + 2 * LANES);
    spare.resize(key.size());
  }

  // For n evaluations of one particle a skin that is used up in the meantime, with a margin: the
  // inner list then holds 1 + dim skin/H as many, and pruning costs cost/(n + 1) per evaluation.
  // The n of minimum cost.
  double lasting_skin(int t, int other, double displacement) const
  {
    const int k = pair(t, other);
    const double nearer = displacement * interval[t];
    if (!(nearer > 0.0)) return std::min(widest[k], FIRST_SKIN * limit[k]);
    const double n = std::sqrt(cost[k] * limit[k] / (dim * nearer)) - 0.5;
    return std::min(widest[k], 1.1 * nearer * std::floor(std::clamp(n, 0.0, 1000.0)));
  }

  void begin_evaluation()
  {
    if (++evaluation <= std::numeric_limits<std::uint8_t>::max()) return;
    std::fill(current.begin(), current.end(), 0);
    evaluation = 1;
  }

  void set_reference(const Points &p)
  {
    const double *x = p.x;
    const int n_all = p.n_all;
    const Bounds bounds(x, n_all);
    center = bounds.center;
    rounding = bounds.rounding;
    reference.resize(n_all + LANES);
    for (int i = 0; i < n_all; i++)
      reference[i] = {static_cast<float>(x[3 * i] - center[0]),
                      static_cast<float>(x[3 * i + 1] - center[1]),
                      static_cast<float>(x[3 * i + 2] - center[2])};
    steps = 0;
  }

  SPHCLOTH_MULTIVERSION void prune(int slot, int t, int other)
  {
    const int types_of_it = pair(t, other);
    const Bound &now = at(block[slot], t, other);
    inner_until[of(slot, other)] = now.at_reference + now.skin;
    const NeighborSpan list = outer(slot, other);
    if (list.n == 0 || limit[types_of_it] == 0.0) return;
    const ApproachBounds::Position self = reference[outer.at(slot)];
    static_assert(LANES == GROUP<float>);
    alignas(64) float x[LANES], y[LANES], z[LANES];
    for (int group = 0; group < list.n; group += LANES) {
      columns<3>(&reference[0].x, list.of + group, x, y, z, static_cast<float *>(nullptr));
      float *sq = key.data() + group;
#pragma omp simd
      for (int k = 0; k < LANES; k++) {
        const float dx = self.x - x[k], dy = self.y - y[k], dz = self.z - z[k];
        sq[k] = dx * dx + dy * dy + dz * dz;
      }
    }
    const double near = limit[types_of_it] + now.skin + rounding;
    n_inner[of(slot, other)] = partition(key.data(), outer.open(slot, other), list.n,
                                         static_cast<float>(near * near), spare.data());
  }

  static int greatest(const NeighborSpan &near, const int *value)
  {
    const int *of = near.of;
    int max_value = std::numeric_limits<int>::min();
    for (int k = 0; k < near.n; k++) max_value = std::max(max_value, value[of[k]]);
    return max_value;
  }

  static int smallest(const NeighborSpan &near, const int *value)
  {
    const int *of = near.of;
    int min_value = std::numeric_limits<int>::max();
    for (int k = 0; k < near.n; k++) min_value = std::min(min_value, value[of[k]]);
    return min_value;
  }

  int type_of(int slot) const
  {
    int t = 1;
    while (slot >= outer.begin(t + 1)) t++;
    return t;
  }
};

}    // namespace sphcloth

#endif
