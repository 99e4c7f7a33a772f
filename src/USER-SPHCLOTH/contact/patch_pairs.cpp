// SPDX-License-Identifier: GPL-2.0-or-later
// Sorts vertices into patches by a grid, and bounds their motion.

#include "contact/patch_pairs.h"

#include "core/util/bytes.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

// of a patch, in mean edges
static constexpr double SIZE = 4.0;

void PatchPairs::build(const std::vector<std::array<int, 3>> &triangles,
                       const std::vector<Vec3> &positions, double max_distance)
{
  then = positions;
  assign_patches(triangles);
  find_members(triangles);
  find_near(max_distance);
}

void PatchPairs::assign_patches(const std::vector<std::array<int, 3>> &triangles)
{
  Box bounds;
  for (const Vec3 &x : then) bounds.extend(x);
  double mean = 0.0;
  for (const auto &[a, b, c] : triangles) mean += (then[b] - then[a]).norm();
  mean /= static_cast<double>(std::max<std::size_t>(1, triangles.size()));
  CellGrid cells;
  patch.resize(then.size());
  std::vector<int> number;    // of cells that are not empty
  if (!then.empty()) {
    cells.cut(bounds, Vec3::Constant(SIZE * mean), then.size());
    number.assign(cells.size(), -1);
  }
  int n = 0;
  for (std::size_t s = 0; s < then.size(); s++) {
    const CellGrid::Cell c = cells.of(then[s]);
    int &cell = number[cells.number(c[0], c[1], c[2])];
    if (cell < 0) cell = n++;
    patch[s] = cell;
  }
  boxes.assign(n, Box());
}

void PatchPairs::find_members(const std::vector<std::array<int, 3>> &triangles)
{
  sort_into_buckets(
      boxes.size(),
      [this](auto add) {
        for (std::size_t s = 0; s < patch.size(); s++) add(patch[s], static_cast<int>(s));
      },
      member_first, members);
  sort_into_buckets(
      boxes.size(),
      [&](auto add) {
        for (const std::array<int, 3> &t : triangles)
          for (const int s : t)
            for (const int other : t)
              if (patch[other] != patch[s]) add(patch[s], other);
      },
      foreign_first, foreign);
  for (int p = 0; p < n_patches(); p++) {
    for (int n = member_first[p]; n < member_first[p + 1]; n++) boxes[p].extend(then[members[n]]);
    for (int n = foreign_first[p]; n < foreign_first[p + 1]; n++) boxes[p].extend(then[foreign[n]]);
  }
}

void PatchPairs::find_near(double max_distance)
{
  near.clear();
  near_first.clear();
  grid.build(boxes);
  for (int p = 0; p < n_patches(); p++) {
    near_first.push_back(size());
    Box around = boxes[p];
    around.min().array() -= max_distance;
    around.max().array() += max_distance;
    grid.query(around, [&](int q) {
      if (q >= p && boxes[q].intersects(around)) near.push_back({p, q});
    });
    std::sort(near.begin() + near_first[p], near.end());
  }
  near_first.push_back(size());
  bound.resize(near.size());
  apart.resize(near.size());
  for (int k = 0; k < size(); k++) apart[k] = boxes[near[k][0]].exteriorDistance(boxes[near[k][1]]);
}

int PatchPairs::pair_of(int vertex, int other) const
{
  const std::array<int, 2> sought{std::min(patch[vertex], patch[other]),
                                  std::max(patch[vertex], patch[other])};
  const auto begin = near.begin() + near_first[sought[0]],
             end = near.begin() + near_first[sought[0] + 1];
  const auto found = std::lower_bound(begin, end, sought);
  return found != end && *found == sought ? static_cast<int>(found - near.begin()) : -1;
}

template <class Displacement>
void PatchPairs::measure(std::vector<Motion> &motions, Displacement displacement) const
{
  motions.resize(boxes.size());
  for (int p = 0; p < n_patches(); p++) {
    Motion &motion = motions[p];
    motion.mean.setZero();
    for (int n = member_first[p]; n < member_first[p + 1]; n++)
      motion.mean += displacement(members[n]);
    motion.mean /= static_cast<double>(member_first[p + 1] - member_first[p]);
    double max_sq = 0.0;
    for (int n = member_first[p]; n < member_first[p + 1]; n++)
      max_sq = std::max(max_sq, (displacement(members[n]) - motion.mean).squaredNorm());
    for (int n = foreign_first[p]; n < foreign_first[p + 1]; n++)
      max_sq = std::max(max_sq, (displacement(foreign[n]) - motion.mean).squaredNorm());
    motion.radius = std::sqrt(max_sq);
  }
}

void PatchPairs::measure(const std::vector<Vec3> &start, const std::vector<Vec3> &end, double limit)
{
  measure(moved, [&](int s) -> Vec3 { return start[s] - then[s]; });
  measure(moves, [&](int s) -> Vec3 { return end[s] - start[s]; });
  for (int k = 0; k < size(); k++) {
    const auto &[p, q] = near[k];
    const double before =
        (moved[p].mean - moved[q].mean).norm() + moved[p].radius + moved[q].radius;
    const double now = (moves[p].mean - moves[q].mean).norm() + moves[p].radius + moves[q].radius;
    bound[k] = before + std::min(now, limit);
  }

  Vec3 all_moved = Vec3::Zero(), all_move = Vec3::Zero();
  for (int p = 0; p < n_patches(); p++) {
    all_moved += moved[p].mean / n_patches();
    all_move += moves[p].mean / n_patches();
  }
  double longest = 0.0;
  for (int p = 0; p < n_patches(); p++) {
    const double stride = std::min((moves[p].mean - all_move).norm() + moves[p].radius, limit);
    longest = std::max(longest, (moved[p].mean - all_moved).norm() + moved[p].radius + stride);
  }
  bound_of_others = 2.0 * longest;
}

double PatchPairs::bytes() const
{
  return grid.bytes() +
      bytes_of(then, patch, member_first, members, foreign_first, foreign, boxes, near, near_first,
               moved, moves, bound, apart);
}
