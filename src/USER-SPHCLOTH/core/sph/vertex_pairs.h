// SPDX-License-Identifier: GPL-2.0-or-later
// The fluid that each owned vertex is beside.

#ifndef SPHCLOTH_CORE_SPH_VERTEX_PAIRS_H
#define SPHCLOTH_CORE_SPH_VERTEX_PAIRS_H

#include "core/util/bytes.h"

#include <cmath>
#include <vector>

namespace sphcloth {

// What the motion u along a unit vector e, e.u, and its part across a surface with the normal n,
// (e.n)(n.u), have in common

inline double along_and_across(const double (&e)[3], const double *n, const double (&u)[3])
{
  const double along = e[0] * u[0] + e[1] * u[1] + e[2] * u[2];
  const double across =
      (e[0] * n[0] + e[1] * n[1] + e[2] * n[2]) * (n[0] * u[0] + n[1] * u[1] + n[2] * u[2]);
  if (along * across <= 0.0) return 0.0;
  return std::fabs(along) < std::fabs(across) ? along : across;
}

struct VertexPairs {
  struct Pair {
    int fluid;    // atom
    double x, y, z, stiffness;    // unit vector between both; d_kj of core/sph/mass_scaling.h
    double motion;    // velocity of the fluid beside the vertex, along it and across the surface
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
