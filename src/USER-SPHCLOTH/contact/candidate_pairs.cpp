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

void CandidatePairs::clear()
{
  candidates.clear();
  vertices_then.clear();
  positions_then[0].clear();
}

void CandidatePairs::update(double max_stride)
{
  if (none()) return;
  const bool holds = still_holds(max_stride);
  if (holds && candidates.empty()) return;
  measure_strides(max_stride);
  if (!holds) find();
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
  for (std::size_t s = 0; s < path.size(); s++)
    path[s] = stride[s] + (mesh.start[s] - vertices_then[s]).norm();
}

// How far vertices and particles may move before the list is made anew: as far as until the next
// list build, when it is in any case, but not so far that there are too many candidates.

double CandidatePairs::margin() const
{
  const double thickness = mesh.rules.thickness;
  return thickness * std::clamp(0.5 * neighbor->skin / thickness, 1.0, MAX_MARGIN);
}

void CandidatePairs::find()
{
  const double cutoff = max_reach() + 2.0 * margin();
  candidates.clear();
  discs.build(mesh, cutoff, [this](std::size_t t) {
    const auto &[a, b, c] = mesh.triangles[t];
    return std::max({stride[a], stride[b], stride[c]});
  });
  vertices_then.assign(mesh.start.begin(), mesh.start.begin() + mesh.halo.n_slots());
  for (int d = 0; d < 3; d++) {
    const double *last = mesh.last_positions[d];
    positions_then[d].assign(last, last + atom->nlocal);
  }
  for (int i = 0; i < atom->nlocal; i++) {
    if (!mesh.collides(i)) continue;
    const Sweep particle = mesh.sweep_of(i);
    const std::size_t first = candidates.size();
    discs.grid.within(particle.start, cutoff + (particle.end - particle.start).norm(), [&](int t) {
      if (mesh.lets_through(t, atom->mask[i])) return;
      candidates.push_back({i, t, mesh.closest_at_start(particle.start, t).vector.norm()});
    });
    std::sort(candidates.begin() + first, candidates.end(),    // whatever the order of cells
              [](const Candidate &a, const Candidate &b) { return a.triangle < b.triangle; });
  }
}

// Does the list hold all pairs that may collide in this step?

bool CandidatePairs::still_holds(double max_stride) const
{
  if (positions_then[0].size() != static_cast<std::size_t>(atom->nlocal) ||
      vertices_then.size() != static_cast<std::size_t>(mesh.halo.n_slots()))
    return false;
  return std::max(longest_path_of_vertices(max_stride), longest_path()) <= margin();
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

// The same of a particle that collides with this mesh.  All particles, twice in each step: one loop
// without branches.

double CandidatePairs::longest_path() const
{
  const int n = atom->nlocal, groupbits = mesh.groupbits, *const mask = atom->mask;
  if (n == 0) return 0.0;
  const ParticleColumns &last = mesh.last_positions;
  const double *const x = atom->x[0];
  const double *const x0 = last[0], *const y0 = last[1], *const z0 = last[2];
  const double *const x1 = positions_then[0].data(), *const y1 = positions_then[1].data(),
                      *const z1 = positions_then[2].data();
  double step_sq = 0.0, before_sq = 0.0;
#pragma omp simd reduction(max : step_sq, before_sq)
  for (int i = 0; i < n; i++) {
    const double dx = x[3 * i] - x0[i], dy = x[3 * i + 1] - y0[i], dz = x[3 * i + 2] - z0[i];
    const double ex = x0[i] - x1[i], ey = y0[i] - y1[i], ez = z0[i] - z1[i];
    const bool meets = (mask[i] & groupbits) != 0;
    step_sq = std::max(step_sq, meets ? dx * dx + dy * dy + dz * dz : 0.0);
    before_sq = std::max(before_sq, meets ? ex * ex + ey * ey + ez * ez : 0.0);
  }
  return std::sqrt(step_sq) + std::sqrt(before_sq);
}

double CandidatePairs::memory_usage() const
{
  return discs.bytes() +
      bytes_of(candidates, positions_then[0], positions_then[1], positions_then[2], vertices_then,
               stride, path);
}
