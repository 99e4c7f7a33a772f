// Neighbour lists whose front holds those who interact now.
//
// A list that serves for many steps holds about twice as many particles as are inside the support.
// Those within the support and a small inner skin are moved to its front, and the loops run over
// the front alone until some particle has moved by half of the inner skin.  The inner skin follows
// from the motion: each particle that it adds costs a little at every step, and each step that it
// lasts saves one pass over the lists.  (A dual list: Pall et al., J. Chem. Phys. 153 (2020) 134110.)
//
// Nothing is kept from one list to the next, so a run that is continued from a restart file goes on
// with the same fronts.  Every rank decides for itself.  A list is refreshed when it is asked for,
// from the positions at which the present inner skin began, so particles that nobody asks for cost
// nothing.

#ifndef SPHCLOTH_CORE_NEAR_LISTS_H
#define SPHCLOTH_CORE_NEAR_LISTS_H

#include "neighbours.h"

namespace sphcloth {

class NearLists {
 public:
  // As NeighbourLists; support: [(n_types+1)^2], up to where two types interact, 0: never.
  void build(const double *x, const int *type, int n_owned, int n_all, int n_types,
             const double *reach, const double *support, int dimension,
             const Sides *sides = nullptr)
  {
    give_back(held);    // its memory for what the lists are made of
    outer.build(x, type, n_owned, n_all, n_types, reach, sides);
    types = n_types;
    dim = dimension;
    set_limits(reach, support);
    front.assign(static_cast<std::size_t>(outer.slots()) * n_types, 0);
    refreshed.assign(outer.slots(), 0);
    slot_of.resize(n_owned);
    longest_list = 0;
    for (int slot = 0; slot < outer.slots(); slot++) {
      slot_of[outer.at(slot)] = slot;
      for (int t = 1; t <= n_types; t++) longest_list = std::max(longest_list, outer(slot, t).n);
    }
    key.resize(whole_groups(longest_list) + 2 * LANES);
    spare.resize(key.size());
    steps = -1;
  }

  // Once per evaluation, before lists are read: x, [n_all][3], are the positions now.
  void follow(const double *x, int n_all)
  {
    if (outer.slots() == 0) return;
    if (steps < 0) return start(x, n_all, FIRST_SKIN * least_support);
    const double moved = farthest(x, n_all) + rounding;
    const double pace = moved / ++steps;
    if (2.0 * moved > skin) start(x, n_all, lasting_skin(pace));
  }

  // makes the front of all lists of one particle valid
  void refresh(int slot)
  {
    if (refreshed[slot] == epoch) return;
    refreshed[slot] = static_cast<std::uint8_t>(epoch);
    const double *supports = &limit[type_of(slot) * (types + 1)];
    for (int t = 1; t <= types; t++) move_to_front(slot, t, supports[t]);
  }

  // Of a value of each particle: the greatest among all neighbours of one, and whether all of them
  // have the same.
  int greatest(int slot, const int *value)
  {
    refresh(slot);
    int most = std::numeric_limits<int>::min();
    for (int t = 1; t <= types; t++) most = std::max(most, greatest((*this)(slot, t), value));
    return most;
  }
  bool all_have(int same, int slot, const int *value)
  {
    refresh(slot);
    for (int t = 1; t <= types; t++)
      if (differing((*this)(slot, t), value, same)) return false;
    return true;
  }

  // owned particles by type and in space, see NeighbourLists
  int begin(int t) const { return outer.begin(t); }
  int slots() const { return outer.slots(); }
  int at(int slot) const { return outer.at(slot); }
  // everyone up to the reach
  Stretch all(int slot, int t) const { return outer(slot, t); }
  // Everyone inside the support and some a little outside, as of the last refresh.
  Stretch operator()(int slot, int t) const { return {outer(slot, t).of, front[of(slot, t)]}; }
  int slot(int owned) const { return slot_of[owned]; }
  double inner_skin() const { return skin; }
  // list, of one particle and type
  int longest() const { return longest_list; }

  double bytes() const
  {
    return outer.bytes() + sizeof(Place) * static_cast<double>(held.capacity()) +
        sizeof(int) * static_cast<double>(front.capacity() + slot_of.capacity()) +
        static_cast<double>(refreshed.capacity());
  }

 private:
  struct Place {
    float x, y, z;
  };

  // what refreshing a list costs over one evaluation of its front, about (measured)
  static constexpr double REFRESH_COST = 0.4;
  // inner skin over support while nothing is known of the motion
  static constexpr double FIRST_SKIN = 0.02;

  NeighbourLists outer;
  int types = 0;
  std::vector<int> front, slot_of;    // [slot][type], [owned particle]
  std::vector<std::uint8_t> refreshed;    // [slot], in which epoch
  std::vector<double> limit;    // support of a pair of types, 0: never
  AlignedVector<Place> held;    // positions at the begin of this inner skin
  std::array<double, 3> centre{};
  AlignedVector<float> key;
  std::vector<int> spare;

  int dim = 3;
  int longest_list = 0;
  int epoch = 0;    // 1 to 255
  int steps = -1;    // evaluations since this inner skin began, -1: lists are new
  double skin = 0.0, widest = 0.0;    // widest: what the skin of the lists allows
  double least_support = 0.0;
  double rounding = 0.0;    // of a distance in single precision

  std::size_t of(int slot, int t) const { return static_cast<std::size_t>(slot) * types + t - 1; }

  void set_limits(const double *reach, const double *support)
  {
    const int n = (types + 1) * (types + 1);
    limit.assign(support, support + n);
    least_support = widest = std::numeric_limits<double>::max();
    for (int k = 0; k < n; k++) {
      if (reach[k] == 0.0 || support[k] == 0.0) continue;
      least_support = std::min(least_support, support[k]);
      widest = std::min(widest, reach[k] - support[k]);
    }
  }

  // For n evaluations a skin of 2 n pace, with a margin: the front then holds 1 + 2 n pace dim/H
  // as many, and refreshing costs REFRESH_COST / (n + 1) per evaluation.  The n of least cost.
  double lasting_skin(double pace) const
  {
    if (!(pace > 0.0)) return widest;
    const double n = std::sqrt(REFRESH_COST * least_support / (2.0 * dim * pace)) - 0.5;
    return 2.2 * pace * std::floor(std::clamp(n, 0.0, 1000.0));
  }

  void start(const double *x, int n_all, double inner_skin)
  {
    if (++epoch > std::numeric_limits<std::uint8_t>::max()) {
      std::fill(refreshed.begin(), refreshed.end(), 0);
      epoch = 1;
    }
    steps = 0;
    skin = std::min(inner_skin, widest);
    hold(x, n_all);
  }

  void hold(const double *x, int n_all)
  {
    const Bounds bounds(x, n_all);
    centre = bounds.centre;
    rounding = bounds.rounding;
    held.resize(n_all + LANES);
    for (int i = 0; i < n_all; i++)
      held[i] = {static_cast<float>(x[3 * i] - centre[0]),
                 static_cast<float>(x[3 * i + 1] - centre[1]),
                 static_cast<float>(x[3 * i + 2] - centre[2])};
  }

  SPHCLOTH_MULTIVERSION double farthest(const double *x, int n_all) const
  {
    const double cx = centre[0], cy = centre[1], cz = centre[2];
    float most = 0.0F;
#pragma omp simd reduction(max : most)
    for (int i = 0; i < n_all; i++) {
      const float dx = static_cast<float>(x[3 * i] - cx) - held[i].x,
                  dy = static_cast<float>(x[3 * i + 1] - cy) - held[i].y,
                  dz = static_cast<float>(x[3 * i + 2] - cz) - held[i].z;
      most = std::max(most, dx * dx + dy * dy + dz * dz);
    }
    return std::sqrt(static_cast<double>(most));
  }

  SPHCLOTH_MULTIVERSION void move_to_front(int slot, int t, double support)
  {
    const Stretch list = outer(slot, t);
    const int i = outer.at(slot);
    if (list.n == 0 || support == 0.0) return;
    const Place self = held[i];
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
    const double far = support + skin + rounding;
    front[of(slot, t)] = partition(key.data(), outer.open(slot, t), list.n,
                                   static_cast<float>(far * far), spare.data());
  }

  SPHCLOTH_MULTIVERSION int greatest(const Stretch &near, const int *value) const
  {
    const int *of = near.of;
    int most = std::numeric_limits<int>::min();
#pragma omp simd reduction(max : most)
    for (int k = 0; k < near.n; k++) most = std::max(most, value[of[k]]);
    return most;
  }

  SPHCLOTH_MULTIVERSION int differing(const Stretch &near, const int *value, int same) const
  {
    const int *of = near.of;
    int bits = 0;
#pragma omp simd reduction(| : bits)
    for (int k = 0; k < near.n; k++) bits |= value[of[k]] ^ same;
    return bits;
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
