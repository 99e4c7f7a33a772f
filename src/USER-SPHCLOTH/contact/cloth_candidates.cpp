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

// of the margin: a list that has used more of it than this is made anew with others
static constexpr double USED = 0.5;

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
  const bool known = revision == edges.revision();
  if (known) measure();
  if (!known || !all_hold()) start_anew(known);
}

double ClothCandidates::approach_in_step(const PatchPair &both) const
{
  return std::min(limit, patches.approach_in_step(both.patches[0], both.patches[1]));
}

void ClothCandidates::measure()
{
  patches.measure(mesh.start, mesh.end);
  for (PatchPair &both : near)
    both.approach = both.carried + patches.approach_before(both.patches[0], both.patches[1]) +
        approach_in_step(both);
}

// Pairs that are not in a list were farther apart than what it covers.

bool ClothCandidates::holds(const PatchPair &both) const
{
  return !(both.approach > both.covered - max_reach());
}

bool ClothCandidates::all_hold() const
{
  return std::all_of(near.begin(), near.end(), [this](const PatchPair &b) { return holds(b); }) &&
      !(patches.approach_of_any(limit) > range - max_reach());
}

// Patches start from where they are.  Lists that will hold for long are kept.

void ClothCandidates::start_anew(bool known)
{
  pairs_before.clear();
  near_before.clear();
  if (known) {
    for (PatchPair &both : near)
      both.carried += patches.approach_before(both.patches[0], both.patches[1]);
    std::swap(near, near_before);
    std::swap(pairs, pairs_before);
    patches.start_from(mesh.start);
  } else {
    revision = edges.revision();
    patches.build(mesh.triangles, mesh.start);
    sort_members();
  }
  patches.measure(mesh.start, mesh.end);
  range = max_reach() + std::max(PATCH_MARGIN * margin(), patches.approach_of_any(limit));
  find_near();
  pairs.clear();
  fill_columns();
  for (PatchPair &both : near) {
    const double in_step = approach_in_step(both);
    if (!keep(both, in_step)) find(both, in_step);
  }
}

void ClothCandidates::find_near()
{
  near.clear();
  boxes.clear();
  for (int p = 0; p < patches.size(); p++) boxes.push_back(patches.box(p));
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

// A list of before, or none where both patches are far enough from one another.

bool ClothCandidates::keep(PatchPair &both, double in_step)
{
  const double room = 2.0 * margin(),
               apart = boxes[both.patches[0]].exteriorDistance(boxes[both.patches[1]]);
  if (apart > max_reach() + std::max(room, in_step)) {
    both.approach = in_step;
    both.covered = apart;
    return true;
  }
  const auto before = std::lower_bound(near_before.begin(), near_before.end(), both);
  if (before == near_before.end() || before->patches != both.patches) return false;
  PatchPair kept = *before;
  kept.approach = kept.carried + in_step;
  if (kept.carried > USED * room || !holds(kept)) return false;
  kept.begin = static_cast<int>(pairs.size());
  pairs.insert(pairs.end(), pairs_before.begin() + before->begin,
               pairs_before.begin() + before->end);
  kept.end = static_cast<int>(pairs.size());
  both = kept;
  return true;
}

void ClothCandidates::find(PatchPair &both, double in_step)
{
  const auto &[p, q] = both.patches;
  both.approach = in_step;
  both.covered = cutoff = max_reach() + std::max(2.0 * margin(), in_step);
  both.begin = static_cast<int>(pairs.size());
  find_triangles(p, q);
  if (p != q) find_triangles(q, p);
  find_edges(p, q);
  both.end = static_cast<int>(pairs.size());
  for (int n = both.begin; n < both.end; n++)
    both.nearest = std::min(both.nearest, pairs[n].distance);
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
}

void ClothCandidates::fill_columns()
{
  triangle_columns.resize(triangles_of.size());
  for (std::size_t n = 0; n < triangles_of.size(); n++) {
    const auto &[a, b, c] = mesh.triangles[triangles_of[n]];
    triangle_columns.set(static_cast<int>(n), mesh.start[a], mesh.start[b], mesh.start[c]);
  }
  edge_columns.resize(edges_of.size());
  for (std::size_t n = 0; n < edges_of.size(); n++) {
    const Vec3 &a = mesh.start[edges.edges[edges_of[n]][0]],
               &b = mesh.start[edges.edges[edges_of[n]][1]];
    edge_columns.set(static_cast<int>(n), a, b);
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
  const auto &[i, j, k, l] = slots;
  const double distance =
      closest_points(kind, {mesh.start[i], mesh.start[j], mesh.start[k], mesh.start[l]})
          .vector.norm();
  if (distance > cutoff) return;
  const Meeting meeting = edges.is_obstacle(i) == edges.is_obstacle(l) ? Meeting::CLOTH_CLOTH
                                                                       : Meeting::CLOTH_OBSTACLE;
  pairs.push_back({kind, slots, members, meeting,
                   distance < rules.cloth.thickness && are_joined(kind, slots), distance});
}

bool ClothCandidates::are_joined(PairKind kind, const std::array<int, 4> &slots) const
{
  for (int k = 0; k < first_side(kind); k++)
    for (int l = first_side(kind); l < 4; l++)
      if ((mesh.start[slots[k]] - mesh.start[slots[l]]).norm() < rules.cloth.thickness &&
          edges.joined(slots[k], slots[l]))
        return true;
  return false;
}

double ClothCandidates::memory_usage() const
{
  return patches.bytes() + grid.bytes() + triangle_columns.bytes() + edge_columns.bytes() +
      bytes_of(pairs, pairs_before, near, near_before, boxes, first_triangle, triangles_of,
               first_edge, edges_of);
}
