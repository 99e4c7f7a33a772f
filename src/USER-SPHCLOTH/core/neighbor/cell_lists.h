// SPDX-License-Identifier: GPL-2.0-or-later
// Neighbor lists of short-ranged particles, by type of the neighbor.
//
// Particles are sorted by type and then by cell, cells in rows along x, so that the neighbors of a
// particle lie in a few contiguous runs of single-precision coordinates.  With lists from LAMMPS's
// bins an evaluation takes twice as long (docs/evidence/speed.md, "Where the time goes").
//
// Each type has a grid of its own, as fine as its particles interact among each other.  A pair of
// types without a reach costs nothing, and the neighbors of a particle come grouped by their type,
// so that a loop over one group has one set of coefficients.

#ifndef SPHCLOTH_CORE_NEIGHBOR_CELL_LISTS_H
#define SPHCLOTH_CORE_NEIGHBOR_CELL_LISTS_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/contact/sheet_sides.h"
#include "core/geometry/buckets.h"
#include "core/neighbor/neighbor_spans.h"

namespace sphcloth {

// Where particles are, to count coordinates from the center in single precision

struct Extent {
  std::array<double, 3> lo, hi;

  Extent()
  {
    lo.fill(std::numeric_limits<double>::max());
    hi.fill(std::numeric_limits<double>::lowest());
  }
  void include(const double *x)
  {
    for (int d = 0; d < 3; d++) {
      lo[d] = std::min(lo[d], x[d]);
      hi[d] = std::max(hi[d], x[d]);
    }
  }
};

struct Bounds : Extent {
  std::array<double, 3> center;
  double rounding;    // what that may do to a distance

  Bounds(const double *x, int n)
  {
    for (int i = 0; i < n; i++) include(x + 3 * i);
    double extent = 0.0;
    for (int d = 0; d < 3; d++) {
      center[d] = 0.5 * (lo[d] + hi[d]);
      extent = std::max(extent, hi[d] - lo[d]);
    }
    rounding = extent * 4.0 * std::numeric_limits<float>::epsilon();
  }
};

// Particles that are listed: positions [n_all][3], owned particles first

struct Points {
  const double *x = nullptr;
  const int *type = nullptr;
  int n_owned = 0, n_all = 0, n_types = 0;
  const Sides *sides = nullptr;    // of all; null: there are no sheets that part neighbors
  Parting *layers = nullptr;    // null: sides are enough
};

class CellLists {
 public:
  // reach: [(n_types+1)^2], distance up to which the second type is listed as a neighbor of the
  // first, 0: never.  Particles that a sheet parts are not neighbors.
  void build(const Points &p, const double *reach)
  {
    std::vector<int> none;
    build(p, reach, {}, none);
  }

  // [region][(n_types+1)^2], and the region of each particle
  struct Near {
    const double *distance = nullptr;
    const int *region = nullptr;
  };

  // The same, and those that are near come first in each list; n_near: [slot][type], how many.
  void build(const Points &p, const double *reach, const Near &near, std::vector<int> &n_near)
  {
    const int n_types = p.n_types;
    sort_into_cells(p, reach);
    find_slots(p);
    if (p.layers)
      for (int slot = 0; slot < slots(); slot++) cell[order[slot]] = slot;
    lists.start(order.size(), n_types);
    n_near.assign(near.distance ? order.size() * n_types : 0, 0);
    int *next = n_near.data();
    for (int t = 1; t <= n_types; t++)
      for (int slot = begin(t); slot < begin(t + 1); slot++)
        for (int other = 1; other <= n_types; other++) {
          const int pair = t * (n_types + 1) + other;
          const bool symmetric = reach[pair] == reach[other * (n_types + 1) + t];
          const int n = list(slot, other, reach[pair], t == other, [&](int j) {
            if (!symmetric || j >= p.n_owned || cell[j] >= slot) return UNKNOWN;
            return contains(lists(cell[j], t), order[slot]) ? NEIGHBORS : PARTED;
          });
          if (near.distance)
            *next++ = near_first(lists.room(0), n, near_in(near, slot, n_types)[pair]);
          lists.close(n);
        }
    lists.finish();
    finish();
  }

  // Rebuilds those lists that are due(slot, type, other), of the same particles at their present
  // positions, in the same slots.
  template <class Due>
  void renew(const Points &p, const double *reach, const Near &near, std::vector<int> &n_near,
             Due due)
  {
    const int n_types = p.n_types;
    sort_into_cells(p, reach);
    find_sorted_indices(p.n_owned);
    if (p.layers) listed_by.assign(p.n_all, -1);
    for (int t = 1; t <= n_types; t++)
      for (int slot = begin(t); slot < begin(t + 1); slot++)
        for (int other = 1; other <= n_types; other++) {
          if (!due(slot, t, other)) continue;
          const int pair = t * (n_types + 1) + other;
          if (p.layers) {
            const NeighborSpan before = lists(slot, other);
            for (int k = 0; k < before.n; k++) listed_by[before.of[k]] = slot;
          }
          const int n = list(slot, other, reach[pair], t == other,
                             [&](int j) { return listed_by[j] == slot ? NEIGHBORS : UNKNOWN; });
          n_near[static_cast<std::size_t>(slot) * n_types + other - 1] =
              near_first(lists.replace(slot, other, n), n, near_in(near, slot, n_types)[pair]);
        }
    finish();
  }

  // owned particles by type and then in space: those of a type are the slots begin(t) to
  // begin(t + 1)
  int begin(int t) const { return slots_of[t]; }
  int slots() const { return static_cast<int>(order.size()); }
  int at(int slot) const { return order[slot]; }
  NeighborSpan operator()(int slot, int t) const { return lists(slot, t); }
  // a segment whose order may be changed
  int *open(int slot, int t) { return lists.open(slot, t); }
  double bytes() const
  {
    return lists.bytes() +
        bytes_of(px, py, pz, key, id, order, sorted_index, cell_start, cell, candidate, listed_by);
  }

 private:
  // cells of one type

  struct Grid {
    std::array<double, 3> lo{}, hi{};
    std::array<int, 3> n{1, 1, 1};
    double inv_side = 0.0;
    std::int64_t first = 0;    // cell, of all types

    std::int64_t cells() const { return static_cast<std::int64_t>(n[0]) * n[1] * n[2]; }
    std::int64_t row(int cy, int cz) const
    {
      return first + (static_cast<std::int64_t>(cz) * n[1] + cy) * n[0];
    }
    int along(int d, double x) const
    {
      // what is not a number lies in the first
      return static_cast<int>(std::min(std::max(0.0, (x - lo[d]) * inv_side), n[d] - 1.0));
    }
    std::int64_t at(const double *x) const
    {
      return row(along(1, x[1]), along(2, x[2])) + along(0, x[0]);
    }
  };

  std::vector<Grid> grids;    // by type
  std::array<double, 3> center;
  double slack = 0.0;    // what rounding to single precision may do to a distance
  std::vector<int> slots_of, order;
  std::vector<int> sorted_index;    // of a slot among the sorted particles
  std::vector<int> cell;    // of each particle, or its index among the sorted
  int sorted = 0;    // particles
  std::vector<int> cell_start;    // of all types, and one more
  std::vector<int> id;    // sorted particles: index, position
  AlignedVector<float> px, py, pz;
  std::vector<int> candidate;    // of one particle
  std::vector<float> key;
  std::vector<int> listed_by;    // of each particle, while layers part: a slot that listed it
  NeighborSpans lists;
  Points points;    // during a build

  // half of the reach of a type among its own or, without one, the minimum reach of others to it

  static double cell_side(int t, int n_types, const double *reach)
  {
    if (const double same = reach[t * (n_types + 1) + t]; same > 0.0) return 0.5 * same;
    double min = std::numeric_limits<double>::max();
    for (int other = 1; other <= n_types; other++)
      if (const double of_other = reach[other * (n_types + 1) + t]; of_other > 0.0)
        min = std::min(min, of_other);
    return 0.5 * min;
  }

  // returns how many cells there are

  std::int64_t set_grids(const Points &p, const double *reach)
  {
    const int n_types = p.n_types;
    std::vector<Extent> extents(n_types + 1);
    std::vector<int> count(n_types + 1, 0);
    for (int i = 0; i < p.n_all; i++) {
      extents[p.type[i]].include(p.x + 3 * i);
      count[p.type[i]]++;
    }
    grids.assign(n_types + 1, Grid());
    std::int64_t cells = 0;
    for (int t = 1; t <= n_types; t++) {
      grids[t].first = cells;
      set_grid(grids[t], extents[t], count[t], cell_side(t, n_types, reach));
      cells += grids[t].cells();
    }
    return cells;
  }

  static void set_grid(Grid &grid, const Extent &extent, int n, double side)
  {
    if (n == 0) return;
    const auto cells_along = [&](int d) {
      return 1.0 + std::floor((extent.hi[d] - extent.lo[d]) / side);
    };
    // few particles far apart: larger cells, not more of them
    while (cells_along(0) * cells_along(1) * cells_along(2) > 4.0 * n + 64.0) side *= 1.3;
    grid.lo = extent.lo;
    grid.hi = extent.hi;
    grid.inv_side = 1.0 / side;
    for (int d = 0; d < 3; d++) grid.n[d] = static_cast<int>(cells_along(d));
  }

  // counting sort by type and cell

  void sort_into_cells(const Points &p, const double *reach)
  {
    points = p;
    const double *x = p.x;
    const int *type = p.type, n_all = p.n_all;
    const double longest = *std::max_element(reach, reach + (p.n_types + 1) * (p.n_types + 1));
    sorted = 0;
    if (n_all == 0 || longest == 0.0) return;
    const Bounds bounds(x, n_all);
    center = bounds.center;
    slack = bounds.rounding;

    const std::int64_t n_cells = set_grids(p, reach);
    cell.resize(n_all);
    for (int i = 0; i < n_all; i++) cell[i] = static_cast<int>(grids[type[i]].at(x + 3 * i));
    const auto for_each = [&](auto add) {
      for (int i = 0; i < n_all; i++) add(static_cast<std::size_t>(cell[i]), i);
    };
    sort_into_buckets(static_cast<std::size_t>(n_cells), for_each, cell_start, id);

    px.resize(n_all + LANES);
    py.resize(n_all + LANES);
    pz.resize(n_all + LANES);
    id.resize(n_all + LANES);
    for (int k = 0; k < n_all; k++) {
      const int i = id[k];
      px[k] = static_cast<float>(x[3 * i] - center[0]);
      py[k] = static_cast<float>(x[3 * i + 1] - center[1]);
      pz[k] = static_cast<float>(x[3 * i + 2] - center[2]);
    }
    sorted = n_all;
  }

  void find_slots(const Points &p)
  {
    order.clear();
    sorted_index.clear();
    slots_of.assign(p.n_types + 2, 0);
    for (int k = 0; k < sorted; k++) {
      const int i = id[k];
      if (i >= p.n_owned) continue;
      order.push_back(i);
      sorted_index.push_back(k);
      slots_of[p.type[i] + 1]++;
    }
    for (int t = 1; t <= p.n_types + 1; t++) slots_of[t] += slots_of[t - 1];
  }

  // of the slots that there are
  void find_sorted_indices(int n_owned)
  {
    cell.resize(n_owned);
    sorted_index.resize(order.size());
    for (int p = 0; p < sorted; p++)
      if (id[p] < n_owned) cell[id[p]] = p;
    for (std::size_t slot = 0; slot < order.size(); slot++) sorted_index[slot] = cell[order[slot]];
  }

  // lists live long, what they are made of need not
  void finish()
  {
    for (auto *coordinate : {&px, &py, &pz}) give_back(*coordinate);
    for (auto *list : {&cell, &cell_start, &sorted_index, &id, &listed_by}) give_back(*list);
  }

  // Behind all lists; returns how many are listed.  Their squared distances are in `key`.  Layers
  // are asked for pairs of which known(neighbor) is UNKNOWN.

  enum Known { UNKNOWN, NEIGHBORS, PARTED };
  template <class Find> int list(int slot, int other, double reach, bool same_type, Find known)
  {
    if (reach == 0.0) return 0;
    const double cutoff = reach + slack;
    const auto cutoff_sq = static_cast<float>(cutoff * cutoff);
    const int n = candidates(slot, other, cutoff, same_type), i = order[slot];
    if (points.sides && points.sides[i]) leave_out_parted(i, n, cutoff_sq, known);
    return compact(key.data(), candidate.data(), n, cutoff_sq, key.data(), lists.room(n));
  }

  const double *near_in(const Near &near, int slot, int n_types) const
  {
    const int pairs = (n_types + 1) * (n_types + 1);
    return near.distance + static_cast<std::size_t>(near.region[at(slot)]) * pairs;
  }

  // those of the list just made, of n, that are nearer; returns how many

  int near_first(int *list, int n, double near)
  {
    if (n == 0 || near == 0.0) return 0;
    const double cutoff = near + slack;
    return partition(key.data(), list, n, static_cast<float>(cutoff * cutoff), candidate.data());
  }

  template <class Find> void leave_out_parted(int i, int n, float cutoff_sq, Find known)
  {
    const Sides *of = points.sides;
    const auto are_parted = [&](int j) {
      if (!points.layers) return true;
      const Known by_other = known(j);
      return by_other == UNKNOWN ? points.layers->part(i, j, of[i], of[j]) : by_other == PARTED;
    };
    for (int k = 0; k < n; k++) {
      const int j = candidate[k];
      if (key[k] > cutoff_sq || !are_doubtful(of[i], of[j])) continue;
      if (are_parted(j)) key[k] = std::numeric_limits<float>::max();
    }
  }

  SPHCLOTH_MULTIVERSION static bool contains(const NeighborSpan &list, int wanted)
  {
    int found = 0;
#pragma omp simd reduction(| : found)
    for (int k = 0; k < list.n; k++) found |= list.of[k] == wanted;
    return found != 0;
  }

  // all particles in the cells that the sphere around a particle touches, with the squared
  // distances; returns how many

  SPHCLOTH_MULTIVERSION int candidates(int slot, int other, double reach, bool same_type)
  {
    const int self = sorted_index[slot];
    const Grid &grid = grids[other];
    const float xi = px[self], yi = py[self], zi = pz[self];
    std::array<int, 3> from, to;
    const std::array<float, 3> at{xi, yi, zi};
    for (int d = 0; d < 3; d++) {
      const double x = at[d] + center[d];
      if (x + reach < grid.lo[d] || x - reach > grid.hi[d]) return 0;
      from[d] = grid.along(d, x - reach);
      to[d] = grid.along(d, x + reach);
    }
    int n = 0;
    for (int cz = from[2]; cz <= to[2]; cz++)
      for (int cy = from[1]; cy <= to[1]; cy++) {
        const std::int64_t row = grid.row(cy, cz);
        const int begin = cell_start[row + from[0]], end = cell_start[row + to[0] + 1];
        const std::size_t need = n + whole_groups(end - begin) + 2 * LANES;
        if (key.size() < need) {
          key.resize(2 * need);
          candidate.resize(2 * need);
        }
        distances(begin, end - begin, xi, yi, zi, key.data() + n, candidate.data() + n);
        if (same_type && begin <= self && self < end)
          key[n + self - begin] = std::numeric_limits<float>::max();
        n += end - begin;
      }
    return n;
  }

  SPHCLOTH_INLINE void distances(int begin, int n, float xi, float yi, float zi, float *rsq,
                                 int *index) const
  {
    const float *x = px.data() + begin, *y = py.data() + begin, *z = pz.data() + begin;
    const int *of = id.data() + begin;
    for (int k = 0; k < n; k += LANES)
#pragma omp simd
      for (int m = k; m < k + LANES; m++) {
        const float dx = xi - x[m], dy = yi - y[m], dz = zi - z[m];
        rsq[m] = dx * dx + dy * dy + dz * dz;
        index[m] = of[m];
      }
  }
};

}    // namespace sphcloth

#endif
