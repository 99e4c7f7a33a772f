// SPDX-License-Identifier: GPL-2.0-or-later
// Greedy coloring of constraints: two constraints of one color share no vertex, so a color can
// be projected in any order, by any number of ranks, with the same result.
//
// Vertices are numbered 0 .. n_vertices-1 in the order of their global IDs and constraints come
// sorted by them, so the colors depend on the mesh alone.

#ifndef SPHCLOTH_CORE_PBD_COLORING_H
#define SPHCLOTH_CORE_PBD_COLORING_H

#include <array>
#include <cstddef>
#include <vector>

namespace sphcloth {

template <std::size_t N>
std::vector<int> color_constraints(const std::vector<std::array<int, N>> &constraints,
                                   int n_vertices, int &n_colors)
{
  std::vector<std::vector<bool>> used(n_vertices);    // used[v][c]: v is in a constraint of color c
  std::vector<int> color(constraints.size());
  n_colors = 0;
  const auto taken = [&](const std::array<int, N> &vertices, std::size_t c) {
    for (int v : vertices)
      if (c < used[v].size() && used[v][c]) return true;
    return false;
  };
  for (std::size_t m = 0; m < constraints.size(); m++) {
    std::size_t c = 0;
    while (taken(constraints[m], c)) c++;
    for (int v : constraints[m]) {
      if (used[v].size() <= c) used[v].resize(c + 1, false);
      used[v][c] = true;
    }
    color[m] = static_cast<int>(c);
    if (color[m] >= n_colors) n_colors = color[m] + 1;
  }
  return color;
}

}    // namespace sphcloth

#endif
