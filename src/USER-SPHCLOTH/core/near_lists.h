// Neighbour lists whose front holds those who interact now.
//
// A list that serves for many steps holds about twice as many particles as are inside the support.
// Those within the support and a small inner skin are moved to its front, and the loops run over
// the front alone until particles of the two types may have come nearer by the inner skin.  The
// inner skin follows from the motion: each particle that it adds costs a little at every evaluation,
// and each evaluation that it lasts saves one pass over the list.  (A dual list: Pall et al., J. Chem.
// Phys. 153 (2020) 134110.)
//
// Each type has an odometer: how far the fastest of its particles may have gone.  A front is valid up
// to a sum of the readings of its two types, so particles that are evaluated seldom, or among
// others that are slow, keep theirs while fronts elsewhere are found anew.
//
// Nothing is kept from one list to the next, so a run that is continued from a restart file goes on
// with the same fronts.  Every rank decides for itself.  A front is found when it is asked for, from
// the positions at which odometers were read last, so particles that nobody asks for cost nothing.

#ifndef SPHCLOTH_CORE_NEAR_LISTS_H
#define SPHCLOTH_CORE_NEAR_LISTS_H

#include "neighbours.h"

namespace sphcloth {

// Of the particles of a type: how far the fastest goes from one evaluation to the next, as far as is
// known, and after how many of them one is evaluated itself, on average.

struct Drift {
  double way = 0.0, interval = 1.0;
};

class NearLists {
 public:
  // As NeighbourLists; support: [(n_types+1)^2], up to where two types interact, 0: never; drifts:
  // [n_types+1].
  void build(const double *x, const int *type, int n_owned, int n_all, int n_types,
             const double *reach, const double *support, int dimension,
             const std::vector<Drift> &drifts, const Sides *sides = nullptr)
  {
    give_back(held);    // its memory for what the lists are made of
    types = n_types;
    dim = dimension;
    drift = drifts;
    set_limits(reach, support);
    for (int t = 1; t <= types; t++)
      for (int other = 1; other <= types; other++) set_first_skin(t, other);
    std::vector<double> near(limit);
    for (std::size_t k = 0; k < near.size(); k++)
      if (near[k] > 0.0) near[k] += skin[k];
    outer.build(x, type, n_owned, n_all, n_types, reach, near.data(), front, sides);
    distance.assign(types + 1, 0.0);
    reading = distance;
    until.resize(front.size());
    current.assign(outer.slots(), 0);
    slot_of.resize(n_owned);
    longest_list = 0;
    for (int slot = 0, t = 1; slot < outer.slots(); slot++) {
      while (slot >= outer.begin(t + 1)) t++;
      slot_of[outer.at(slot)] = slot;
      for (int other = 1; other <= n_types; other++) {
        longest_list = std::max(longest_list, outer(slot, other).n);
        until[of(slot, other)] = skin[pair(t, other)];
      }
    }
    key.resize(whole_groups(longest_list) + 2 * LANES);
    spare.resize(key.size());
    evaluation = 0;
    if (outer.slots() == 0) return;
    hold(x, n_all);
    steps = -1;    // the evaluation for which lists are new comes first
  }

  // Once per evaluation, before lists are read: x, [n_all][3], are the positions now.
  void follow(const double *x, const int *type, int n_all)
  {
    if (outer.slots() == 0) return;
    begin_evaluation();
    steps++;
    read_odometers(x, type, n_all);
    if (!any_skin_is_gone()) return;
    for (int t = 1; t <= types; t++) {
      drift[t].way = (reading[t] - distance[t]) / std::max(1, steps);
      distance[t] = reading[t];
    }
    for (int t = 1; t <= types; t++)
      for (int other = 1; other <= types; other++) skin[pair(t, other)] = lasting_skin(t, other);
    hold(x, n_all);
    steps = 0;
  }

  // makes the front of all lists of one particle valid
  void refresh(int slot)
  {
    if (current[slot] == evaluation) return;
    current[slot] = static_cast<std::uint8_t>(evaluation);
    const int t = type_of(slot);
    for (int other = 1; other <= types; other++)
      if (reading[t] + reading[other] > until[of(slot, other)]) move_to_front(slot, t, other);
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
  double inner_skin(int t, int other) const { return skin[pair(t, other)]; }
  // list, of one particle and type
  int longest() const { return longest_list; }

  double bytes() const { return outer.bytes() + bytes_of(held, until, front, slot_of, current); }

 private:
  struct Place {
    float x, y, z;
  };

  // what an entry of a list costs while its front is found, over one of the front in an evaluation,
  // about (measured)
  static constexpr double ENTRY_COST = 0.23;
  // least inner skin over support while nothing is known of the motion
  static constexpr double FIRST_SKIN = 0.02;

  NeighbourLists outer;
  int types = 0;
  std::vector<int> front, slot_of;    // [slot][type], [owned particle]
  std::vector<double> until;    // [slot][type], sum of two readings
  std::vector<std::uint8_t> current;    // [slot], the evaluation in which it was asked for
  std::vector<double> limit, skin;    // of a pair of types: support, 0: never; inner skin
  std::vector<double> widest, cost;    // what the skin of the lists allows; of finding a front
  std::vector<Drift> drift;    // of a type
  std::vector<double> distance, reading;    // of the odometers, when positions were held and now
  AlignedVector<Place> held;    // positions then
  std::array<double, 3> centre{};
  AlignedVector<float> key;
  std::vector<int> spare;

  int dim = 3;
  int longest_list = 0;
  int evaluation = 0;    // 1 to 255
  int steps = 0;    // evaluations since positions were held
  double rounding = 0.0;    // of a distance in single precision

  std::size_t of(int slot, int t) const { return static_cast<std::size_t>(slot) * types + t - 1; }
  int pair(int t, int other) const { return t * (types + 1) + other; }

  void set_limits(const double *reach, const double *support)
  {
    const int n = (types + 1) * (types + 1);
    limit.assign(n, 0.0);
    skin.assign(n, 0.0);
    widest.assign(n, 0.0);
    cost.assign(n, 0.0);
    for (int k = 0; k < n; k++) {
      if (reach[k] == 0.0 || support[k] == 0.0) continue;
      limit[k] = support[k];
      widest[k] = reach[k] - support[k];
      cost[k] = ENTRY_COST * std::pow(reach[k] / support[k], dim);
    }
  }

  void set_first_skin(int t, int other)
  {
    const int k = pair(t, other);
    skin[k] = std::min(widest[k], std::max(FIRST_SKIN * limit[k], lasting_skin(t, other)));
  }

  // For n evaluations of one particle a skin that two use up in the meantime, with a margin: the
  // front then holds 1 + dim skin/H as many, and finding it costs cost/(n + 1) per evaluation.  The
  // n of least cost.
  double lasting_skin(int t, int other) const
  {
    const int k = pair(t, other);
    const double nearer = (drift[t].way + drift[other].way) * drift[t].interval;
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

  // of a front that would be found now
  bool any_skin_is_gone() const
  {
    for (int t = 1; t <= types; t++)
      for (int other = 1; other <= types; other++)
        if (const int k = pair(t, other);
            limit[k] > 0.0 && reading[t] - distance[t] + reading[other] - distance[other] > skin[k])
          return true;
    return false;
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

  // Who has not moved reads nothing of what rounding does.
  void read_odometers(const double *x, const int *type, int n_all)
  {
    for (int t = 1; t <= types; t++) reading[t] = 0.0;
    add_farthest(x, type, n_all);
    for (int t = 1; t <= types; t++) {
      const double way = std::sqrt(reading[t]);
      reading[t] = distance[t] + (way > 0.0 ? way + rounding : 0.0);
    }
  }

  // the largest squared distance from where particles of each type were held
  SPHCLOTH_MULTIVERSION void add_farthest(const double *x, const int *type, int n_all)
  {
    constexpr int PIECE = 32 * LANES;
    alignas(64) float sq[PIECE];
    const double cx = centre[0], cy = centre[1], cz = centre[2];
    for (int first = 0; first < n_all; first += PIECE) {
      const int n = std::min(PIECE, n_all - first);
      const double *y = x + 3 * static_cast<std::ptrdiff_t>(first);
      const Place *before = held.data() + first;
#pragma omp simd
      for (int k = 0; k < n; k++) {
        const float dx = static_cast<float>(y[3 * k] - cx) - before[k].x,
                    dy = static_cast<float>(y[3 * k + 1] - cy) - before[k].y,
                    dz = static_cast<float>(y[3 * k + 2] - cz) - before[k].z;
        sq[k] = dx * dx + dy * dy + dz * dz;
      }
      const int *its = type + first;
      for (int t = 1; t <= types; t++) {
        float most = 0.0F;
#pragma omp simd reduction(max : most)
        for (int k = 0; k < n; k++) most = std::max(most, its[k] == t ? sq[k] : 0.0F);
        reading[t] = std::max(reading[t], static_cast<double>(most));
      }
    }
  }

  SPHCLOTH_MULTIVERSION void move_to_front(int slot, int t, int other)
  {
    const int types_of_it = pair(t, other);
    until[of(slot, other)] = distance[t] + distance[other] + skin[types_of_it];
    const Stretch list = outer(slot, other);
    if (list.n == 0 || limit[types_of_it] == 0.0) return;
    const Place self = held[outer.at(slot)];
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
    const double far = limit[types_of_it] + skin[types_of_it] + rounding;
    front[of(slot, other)] = partition(key.data(), outer.open(slot, other), list.n,
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
