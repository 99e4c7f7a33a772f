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

// of the margin: by which patches of vertices that are not near one another may approach
static constexpr double PATCH_MARGIN = 10.0;

void ClothCandidates::rebuild()
{
  if (tags != edges.all_tags() || triangles != mesh.triangles) known = false;
}

double ClothCandidates::max_reach() const { return MAX_REACH * rules.max_thickness(); }

double ClothCandidates::margin() const
{
  const double thickness = rules.max_thickness();
  return thickness * std::clamp(0.5 * neighbor->skin / thickness, MIN_MARGIN, MAX_MARGIN);
}

void ClothCandidates::update(double max_approach)
{
  limit = max_approach;
  if (known) patches.measure(mesh.start, mesh.end, limit);
  if (known && holds()) return;
  find();
}

// Pairs that are not in the list were farther apart than its cutoff, and than their patches.

bool ClothCandidates::holds() const
{
  for (int k = 0; k < patches.size(); k++)
    if (patches.approach(k) > std::max(cutoff, patches.distance(k)) - max_reach()) return false;
  return patches.approach_of_others() <= patch_range - max_reach();
}

void ClothCandidates::find()
{
  known = true;
  tags = edges.all_tags();
  triangles = mesh.triangles;
  cutoff = max_reach() + 2.0 * margin();
  patch_range = max_reach() + PATCH_MARGIN * margin();
  patches.build(mesh.triangles, mesh.start, patch_range);
  patches.measure(mesh.start, mesh.end, limit);
  if (!holds()) {    // a long step
    patch_range = std::max(patch_range, max_reach() + patches.approach_of_others());
    for (int k = 0; k < patches.size(); k++)
      cutoff = std::max(cutoff, max_reach() + patches.approach(k));
    patch_range = std::max(patch_range, cutoff);
    patches.build(mesh.triangles, mesh.start, patch_range);
    patches.measure(mesh.start, mesh.end, limit);
  }
  pairs.clear();
  patches_of.clear();
  last_patches = {-1, -1};
  for (const bool obstacles : {false, true}) find_among(obstacles);
  sort();
}

// obstacles, or cloth

void ClothCandidates::find_among(bool obstacles)
{
  triangles_there.clear();
  discs.clear();
  for (std::size_t t = 0; t < mesh.triangles.size(); t++) {
    const auto &[a, b, c] = mesh.triangles[t];
    if (edges.is_obstacle(a) != obstacles) continue;
    triangles_there.push_back(static_cast<int>(t));
    discs.push_back(disc_around(mesh.start[a], mesh.start[b], mesh.start[c]));
  }
  edges_there.clear();
  boxes.clear();
  for (std::size_t e = 0; e < edges.edges.size(); e++) {
    const auto &[a, b] = edges.edges[e];
    if (edges.is_obstacle(a) != obstacles) continue;
    edges_there.push_back(static_cast<int>(e));
    boxes.emplace_back(mesh.start[a]);
    boxes.back().extend(mesh.start[b]);
  }
  if (triangles_there.empty()) return;
  find_triangles(obstacles);
  if (obstacles || rules.cloth_meets_cloth) find_edges(obstacles);
}

void ClothCandidates::find_triangles(bool obstacles)
{
  disc_grid.build(discs, cutoff);
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    if (edges.is_obstacle(s) ? obstacles : !obstacles && !rules.cloth_meets_cloth) continue;
    disc_grid.within(mesh.start[s], cutoff, [&](int n) {
      const int t = triangles_there[n];
      const auto &[a, b, c] = mesh.triangles[t];
      if (s == a || s == b || s == c) return;
      add(PairKind::POINT_TRIANGLE, {s, a, b, c}, {-1, t});
    });
  }
}

void ClothCandidates::find_edges(bool obstacles)
{
  box_grid.build(boxes);
  for (int e = 0; e < static_cast<int>(edges.edges.size()); e++) {
    const auto &[p, q] = edges.edges[e];
    if (edges.is_obstacle(p) || mesh.halo.is_ghost(edges.vertex_of_lowest(e))) continue;
    Box near(mesh.start[p]);
    near.extend(mesh.start[q]);
    near.min().array() -= cutoff;
    near.max().array() += cutoff;
    box_grid.query(near, [&](int n) {
      const int other = edges_there[n];
      const auto &[a, b] = edges.edges[other];
      if (!obstacles && edges.lowest[other] < edges.lowest[e]) return;
      if (p == a || p == b || q == a || q == b || !boxes[n].intersects(near)) return;
      add(PairKind::EDGE_EDGE, {p, q, a, b}, {e, other});
    });
  }
}

void ClothCandidates::add(PairKind kind, const std::array<int, 4> &slots,
                          const std::array<int, 2> &members)
{
  const auto &[i, j, k, l] = slots;
  const double distance =
      closest_points(kind, {mesh.start[i], mesh.start[j], mesh.start[k], mesh.start[l]})
          .vector.norm();
  if (distance > cutoff) return;
  const bool with_obstacle = edges.is_obstacle(i) != edges.is_obstacle(l);
  pairs.push_back({kind, slots, members, with_obstacle,
                   distance < rules.cloth.thickness && are_joined(kind, slots), distance});
  const std::array<int, 2> both{patches.patch_of(i), patches.patch_of(l)};
  if (both != last_patches) {
    last_patches = both;
    last_pair = patches.pair_of(i, l);
  }
  patches_of.push_back(last_pair);
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

void ClothCandidates::sort()
{
  sort_into_buckets(
      patches.size(),
      [this](auto add) {
        for (std::size_t n = 0; n < pairs.size(); n++) add(patches_of[n], static_cast<int>(n));
      },
      first, order);
  nearest.assign(patches.size(), std::numeric_limits<double>::infinity());
  for (std::size_t n = 0; n < pairs.size(); n++)
    nearest[patches_of[n]] = std::min(nearest[patches_of[n]], pairs[n].distance);
}

double ClothCandidates::memory_usage() const
{
  return disc_grid.bytes() + box_grid.bytes() + patches.bytes() +
      bytes_of(pairs, tags, triangles, first, order, patches_of, nearest, triangles_there,
               edges_there, discs, boxes);
}
