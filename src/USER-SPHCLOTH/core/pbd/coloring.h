// Greedy colouring of constraints: two constraints of one colour share no vertex, so a colour can
// be projected in any order, by any number of ranks, with the same result.
//
// Vertices are numbered 0 .. n_vertices-1 in the order of their global IDs and constraints come
// sorted by them, so the colours depend on the mesh alone.

#ifndef SPHCLOTH_CORE_PBD_COLORING_H
#define SPHCLOTH_CORE_PBD_COLORING_H

#include <array>
#include <cstddef>
#include <vector>

namespace sphcloth {

template <std::size_t N>
std::vector<int> colour_constraints(const std::vector<std::array<int, N>> &constraints,
                                    int n_vertices, int &n_colours)
{
  std::vector<std::vector<bool>> used(
      n_vertices);    // used[v][c]: v is in a constraint of colour c
  std::vector<int> colour(constraints.size());
  n_colours = 0;
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
    colour[m] = static_cast<int>(c);
    if (colour[m] >= n_colours) n_colours = colour[m] + 1;
  }
  return colour;
}

}    // namespace sphcloth

#endif
