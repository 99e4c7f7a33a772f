// SPDX-License-Identifier: GPL-2.0-or-later
// Triangles are turned from neighbor to neighbor over their common edges.

#include "core/geometry/oriented_surface.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

namespace sphcloth {

// from its lower vertex to its higher one, or backward

struct OrientedSurface::Side {
  int low, high, triangle;
  bool backward;
  bool same_edge(const Side &other) const { return low == other.low && high == other.high; }
};

static std::array<int, 3> sorted(std::array<int, 3> t)
{
  std::sort(t.begin(), t.end());
  return t;
}

static void turn(std::array<int, 3> &t) { std::swap(t[1], t[2]); }

OrientedSurface::OrientedSurface(std::vector<std::array<int, 3>> all) : triangles(std::move(all))
{
  for (auto &t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end(), [](const auto &a, const auto &b) {
    return std::make_pair(sorted(a), a) < std::make_pair(sorted(b), b);
  });
  const auto same = [](const auto &a, const auto &b) { return sorted(a) == sorted(b); };
  triangles.erase(std::unique(triangles.begin(), triangles.end(), same), triangles.end());
  const std::vector<Side> edges = sides();
  find_parts(edges);
  if (flaw == Flaw::NONE) find_holes(edges);
}

bool OrientedSurface::is_closed(int of_part) const
{
  return std::none_of(holes.begin(), holes.end(),
                      [of_part](const Hole &hole) { return hole.part == of_part; });
}

// those of an edge behind one another

std::vector<OrientedSurface::Side> OrientedSurface::sides() const
{
  std::vector<Side> all;
  for (std::size_t m = 0; m < triangles.size(); m++)
    for (int k = 0; k < 3; k++) {
      const int a = triangles[m][k], b = triangles[m][(k + 1) % 3];
      all.push_back({std::min(a, b), std::max(a, b), static_cast<int>(m), a > b});
    }
  std::sort(all.begin(), all.end(), [](const Side &a, const Side &b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return all;
}

void OrientedSurface::set_flaw(Flaw of, const Side &at)
{
  if (flaw != Flaw::NONE) return;
  flaw = of;
  flawed_edge = {at.low, at.high};
}

void OrientedSurface::find_parts(const std::vector<Side> &all)
{
  struct Link {
    int triangle;
    bool turned;    // the two run alike along their edge
    const Side *at;
  };
  std::vector<std::vector<Link>> links(triangles.size());
  for (std::size_t k = 0; k + 1 < all.size(); k++) {
    const Side &a = all[k], &b = all[k + 1];
    if (!a.same_edge(b)) continue;
    if (k + 2 < all.size() && a.same_edge(all[k + 2])) set_flaw(Flaw::BRANCHED, a);
    links[a.triangle].push_back({b.triangle, a.backward == b.backward, &a});
    links[b.triangle].push_back({a.triangle, a.backward == b.backward, &a});
  }

  part.assign(triangles.size(), -1);
  std::vector<char> turned(triangles.size(), 0);
  for (std::size_t m = 0; m < triangles.size(); m++) {
    if (part[m] >= 0) continue;
    const int p = parts();
    first.push_back(triangles[m][0]);
    std::vector<int> found{static_cast<int>(m)};
    part[m] = p;
    std::size_t n_turned = 0;
    for (std::size_t k = 0; k < found.size(); k++)
      for (const Link &link : links[found[k]]) {
        const char wanted = static_cast<char>((turned[found[k]] != 0) != link.turned);
        if (part[link.triangle] < 0) {
          part[link.triangle] = p;
          turned[link.triangle] = wanted;
          n_turned += wanted;
          found.push_back(link.triangle);
        } else if (turned[link.triangle] != wanted)
          set_flaw(Flaw::ONE_SIDED, *link.at);
      }
    const char majority = 2 * n_turned > found.size() ? 1 : 0;
    for (const int t : found)
      if (turned[t] != majority) turn(triangles[t]);
  }
}

// At a vertex where two holes meet, either way on is one.

void OrientedSurface::find_holes(const std::vector<Side> &all)
{
  std::multimap<std::pair<int, int>, int> next;    // of a part's vertex, along its bounding edges
  for (std::size_t k = 0; k < all.size(); k++) {
    const bool alone = (k == 0 || !all[k].same_edge(all[k - 1])) &&
        (k + 1 == all.size() || !all[k].same_edge(all[k + 1]));
    if (!alone) continue;
    const int m = all[k].triangle;
    const auto &t = triangles[m];
    for (int i = 0; i < 3; i++) {
      const int a = t[i], b = t[(i + 1) % 3];
      if (std::min(a, b) == all[k].low && std::max(a, b) == all[k].high)
        next.insert({{part[m], a}, b});
    }
  }
  while (!next.empty()) {
    Hole hole{next.begin()->first.first, {}};
    int vertex = next.begin()->first.second;
    for (auto it = next.begin(); it != next.end(); it = next.find({hole.part, vertex})) {
      hole.loop.push_back(vertex);
      vertex = it->second;
      next.erase(it);
    }
    holes.push_back(std::move(hole));
  }
}

}    // namespace sphcloth
