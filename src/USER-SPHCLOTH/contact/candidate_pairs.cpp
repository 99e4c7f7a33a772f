// SPDX-License-Identifier: GPL-2.0-or-later
// Finds triangles that are near particles, with a margin.

#include "contact/candidate_pairs.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

// of the thickness
static constexpr double MAX_MARGIN = 1.5, MAX_REACH = 1.5;

static constexpr double NOT_ASKED = -1.0;    // room of a particle without candidates yet

void CandidatePairs::clear()
{
  candidates.clear();
  vertices_then.clear();
  room.clear();
}

void CandidatePairs::update(double max_stride)
{
  if (none()) return;
  const bool holds = triangles_hold(max_stride);
  const bool all_hold = holds && others_hold();
  asked.clear();
  if (!holds) {
    for (int i = 0; i < atom->nlocal; i++)
      if (mesh.collides(i)) asked.push_back(i);
  } else if (all_hold) {
    for (const int i : near)
      if (is_beyond_room(i)) asked.push_back(i);
    if (asked.empty() && candidates.empty()) return;
  } else {
    for (int i = 0; i < atom->nlocal; i++)
      if (room[i] >= room_of_others() || is_beyond_room(i)) asked.push_back(i);
  }
  measure_strides(max_stride);
  if (!holds) sort_triangles();
  if (!asked.empty()) find();
  if (!all_hold) find_near();
  measure_paths();
}

double CandidatePairs::max_reach() const { return MAX_REACH * mesh.rules.thickness; }

void CandidatePairs::measure_strides(double max_stride)
{
  stride.resize(static_cast<std::size_t>(mesh.halo.n_slots()));
  for (std::size_t s = 0; s < stride.size(); s++)
    stride[s] = std::min((mesh.end[s] - mesh.start[s]).norm(), max_stride);
}

void CandidatePairs::measure_paths()
{
  path.resize(stride.size());
  for (std::size_t s = 0; s < path.size(); s++) path[s] = (mesh.start[s] - vertices_then[s]).norm();
}

// How far vertices, and particles near them, may move before the list is made anew: as far as until
// the next list build, when it is in any case, but not so far that there are too many candidates.

double CandidatePairs::margin() const
{
  const double thickness = mesh.rules.thickness;
  return thickness * std::clamp(0.5 * neighbor->skin / thickness, 1.0, MAX_MARGIN);
}

// at the start of the step, without any candidate

void CandidatePairs::sort_triangles()
{
  candidates.clear();
  discs.build(mesh, max_reach() + 2.0 * margin(), [this](std::size_t t) {
    const auto &[a, b, c] = mesh.triangles[t];
    return std::max({stride[a], stride[b], stride[c]});
  });
  vertices_then.assign(mesh.start.begin(), mesh.start.begin() + mesh.halo.n_slots());
  for (int d = 0; d < 3; d++) positions_then[d].resize(atom->nlocal);
  room.assign(atom->nlocal, NOT_ASKED);
}

// of those that are asked for, in the places of what they had

void CandidatePairs::find()
{
  merged.clear();
  auto old = candidates.begin();
  for (const int i : asked) {
    while (old != candidates.end() && old->particle < i) merged.push_back(*old++);
    while (old != candidates.end() && old->particle == i) ++old;
    find_of(i);
  }
  merged.insert(merged.end(), old, candidates.end());
  std::swap(candidates, merged);
}

// Triangles move by the margin, too, before they are sorted anew.  A particle far from all of them
// has more room.

void CandidatePairs::find_of(int i)
{
  const Sweep particle = mesh.sweep_of(i);
  const double cutoff = max_reach() + 2.0 * margin(),
               distance = discs.grid.min_distance(particle.start);
  for (int d = 0; d < 3; d++) positions_then[d][i] = particle.start[d];
  room[i] = std::max(margin(), distance - max_reach() - margin());
  if (distance > cutoff + (particle.end - particle.start).norm()) return;
  const std::size_t first = merged.size();
  discs.grid.within(particle.start, cutoff + (particle.end - particle.start).norm(), [&](int t) {
    if (mesh.lets_through(t, atom->mask[i])) return;
    const auto &[a, b, c] = mesh.triangles[t];
    const FourPoints then{particle.start, vertices_then[a], vertices_then[b], vertices_then[c]};
    merged.push_back({i, t, distance_along_centers(PairKind::POINT_TRIANGLE, then)});
  });
  std::sort(merged.begin() + first, merged.end(),    // whatever the order of cells
            [](const Candidate &a, const Candidate &b) { return a.triangle < b.triangle; });
}

// Does the list hold all triangles that particles within their room may meet in this step?

bool CandidatePairs::triangles_hold(double max_stride) const
{
  return room.size() == static_cast<std::size_t>(atom->nlocal) &&
      vertices_then.size() == static_cast<std::size_t>(mesh.halo.n_slots()) &&
      longest_path_of_vertices(max_stride) <= margin();
}

// Of a vertex, since the list was made, with this step: at most

double CandidatePairs::longest_path_of_vertices(double max_stride) const
{
  double max_stride_sq = 0.0, max_before_sq = 0.0;
  for (std::size_t s = 0; s < vertices_then.size(); s++) {
    max_stride_sq = std::max(max_stride_sq, (mesh.end[s] - mesh.start[s]).squaredNorm());
    max_before_sq = std::max(max_before_sq, (mesh.start[s] - vertices_then[s]).squaredNorm());
  }
  return std::min(std::sqrt(max_stride_sq), max_stride) + std::sqrt(max_before_sq);
}

// about as far as atoms come until the next list build

double CandidatePairs::room_of_others() const { return std::max(2.0 * margin(), neighbor->skin); }

// of which all others have been asked for in this step

void CandidatePairs::find_near()
{
  const double limit = room_of_others();
  near.clear();
  for (int i = 0; i < atom->nlocal; i++)
    if (room[i] < limit) near.push_back(i);
  path_then = mesh.step_start.longest_path();
}

// Those that are not near share a room.

bool CandidatePairs::others_hold() const
{
  StepStart &start = mesh.step_start;
  if (near.size() == static_cast<std::size_t>(atom->nlocal)) return true;
  return start.longest_path() - path_then + start.longest_sweep() <= room_of_others();
}

bool CandidatePairs::is_beyond_room(int i) const
{
  if (!mesh.collides(i)) return false;
  const Sweep particle = mesh.sweep_of(i);
  const double moved =
      (particle.end - particle.start).norm() + (particle.start - position_then(i)).norm();
  return !(moved <= room[i]);
}

double CandidatePairs::memory_usage() const
{
  return discs.bytes() +
      bytes_of(candidates, merged, positions_then[0], positions_then[1], positions_then[2],
               vertices_then, stride, path, room, near, asked);
}
