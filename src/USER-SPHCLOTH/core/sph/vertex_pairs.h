// SPDX-License-Identifier: GPL-2.0-or-later
// The fluid that each owned vertex is beside.

#ifndef SPHCLOTH_CORE_SPH_VERTEX_PAIRS_H
#define SPHCLOTH_CORE_SPH_VERTEX_PAIRS_H

#include "core/util/bytes.h"

#include <vector>

namespace sphcloth {

struct VertexPairs {
  struct Pair {
    int fluid;    // atom
    double x, y, z, stiffness;    // unit vector between both; d_kj of core/sph/mass_scaling.h
    double motion;    // velocity of the fluid beside the vertex along it
  };
  struct Range {
    const Pair *from, *to;
    const Pair *begin() const { return from; }
    const Pair *end() const { return to; }
  };

  std::vector<int> vertices;    // atoms, those with pairs

  int size() const { return static_cast<int>(vertices.size()); }
  Range of(int n) const { return {pairs.data() + first[n], pairs.data() + first[n + 1]}; }

  void clear()
  {
    vertices.clear();
    first.assign(1, 0);
    pairs.clear();
  }
  // of the vertex that is next
  void add(const Pair &pair) { pairs.push_back(pair); }
  void end_vertex(int atom)
  {
    if (static_cast<int>(pairs.size()) == first.back()) return;
    vertices.push_back(atom);
    first.push_back(static_cast<int>(pairs.size()));
  }

  double bytes() const { return bytes_of(vertices, first, pairs); }

 private:
  std::vector<int> first{0};
  std::vector<Pair> pairs;
};

}    // namespace sphcloth

#endif
