// SPDX-License-Identifier: GPL-2.0-or-later
// Finds pairs of a cloth that are near, with a margin.

#include "contact/cloth_candidates.h"

#include "core/util/bytes.h"
#include "neighbor.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

// of the thickness
static constexpr double MIN_MARGIN = 0.75, MAX_MARGIN = 1.0, MAX_REACH = 1.5;

// of the margin: to which more patches are near
static constexpr double PATCH_MARGIN = 10.0;

double ClothCandidates::max_reach() const { return MAX_REACH * rules.max_thickness(); }

double ClothCandidates::margin() const
{
  const double thickness = rules.max_thickness();
  return thickness * std::clamp(0.5 * neighbor->skin / thickness, MIN_MARGIN, MAX_MARGIN);
}

void ClothCandidates::update(double max_approach)
{
  if (none()) return;
  limit = max_approach;
  updates++;
  const bool known = revision == edges.revision();
  if (known) measure();
  if (!known || patches.approach_of_any(limit) > range - max_reach()) start_anew(known);
  for (PatchPair &both : near)
    if (!holds(both)) find(both);
  if (2 * unused > pairs.size()) drop_unused();
}

// Those of a list that may have come near since they were measured: triangles are in front of
// edges.

void ClothCandidates::measure_centers(const PatchPair &both, double reach, double path)
{
  measured.resize(both.end - both.begin);
  int n = 0;
  for (int p = both.begin; p < both.end; p++) {
    measured[n] = p;
    n += !distances[p].is_beyond(reach, path);
  }
  measured.resize(n);
  measured_slots.assign(whole_groups(n) + LANES, {0, 0, 0, 0});
  at_least.resize(measured_slots.size());
  for (int k = 0; k < n; k++) measured_slots[k] = pairs[measured[k]].slots;
  const auto edge = std::partition_point(measured.begin(), measured.end(), [this](int p) {
    return pairs[p].kind == PairKind::POINT_TRIANGLE;
  });
  const int n_triangles = static_cast<int>(edge - measured.begin());
  const auto measure = [this](PairKind kind, int first, int end) {
    center_distances.measure(kind, &measured_slots[first], end - first, &at_least[first]);
  };
  measure(PairKind::POINT_TRIANGLE, 0, n_triangles);
  measure(PairKind::EDGE_EDGE, n_triangles, n);
}

double ClothCandidates::nearest_of(const PatchPair &both) const
{
  float nearest = std::numeric_limits<float>::infinity();
  for (int p = both.begin; p < both.end; p++) nearest = std::min(nearest, distances[p].last);
  return nearest;
}

void ClothCandidates::measure()
{
  patches.measure(mesh.start, mesh.end);
  for (PatchPair &both : near) {
    both.path += patches.approach_since(both.patches[0], both.patches[1]);
    measure(both);
  }
}

// How both have moved as one body is taken out only where the path alone would end the list.

void ClothCandidates::measure(PatchPair &both) const
{
  const auto &[p, q] = both.patches;
  both.in_step = std::min(limit, patches.approach_in_step(p, q));
  both.approach = both.path + both.in_step;
  if (!holds(both) && both.carried < both.path)
    both.approach =
        std::min(both.path, both.carried + patches.approach_before(p, q)) + both.in_step;
}

// Pairs that were not in a list were farther apart than what it covers.

bool ClothCandidates::holds(const PatchPair &both) const
{
  return !(both.approach > both.covered - max_reach());
}

// Patches start from where they are.

void ClothCandidates::start_anew(bool known)
{
  near_before.clear();
  if (known) {
    for (PatchPair &both : near) {
      const double before = patches.approach_before(both.patches[0], both.patches[1]);
      both.carried = std::min(both.path, both.carried + before);
    }
    std::swap(near, near_before);
    patches.start_from(mesh.start);
  } else {
    revision = edges.revision();
    patches.build(mesh.triangles, mesh.start);
    sort_members();
  }
  patches.measure(mesh.start, mesh.end);
  range = max_reach() + std::max(PATCH_MARGIN * margin(), patches.approach_of_any(limit));
  find_near();
  for (PatchPair &both : near) keep(both);
  drop_unused();
}

void ClothCandidates::find_near()
{
  near.clear();
  boxes.clear();
  for (int p = 0; p < patches.size(); p++) boxes.push_back(patches.box(p, mesh.start));
  grid.build(boxes);
  for (int p = 0; p < patches.size(); p++) {
    const std::size_t first = near.size();
    Box around = boxes[p];
    around.min().array() -= range;
    around.max().array() += range;
    grid.query(around, [&](int q) {
      if (q < p || !meet(p, q) || !boxes[q].intersects(around)) return;
      PatchPair both;
      both.patches = {p, q};
      near.push_back(both);
    });
    std::sort(near.begin() + static_cast<std::ptrdiff_t>(first), near.end());
  }
}

// do cloth and obstacles of two patches meet at all?

bool ClothCandidates::meet(int p, int q) const
{
  const bool first = edges.is_obstacle(patches.members[patches.first_member[p]]),
             second = edges.is_obstacle(patches.members[patches.first_member[q]]);
  return first != second || (!first && rules.cloth_meets_cloth);
}

// a list of before

void ClothCandidates::keep(PatchPair &both) const
{
  const auto before = std::lower_bound(near_before.begin(), near_before.end(), both);
  if (before != near_before.end() && before->patches == both.patches) both = *before;
  measure(both);
}

void ClothCandidates::drop_unused()
{
  std::swap(pairs, pairs_before);
  std::swap(distances, distances_before);
  pairs.clear();
  distances.clear();
  for (PatchPair &both : near) {
    const int begin = static_cast<int>(pairs.size());
    pairs.insert(pairs.end(), pairs_before.begin() + both.begin, pairs_before.begin() + both.end);
    distances.insert(distances.end(), distances_before.begin() + both.begin,
                     distances_before.begin() + both.end);
    both.begin = begin;
    both.end = static_cast<int>(pairs.size());
  }
  unused = 0;
}

// Empty where both patches are far enough from one another.  Pairs are measured when they are
// visited.

void ClothCandidates::find(PatchPair &both)
{
  const auto &[p, q] = both.patches;
  prepare(p);
  prepare(q);
  unused += both.end - both.begin;
  const double apart = boxes[p].exteriorDistance(boxes[q]);
  cutoff = max_reach() + std::max(2.0 * margin(), both.in_step);
  both.path = both.nearest = 0.0;
  both.carried = std::numeric_limits<double>::infinity();
  both.approach = both.in_step;
  both.covered = std::max(apart, cutoff);
  both.begin = both.end = static_cast<int>(pairs.size());
  if (apart > cutoff) return;
  find_triangles(p, q);
  if (p != q) find_triangles(q, p);
  find_edges(p, q);
  both.end = static_cast<int>(pairs.size());
  distances.resize(pairs.size());
}

// of patches

void ClothCandidates::sort_members()
{
  sort_into_buckets(
      patches.size(),
      [this](auto add) {
        for (std::size_t t = 0; t < mesh.triangles.size(); t++)
          add(patches.patch_of(mesh.triangles[t][0]), static_cast<int>(t));
      },
      first_triangle, triangles_of);
  sort_into_buckets(
      patches.size(),
      [this](auto add) {
        for (std::size_t e = 0; e < edges.edges.size(); e++)
          add(patches.patch_of(edges.edges[e][0]), static_cast<int>(e));
      },
      first_edge, edges_of);
  triangle_columns.resize(triangles_of.size());
  edge_columns.resize(edges_of.size());
  prepared.assign(patches.size(), 0);
}

// where its triangles and edges are now

void ClothCandidates::prepare(int p)
{
  if (prepared[p] == updates) return;
  prepared[p] = updates;
  boxes[p] = patches.box(p, mesh.start);
  for (int n = first_triangle[p]; n < first_triangle[p + 1]; n++) {
    const auto &[a, b, c] = mesh.triangles[triangles_of[n]];
    triangle_columns.set(n, mesh.start[a], mesh.start[b], mesh.start[c]);
  }
  for (int n = first_edge[p]; n < first_edge[p + 1]; n++) {
    const auto &[a, b] = edges.edges[edges_of[n]];
    edge_columns.set(n, mesh.start[a], mesh.start[b]);
  }
}

// vertices of a patch with triangles of this or another one

void ClothCandidates::find_triangles(int p, int q)
{
  const double cutoff_sq = cutoff * cutoff;
  for (int m = patches.first_member[p]; m < patches.first_member[p + 1]; m++) {
    const int s = patches.members[m];
    if (mesh.halo.is_ghost(s) || boxes[q].squaredExteriorDistance(mesh.start[s]) > cutoff_sq)
      continue;
    triangle_columns.within(first_triangle[q], first_triangle[q + 1], mesh.start[s], cutoff,
                            [&](int n) {
                              const int t = triangles_of[n];
                              const auto &[a, b, c] = mesh.triangles[t];
                              if (s == a || s == b || s == c) return;
                              add(PairKind::POINT_TRIANGLE, {s, a, b, c}, {-1, t});
                            });
  }
}

void ClothCandidates::find_edges(int p, int q)
{
  for (int m = first_edge[p]; m < first_edge[p + 1]; m++) {
    const double reach = edge_columns.radius(m) + cutoff;
    if (boxes[q].squaredExteriorDistance(edge_columns.center(m)) > reach * reach) continue;
    const int begin = p == q ? m + 1 : first_edge[q];
    edge_columns.within(begin, first_edge[q + 1], m, cutoff, [&](int n) {
      int e = edges_of[m], other = edges_of[n];
      if (!orient(e, other)) return;
      const auto &[i, j] = edges.edges[e];
      const auto &[a, b] = edges.edges[other];
      if (i == a || i == b || j == a || j == b) return;
      add(PairKind::EDGE_EDGE, {i, j, a, b}, {e, other});
    });
  }
}

// First the edge of cloth, or the one with the lowest ID.  False: another rank looks after them.

bool ClothCandidates::orient(int &e, int &other) const
{
  const bool first = edges.is_obstacle(edges.edges[e][0]),
             second = edges.is_obstacle(edges.edges[other][0]);
  if (first != second ? first : edges.lowest[other] < edges.lowest[e]) std::swap(e, other);
  return !mesh.halo.is_ghost(edges.vertex_of_lowest(e));
}

void ClothCandidates::add(PairKind kind, const std::array<int, 4> &slots,
                          const std::array<int, 2> &members)
{
  const Meeting meeting = edges.is_obstacle(slots[0]) == edges.is_obstacle(slots[3])
      ? Meeting::CLOTH_CLOTH
      : Meeting::CLOTH_OBSTACLE;
  pairs.push_back({kind, slots, members, meeting});
}

bool ClothCandidates::are_joined(const ContactPair &pair, double distance) const
{
  const double thickness = rules.cloth.thickness;
  if (distance >= thickness) return false;
  for (int k = 0; k < first_side(pair.kind); k++)
    for (int l = first_side(pair.kind); l < 4; l++)
      if ((mesh.start[pair.slots[k]] - mesh.start[pair.slots[l]]).norm() < thickness &&
          edges.joined(pair.slots[k], pair.slots[l]))
        return true;
  return false;
}

double ClothCandidates::memory_usage() const
{
  return patches.bytes() + center_distances.bytes() + grid.bytes() + triangle_columns.bytes() +
      edge_columns.bytes() +
      bytes_of(measured, measured_slots, at_least, pairs, pairs_before, distances, distances_before,
               near, near_before, boxes, prepared, first_triangle, triangles_of, first_edge,
               edges_of);
}
