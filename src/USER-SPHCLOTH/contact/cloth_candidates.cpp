// SPDX-License-Identifier: GPL-2.0-or-later
// Finds pairs of a cloth that are near, with a margin.

#include "contact/cloth_candidates.h"

#include "core/util/bytes.h"
#include "neighbor.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

// of the thickness
static constexpr double MAX_MARGIN = 1.5, MAX_REACH = 1.5;

void ClothCandidates::clear()
{
  pairs.clear();
  known = false;
}

double ClothCandidates::max_reach() const { return MAX_REACH * rules.max_thickness(); }

double ClothCandidates::margin() const
{
  const double thickness = rules.max_thickness();
  return thickness * std::clamp(0.5 * neighbor->skin / thickness, 1.0, MAX_MARGIN);
}

void ClothCandidates::update(double max_approach)
{
  limit = max_approach;
  measure_strides();
  if (known) measure_paths();
  if (known && longest_path <= margin()) return;
  find();
  measure_paths();
}

// Distances do not change with what all vertices move together.

static Eigen::Vector3d mean_difference(const std::vector<Eigen::Vector3d> &of,
                                       const std::vector<Eigen::Vector3d> &from)
{
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t s = 0; s < of.size(); s++) sum += of[s] - from[s];
  return of.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(of.size()));
}

void ClothCandidates::measure_strides()
{
  const Vec3 together = mean_difference(mesh.end, mesh.start);
  stride.resize(mesh.start.size());
  longest_stride = 0.0;
  for (std::size_t s = 0; s < stride.size(); s++) {
    stride[s] = std::min((stride_of(static_cast<int>(s)) - together).norm(), limit);
    longest_stride = std::max(longest_stride, stride[s]);
  }
}

void ClothCandidates::measure_paths()
{
  const Vec3 together = mean_difference(mesh.start, vertices_then);
  path.resize(stride.size());
  longest_path = 0.0;
  for (std::size_t s = 0; s < path.size(); s++) {
    path[s] = stride[s] + (mesh.start[s] - vertices_then[s] - together).norm();
    longest_path = std::max(longest_path, path[s]);
  }
}

void ClothCandidates::find()
{
  const double cutoff = max_reach() + 2.0 * std::max(margin(), longest_stride);
  pairs.clear();
  vertices_then = mesh.start;
  known = true;
  for (const bool obstacles : {false, true}) find_among(obstacles, cutoff);
}

// obstacles, or cloth

void ClothCandidates::find_among(bool obstacles, double cutoff)
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
  find_triangles(obstacles, cutoff);
  if (obstacles || rules.cloth_meets_cloth) find_edges(obstacles, cutoff);
}

void ClothCandidates::find_triangles(bool obstacles, double cutoff)
{
  disc_grid.build(discs, cutoff);
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    if (edges.is_obstacle(s) ? obstacles : !obstacles && !rules.cloth_meets_cloth) continue;
    const std::size_t begin = pairs.size();
    disc_grid.within(mesh.start[s], cutoff, [&](int n) {
      const int t = triangles_there[n];
      const auto &[a, b, c] = mesh.triangles[t];
      if (s == a || s == b || s == c) return;
      add(PairKind::POINT_TRIANGLE, {s, a, b, c}, {-1, t}, cutoff);
    });
    std::sort(pairs.begin() + begin, pairs.end(),    // whatever the order of cells
              [](const ClothPair &p, const ClothPair &q) { return p.members[1] < q.members[1]; });
  }
}

void ClothCandidates::find_edges(bool obstacles, double cutoff)
{
  box_grid.build(boxes);
  for (int e = 0; e < static_cast<int>(edges.edges.size()); e++) {
    const auto &[p, q] = edges.edges[e];
    if (edges.is_obstacle(p) || mesh.halo.is_ghost(edges.vertex_of_lowest(e))) continue;
    const std::size_t begin = pairs.size();
    Box near(mesh.start[p]);
    near.extend(mesh.start[q]);
    near.min().array() -= cutoff;
    near.max().array() += cutoff;
    box_grid.query(near, [&](int n) {
      const int other = edges_there[n];
      const auto &[a, b] = edges.edges[other];
      if (!obstacles && edges.lowest[other] < edges.lowest[e]) return;
      if (p == a || p == b || q == a || q == b || !boxes[n].intersects(near)) return;
      add(PairKind::EDGE_EDGE, {p, q, a, b}, {e, other}, cutoff);
    });
    std::sort(pairs.begin() + begin, pairs.end(),
              [](const ClothPair &m, const ClothPair &n) { return m.members[1] < n.members[1]; });
  }
}

void ClothCandidates::add(PairKind kind, const std::array<int, 4> &slots,
                          const std::array<int, 2> &members, double cutoff)
{
  const auto &[i, j, k, l] = slots;
  const double distance =
      closest_points(kind, {mesh.start[i], mesh.start[j], mesh.start[k], mesh.start[l]})
          .vector.norm();
  if (distance > cutoff) return;
  const bool with_obstacle = edges.is_obstacle(i) != edges.is_obstacle(l);
  bool joined = false;
  for (int first = 0; first < first_side(kind); first++)
    for (int second = first_side(kind); second < 4; second++)
      joined = joined ||
          ((mesh.start[slots[first]] - mesh.start[slots[second]]).norm() < rules.cloth.thickness &&
           edges.joined(slots[first], slots[second]));
  pairs.push_back({kind, slots, members, with_obstacle, joined, distance});
}

double ClothCandidates::memory_usage() const
{
  return disc_grid.bytes() + box_grid.bytes() +
      bytes_of(pairs, vertices_then, stride, path, triangles_there, edges_there, discs, boxes);
}
