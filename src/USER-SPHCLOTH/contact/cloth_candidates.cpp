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

double ClothCandidates::max_reach(const ContactRules &rules)
{
  return MAX_REACH * rules.thickness;
}

double ClothCandidates::margin() const
{
  const double thickness = mesh.rules.thickness;
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
  const double cutoff = max_reach(mesh.rules) + 2.0 * std::max(margin(), longest_stride);
  pairs.clear();
  vertices_then = mesh.start;
  known = true;
  find_triangles(cutoff);
  find_edges(cutoff);
}

void ClothCandidates::find_triangles(double cutoff)
{
  discs.build(mesh, cutoff, [](std::size_t) { return 0.0; });
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    const std::size_t begin = pairs.size();
    discs.grid.within(mesh.start[s], cutoff, [&](int t) {
      const auto &[a, b, c] = mesh.triangles[t];
      if (s == a || s == b || s == c) return;
      add(PairKind::POINT_TRIANGLE, {s, a, b, c}, {-1, t}, cutoff);
    });
    std::sort(pairs.begin() + begin, pairs.end(),    // whatever the order of cells
              [](const ClothPair &p, const ClothPair &q) { return p.members[1] < q.members[1]; });
  }
}

void ClothCandidates::find_edges(double cutoff)
{
  boxes.resize(edges.edges.size());
  for (std::size_t e = 0; e < boxes.size(); e++) {
    const auto &[a, b] = edges.edges[e];
    boxes[e] = Box(mesh.start[a]);
    boxes[e].extend(mesh.start[b]);
  }
  grid.build(boxes);
  for (int e = 0; e < static_cast<int>(boxes.size()); e++) {
    if (mesh.halo.is_ghost(edges.vertex_of_lowest(e))) continue;
    const auto &[p, q] = edges.edges[e];
    const std::size_t begin = pairs.size();
    Box near = boxes[e];
    near.min().array() -= cutoff;
    near.max().array() += cutoff;
    grid.query(near, [&](int other) {
      if (edges.lowest[other] < edges.lowest[e] || !boxes[other].intersects(near)) return;
      const auto &[a, b] = edges.edges[other];
      if (p == a || p == b || q == a || q == b) return;
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
  bool joined = false;
  for (int first = 0; first < first_side(kind); first++)
    for (int second = first_side(kind); second < 4; second++)
      joined = joined ||
          ((mesh.start[slots[first]] - mesh.start[slots[second]]).norm() < mesh.rules.thickness &&
           edges.joined(slots[first], slots[second]));
  pairs.push_back({kind, slots, members, joined, distance});
}

double ClothCandidates::memory_usage() const
{
  return discs.bytes() + grid.bytes() + bytes_of(pairs, vertices_then, stride, path, boxes);
}
