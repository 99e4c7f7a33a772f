// SPDX-License-Identifier: GPL-2.0-or-later
// Cuts a mesh into patches, and bounds their motion.

#include "core/contact/mesh_patches.h"

#include "core/geometry/buckets.h"
#include "core/util/bytes.h"

#include <algorithm>
#include <cmath>

using namespace sphcloth;

// vertices of a patch; what is left with fewer than the least joins another one
static constexpr int SIZE = 32, LEAST = 8;

template <class Visit> void MeshPatches::for_vertices(int p, Visit visit) const
{
  for (int n = first_member[p]; n < first_member[p + 1]; n++) visit(members[n]);
  for (int n = first_foreign[p]; n < first_foreign[p + 1]; n++) visit(foreign[n]);
}

void MeshPatches::build(const Triangles &triangles, const std::vector<Vec3> &positions)
{
  assign(triangles, static_cast<int>(positions.size()));
  find_foreign(triangles);
  choose_anchors(positions);
  start_from(positions);
}

namespace {

// Patches grow vertex by vertex along triangles, each from beside the one before: Farhat, Computers
// & Structures 28 (1988) 579.

class Growth {
 public:
  std::vector<int> patch;    // of a vertex
  int n_patches = 0;

  Growth(const MeshPatches::Triangles &triangles_, int n_vertices) :
      patch(n_vertices, NONE), triangles(triangles_)
  {
    sort_into_buckets(
        n_vertices,
        [this](auto add) {
          for (std::size_t t = 0; t < triangles.size(); t++)
            for (const int s : triangles[t]) add(s, static_cast<int>(t));
        },
        first, at);
    for (int seed = next_seed(); seed != NONE; seed = next_seed()) grow(seed);
  }

 private:
  static constexpr int NONE = -1;

  const MeshPatches::Triangles &triangles;
  std::vector<int> first, at;    // triangles of a vertex
  std::vector<int> grown, border;    // of this patch; and of all so far, beside them
  int lowest_free = 0;

  int next_seed()
  {
    while (!border.empty()) {
      const int s = border.back();
      border.pop_back();
      if (patch[s] == NONE) return s;
    }
    const int n = static_cast<int>(patch.size());
    while (lowest_free < n && patch[lowest_free] != NONE) lowest_free++;
    return lowest_free < n ? lowest_free : NONE;
  }

  void grow(int seed)
  {
    int beside = NONE;    // a patch that this one borders on
    grown = {seed};
    patch[seed] = n_patches;
    for (std::size_t k = 0; k < grown.size(); k++)
      for (int m = first[grown[k]]; m < first[grown[k] + 1]; m++)
        for (const int s : triangles[at[m]]) reach(s, beside);
    if (beside == NONE || grown.size() >= LEAST)
      n_patches++;
    else
      for (const int s : grown) patch[s] = beside;
  }

  void reach(int s, int &beside)
  {
    if (patch[s] == n_patches) return;
    if (patch[s] != NONE)
      beside = patch[s];
    else if (grown.size() < SIZE) {
      grown.push_back(s);
      patch[s] = n_patches;
    } else
      border.push_back(s);
  }
};

}    // namespace

void MeshPatches::assign(const Triangles &triangles, int n_vertices)
{
  Growth growth(triangles, n_vertices);
  patch.swap(growth.patch);
  sort_into_buckets(
      growth.n_patches,
      [this](auto add) {
        for (std::size_t s = 0; s < patch.size(); s++) add(patch[s], static_cast<int>(s));
      },
      first_member, members);
}

void MeshPatches::find_foreign(const Triangles &triangles)
{
  sort_into_buckets(
      size(),
      [&](auto add) {
        for (const std::array<int, 3> &t : triangles)
          for (const int s : t)
            for (const int other : t)
              if (patch[other] != patch[s]) add(patch[s], other);
      },
      first_foreign, foreign);
}

// far from one another, and not in a row

void MeshPatches::choose_anchors(const std::vector<Vec3> &positions)
{
  anchors.resize(size());
  for (int p = 0; p < size(); p++) {
    std::array<int, 3> &at = anchors[p];
    at.fill(members[first_member[p]]);
    double farthest = 0.0, highest = 0.0;
    for_vertices(p, [&](int s) {
      const double distance = (positions[s] - positions[at[0]]).squaredNorm();
      if (distance > farthest) at[1] = s;
      farthest = std::max(farthest, distance);
    });
    const Vec3 line = positions[at[1]] - positions[at[0]];
    for_vertices(p, [&](int s) {
      const double height = line.cross(positions[s] - positions[at[0]]).squaredNorm();
      if (height > highest) at[2] = s;
      highest = std::max(highest, height);
    });
  }
}

// any axes that turn with the patch

MeshPatches::Pose MeshPatches::pose_of(int p, const std::vector<Vec3> &positions) const
{
  Pose pose;
  for (int n = first_member[p]; n < first_member[p + 1]; n++) pose.center += positions[members[n]];
  pose.center /= static_cast<double>(first_member[p + 1] - first_member[p]);
  const auto &[a, b, c] = anchors[p];
  const Vec3 along = positions[b] - positions[a], up = along.cross(positions[c] - positions[a]);
  const double length = along.norm(), height = up.norm();
  if (!(height > 0.0)) return pose;
  pose.axes.col(0) = along / length;
  pose.axes.col(1) = up / height;
  pose.axes.col(2) = pose.axes.col(0).cross(pose.axes.col(1));
  return pose;
}

Box MeshPatches::box(int p, const std::vector<Vec3> &positions) const
{
  Box box;
  for_vertices(p, [&](int s) { box.extend(positions[s]); });
  return box;
}

void MeshPatches::start_from(const std::vector<Vec3> &positions)
{
  then = measured = positions;
  poses_then.resize(size());
  extent_then.resize(size());
  for (int p = 0; p < size(); p++) {
    poses_then[p] = pose_of(p, then);
    double extent_sq = 0.0;
    for_vertices(p, [&](int s) {
      extent_sq = std::max(extent_sq, (then[s] - poses_then[p].center).squaredNorm());
    });
    extent_then[p] = std::sqrt(extent_sq);
  }
}

MeshPatches::Motion MeshPatches::motion_of(int p, const std::vector<Vec3> &from,
                                           const std::vector<Vec3> &to) const
{
  Motion move;
  for (int n = first_member[p]; n < first_member[p + 1]; n++)
    move.mean += to[members[n]] - from[members[n]];
  move.mean /= static_cast<double>(first_member[p + 1] - first_member[p]);
  double departed_sq = 0.0;
  for_vertices(p, [&](int s) {
    departed_sq = std::max(departed_sq, (to[s] - from[s] - move.mean).squaredNorm());
  });
  move.radius = std::sqrt(departed_sq);
  return move;
}

void MeshPatches::measure(const std::vector<Vec3> &start, const std::vector<Vec3> &end)
{
  turned.resize(size());
  moves.resize(size());
  moves_since.resize(size());
  for (int p = 0; p < size(); p++) {
    Turned &now = turned[p];
    now.pose = pose_of(p, start);
    now.turn = now.pose.axes * poses_then[p].axes.transpose();
    const Vec3 shift = now.pose.center - now.turn * poses_then[p].center;
    double departed_sq = 0.0;
    for_vertices(p, [&](int s) {
      departed_sq = std::max(departed_sq, (start[s] - now.turn * then[s] - shift).squaredNorm());
    });
    now.radius = std::sqrt(departed_sq);
    moves[p] = motion_of(p, start, end);
    moves_since[p] = motion_of(p, measured, start);
  }
  measured = start;
}

// Of the distance that both would have if they had moved with p as one body.  Where q has turned by
// another angle a, its vertices depart by 2 sin(a/2) of their distance from its center, and the
// Frobenius norm of the difference of both rotations is 2 sqrt(2) sin(a/2).

double MeshPatches::approach_before(int p, int q) const
{
  const Turned &a = turned[p], &b = turned[q];
  if (p == q) return 2.0 * a.radius;
  const Vec3 apart = a.pose.center - b.pose.center,
             apart_then = poses_then[p].center - poses_then[q].center;
  return (apart - a.turn * apart_then).norm() + a.radius + b.radius +
      (a.turn - b.turn).norm() * std::sqrt(0.5) * extent_then[q];
}

double MeshPatches::approach_of_any(double limit) const
{
  Vec3 mean_before = Vec3::Zero(), mean_move = Vec3::Zero();
  for (int p = 0; p < size(); p++) {
    mean_before += (turned[p].pose.center - poses_then[p].center) / size();
    mean_move += moves[p].mean / size();
  }
  double longest = 0.0;
  for (int p = 0; p < size(); p++) {
    const Vec3 before = turned[p].pose.center - poses_then[p].center - mean_before;
    const double turning =
        (turned[p].turn - Eigen::Matrix3d::Identity()).norm() * std::sqrt(0.5) * extent_then[p];
    const double stride = std::min((moves[p].mean - mean_move).norm() + moves[p].radius, limit);
    longest = std::max(longest, before.norm() + turning + turned[p].radius + stride);
  }
  return 2.0 * longest;
}

double MeshPatches::bytes() const
{
  return bytes_of(first_member, members, patch, first_foreign, foreign, anchors, then, poses_then,
                  extent_then, turned, moves, moves_since, measured);
}
