// Neighbour lists whose front holds those who interact now.
//
// A list that serves for many steps holds about twice as many particles as are inside the support.
// Those within the support and a small inner skin are moved to its front, and the loops run over
// the front alone until particles may have come nearer by the inner skin.  The inner skin follows
// from the motion: each particle that it adds costs a little at every evaluation, and each
// evaluation that it lasts saves one pass over the list.  (A dual list: Pall et al., J. Chem. Phys.
// 153 (2020) 134110.)
//
// Each block of space has an odometer for each pair of types: how much nearer they may have come
// there (core/neighbor/approach_bounds.h).  A front is valid up to a reading of it, so particles
// that are evaluated seldom, rest, or move with those around them keep theirs while fronts
// elsewhere are found anew.  The lists themselves hold until a reading exceeds their skin.
//
// Nothing is kept from one list to the next, so a run that is continued from a restart file goes on
// with the same fronts.  Every rank decides for itself.  A front is found when it is asked for,
// from the positions at which odometers were read last, so particles that nobody asks for cost
// nothing.

#ifndef SPHCLOTH_CORE_NEIGHBOR_DUAL_LISTS_H
#define SPHCLOTH_CORE_NEIGHBOR_DUAL_LISTS_H

#include "core/neighbor/approach_bounds.h"
#include "core/neighbor/block_minmax.h"
#include "core/neighbor/cell_lists.h"

namespace sphcloth {

// What is known of the motion: velocities of all particles, [n_all][3], or null, for about how long
// from one evaluation to the next; and of a type, [n_types+1], after how many of them one is
// evaluated itself, on average.

struct Motion {
  const double *v = nullptr;
  double step = 0.0;
  std::vector<double> interval;
};

class DualLists {
 public:
  // support: [(n_types+1)^2], up to where two types interact, 0: never.  No list needs a wider skin
  // than `most`: somebody else sees that lists are built anew before two that are farther apart
  // than that can meet.
  void build(const double *x, const int *type, int n_owned, int n_all, int n_types,
             const double *support, double most, int dimension, const Motion &motion,
             const Sides *sides = nullptr)
  {
    give_back(held);    // its memory for what the lists are made of
    types = n_types;
    dim = dimension;
    interval = motion.interval;
    set_limits(support, most);
    set_blocks(x, type, n_all, most, motion);
    const std::vector<double> near = near_fronts();
    outer.build(x, type, n_owned, n_all, n_types, far.data(), {near.data(), blocks.of_particle()},
                in_front, sides);
    until.resize(in_front.size());
    slot_of.resize(n_owned);
    block.resize(outer.slots());
    for (int slot = 0; slot < outer.slots(); slot++) {
      slot_of[outer.at(slot)] = slot;
      block[slot] = blocks.of_particle()[outer.at(slot)];
    }
    current.assign(outer.slots(), 1);
    evaluation = 1;
    hold(x, n_all);
    longest_list = 0;
    note_lists([](int, int, int) { return true; });
  }

  // Once per evaluation but for the one for which lists are new, before they are read.  The
  // particles are those for which lists were built, where they are now.
  void follow(const double *x, const int *type, int n_owned, int n_all,
              const Sides *sides = nullptr)
  {
    if (outer.slots() == 0) return;
    begin_evaluation();
    steps++;
    closing.measure(x, center, held.data());
    bool fronts_hold = true, lists_hold = true;
    for_each_front([&](Front &front, int b, int t, int other) {
      const double nearer = closing.between(b, t, other);
      front.reading = front.held + (nearer > 0.0 ? nearer + 2.0 * rounding : 0.0);
      fronts_hold = fronts_hold && front.reading <= front.held + front.skin;
      lists_hold = lists_hold && front.reading <= front.lists_until;
    });
    if (fronts_hold && lists_hold) return;
    for_each_front([&](Front &front, int, int t, int other) {
      front.skin = lasting_skin(t, other, (front.reading - front.held) / steps);
      front.held = front.reading;
    });
    hold(x, n_all);
    if (!lists_hold) renew(x, type, n_owned, n_all, sides);
  }

  // makes the front of all lists of one particle valid
  void refresh(int slot)
  {
    if (current[slot] == evaluation) return;
    current[slot] = static_cast<std::uint8_t>(evaluation);
    const int t = type_of(slot);
    const Front *of_block = &at(block[slot], t, 1);
    for (int other = 1; other <= types; other++)
      if (of_block[other - 1].reading > until[of(slot, other)]) move_to_front(slot, t, other);
  }

  // Of a value of each particle: is that of a neighbour of one type above a limit?  Whose is
  // another?  What many are about to ask may be found for whole blocks of space before; `surveyed`
  // says that this was the last survey.
  void measure_block_ranges(const int *value) { survey.take(value); }
  bool any_above(int most, int slot, int other, const int *value, bool surveyed)
  {
    if (surveyed && survey.greatest(block[slot], other) <= most) return false;
    refresh(slot);
    return greatest((*this)(slot, other), value) > most;
  }
  // until somebody asks again
  NeighborSpan others(int same, int slot, int other, const int *value, bool surveyed = false)
  {
    if (surveyed && survey.all_have(same, block[slot], other)) return {nullptr, 0};
    refresh(slot);
    const NeighborSpan near = (*this)(slot, other);
    const int n = pick_others(value, same, near.of, near.n, spare.data());
    if (n > 0) std::fill_n(spare.data() + n, LANES, spare[0]);    // what fills up a group is read
    return {spare.data(), n};
  }

  // owned particles by type and in space, see NeighbourLists
  int begin(int t) const { return outer.begin(t); }
  int slots() const { return outer.slots(); }
  int at(int slot) const { return outer.at(slot); }
  // Everyone inside the support and some a little outside, as of the last refresh.
  NeighborSpan operator()(int slot, int t) const
  {
    return {outer(slot, t).of, in_front[of(slot, t)]};
  }
  int slot(int owned) const { return slot_of[owned]; }
  // of the front of one particle, if it were found now
  double inner_skin(int slot, int t) const { return at(block[slot], type_of(slot), t).skin; }
  // list, of one particle and type
  int longest() const { return longest_list; }

  double bytes() const
  {
    return outer.bytes() + blocks.bytes() + closing.bytes() + survey.bytes() +
        bytes_of(held, until, in_front, slot_of, block, current, fronts, due, due_block);
  }

 private:
  // of particles of a type in a block, in the lists of another type
  struct Front {
    double reading = 0.0;    // of the odometer, now
    double held = 0.0;    // and when positions were held
    double skin = 0.0;    // inner skin of what is found from these
    double lists_until = 0.0;    // the lists hold up to this reading
  };

  // what an entry of a list costs while its front is found, over one of the front in an evaluation,
  // about (measured)
  static constexpr double ENTRY_COST = 0.23;
  // Skin of the lists over support: narrow lists are quick to read, wide ones last.  Between 0.2
  // and 0.4 all cost the same (measured).
  static constexpr double LIST_SKIN = 0.3;
  // least inner skin over support while nothing is known of the motion
  static constexpr double FIRST_SKIN = 0.02;

  CellLists outer;
  int types = 0;
  std::vector<int> in_front, slot_of;    // [slot][type], [owned particle]
  std::vector<double> until;    // [slot][type], reading of the odometer
  std::vector<std::uint8_t> current;    // [slot], the evaluation in which it was asked for
  std::vector<int> block;    // [slot]
  std::vector<Front> fronts;    // [block][type][type]
  std::vector<char> due, due_block;    // of these, and of blocks: lists that are made anew
  // of a pair of types: support, 0: never; reach of the lists; their skin, and how much of it may
  // be used up; cost of finding a front
  std::vector<double> limit, far, widest, lasting, cost;
  std::vector<double> interval;    // of a type
  Blocks blocks;
  ApproachBounds closing{blocks};
  BlockMinMax survey{blocks};
  AlignedVector<ApproachBounds::Place> held;    // positions from which fronts are found
  std::array<double, 3> center{};
  AlignedVector<float> key;
  std::vector<int> spare;

  int dim = 3;
  int longest_list = 0;
  int evaluation = 0;    // 1 to 255
  int steps = 0;    // evaluations since positions were held
  double rounding = 0.0;    // of a distance in single precision

  std::size_t of(int slot, int t) const { return static_cast<std::size_t>(slot) * types + t - 1; }
  int pair(int t, int other) const { return t * (types + 1) + other; }
  Front &at(int b, int t, int other) { return fronts[(b * types + t - 1) * types + other - 1]; }
  const Front &at(int b, int t, int other) const
  {
    return fronts[(b * types + t - 1) * types + other - 1];
  }
  template <class Do> void for_each_front(Do something)
  {
    for (int b = 0; b < blocks.count(); b++)
      for (int t = 1; t <= types; t++) {
        if (blocks.in(blocks.row(b, t)).empty()) continue;
        for (int other = 1; other <= types; other++)
          if (limit[pair(t, other)] > 0.0) something(at(b, t, other), b, t, other);
      }
  }

  void set_limits(const double *support, double most)
  {
    const int n = (types + 1) * (types + 1);
    limit.assign(support, support + n);
    for (std::vector<double> *of_pair : {&far, &widest, &lasting, &cost}) of_pair->assign(n, 0.0);
    for (int k = 0; k < n; k++) {
      if (limit[k] == 0.0) continue;
      widest[k] = std::min(most, LIST_SKIN * limit[k]);
      lasting[k] = widest[k] < most ? widest[k] : std::numeric_limits<double>::max();
      far[k] = limit[k] + widest[k];
      cost[k] = ENTRY_COST * std::pow(far[k] / limit[k], dim);
    }
  }

  // Blocks stay as they are while lists are renewed: who meets until lists are built again must be
  // in blocks beside each other now.
  void set_blocks(const double *x, const int *type, int n_all, double most, const Motion &motion)
  {
    constexpr double ROUNDING = 1e-6;
    const double longest = *std::max_element(limit.begin(), limit.end()) + most;
    blocks.divide(x, type, n_all, types, longest * (1.0 + ROUNDING));
    fronts.assign(static_cast<std::size_t>(blocks.count()) * types * types, Front());
    if (motion.v) closing.measure(motion.v, {0.0, 0.0, 0.0}, nullptr);
    for_each_front([&](Front &front, int b, int t, int other) {
      const double displacement = motion.v ? closing.between(b, t, other) * motion.step : 0.0;
      const int k = pair(t, other);
      front.skin = std::min(widest[k],
                            std::max(FIRST_SKIN * limit[k], lasting_skin(t, other, displacement)));
      front.lists_until = lasting[k];
    });
  }

  // the lists of those blocks where somebody may be missing
  void renew(const double *x, const int *type, int n_owned, int n_all, const Sides *sides)
  {
    const std::vector<double> near = near_fronts();
    due.assign(fronts.size(), false);
    due_block.assign(blocks.count(), false);
    for_each_front([&](Front &front, int b, int t, int other) {
      if (front.held <= front.lists_until) return;
      front.lists_until = front.held + lasting[pair(t, other)];
      due[&front - fronts.data()] = due_block[b] = true;
    });
    const auto is_due = [this](int slot, int t, int other) {
      return due_block[block[slot]] && due[&at(block[slot], t, other) - fronts.data()];
    };
    outer.renew(x, type, n_owned, n_all, types, far.data(), {near.data(), blocks.of_particle()},
                in_front, sides, is_due);
    note_lists(is_due);
  }

  // up to where particles are in front: [block][(n_types+1)^2]
  std::vector<double> near_fronts()
  {
    std::vector<double> near(blocks.count() * limit.size());
    for_each_front([&](const Front &front, int b, int t, int other) {
      near[b * limit.size() + pair(t, other)] = limit[pair(t, other)] + front.skin;
    });
    return near;
  }

  // after those that are new(slot, type, other) were made
  template <class New> void note_lists(New is_new)
  {
    for (int slot = 0, t = 1; slot < outer.slots(); slot++) {
      while (slot >= outer.begin(t + 1)) t++;
      for (int other = 1; other <= types; other++) {
        if (!is_new(slot, t, other)) continue;
        longest_list = std::max(longest_list, outer(slot, other).n);
        const Front &front = at(block[slot], t, other);
        until[of(slot, other)] = front.held + front.skin;
      }
    }
    key.resize(whole_groups(longest_list) + 2 * LANES);
    spare.resize(key.size());
  }

  // For n evaluations of one particle a skin that is used up in the meantime, with a margin: the
  // front then holds 1 + dim skin/H as many, and finding it costs cost/(n + 1) per evaluation.  The
  // n of least cost.
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

  void hold(const double *x, int n_all)
  {
    const Bounds bounds(x, n_all);
    center = bounds.center;
    rounding = bounds.rounding;
    held.resize(n_all + LANES);
    for (int i = 0; i < n_all; i++)
      held[i] = {static_cast<float>(x[3 * i] - center[0]),
                 static_cast<float>(x[3 * i + 1] - center[1]),
                 static_cast<float>(x[3 * i + 2] - center[2])};
    steps = 0;
  }

  SPHCLOTH_MULTIVERSION void move_to_front(int slot, int t, int other)
  {
    const int types_of_it = pair(t, other);
    const Front &now = at(block[slot], t, other);
    until[of(slot, other)] = now.held + now.skin;
    const NeighborSpan list = outer(slot, other);
    if (list.n == 0 || limit[types_of_it] == 0.0) return;
    const ApproachBounds::Place self = held[outer.at(slot)];
    static_assert(LANES == GROUP<float>);
    alignas(64) float x[LANES], y[LANES], z[LANES];
    for (int group = 0; group < list.n; group += LANES) {
      columns<3>(&held[0].x, list.of + group, x, y, z, static_cast<float *>(nullptr));
      float *sq = key.data() + group;
#pragma omp simd
      for (int k = 0; k < LANES; k++) {
        const float dx = self.x - x[k], dy = self.y - y[k], dz = self.z - z[k];
        sq[k] = dx * dx + dy * dy + dz * dz;
      }
    }
    const double near = limit[types_of_it] + now.skin + rounding;
    in_front[of(slot, other)] = partition(key.data(), outer.open(slot, other), list.n,
                                          static_cast<float>(near * near), spare.data());
  }

  SPHCLOTH_MULTIVERSION int greatest(const NeighborSpan &near, const int *value) const
  {
    const int *of = near.of;
    int most = std::numeric_limits<int>::min();
#pragma omp simd reduction(max : most)
    for (int k = 0; k < near.n; k++) most = std::max(most, value[of[k]]);
    return most;
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
