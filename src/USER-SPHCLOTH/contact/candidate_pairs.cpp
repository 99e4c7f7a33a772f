// SPDX-License-Identifier: GPL-2.0-or-later
// Finds the swept boxes of triangles and particles that overlap, with a margin.

#include "contact/candidate_pairs.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "neighbor.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

// of the thickness
static constexpr double MAX_MARGIN = 1.5;

void CandidatePairs::clear()
{
  positions_then.clear();
  start_then.clear();
}

void CandidatePairs::update()
{
  has_box.assign(mesh.triangles.size(), false);
  boxes.resize(mesh.triangles.size());
  if (!still_holds()) find();
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
  const double cutoff = 2.0 * (mesh.rules.thickness + margin());
  candidates.clear();
  discs.build(mesh, cutoff);
  start_then = mesh.start;
  end_then = mesh.end;
  positions_then.resize(atom->nlocal);
  for (int i = 0; i < atom->nlocal; i++) {
    const double *x = atom->x[i];
    positions_then[i] = Vec3(x[0], x[1], x[2]);
    if (!mesh.can_move(i)) continue;
    const Sweep particle = mesh.sweep_of(i);
    const std::size_t first = candidates.size();
    discs.grid.within(particle.end, cutoff + (particle.end - particle.start).norm(),
                      [&](int t) { candidates.push_back({i, t}); });
    std::sort(candidates.begin() + first, candidates.end());    // whatever the order of cells
  }
}

// Does the list hold all pairs that may collide in this step?

bool CandidatePairs::still_holds() const
{
  if (positions_then.size() != static_cast<std::size_t>(atom->nlocal) ||
      start_then.size() != mesh.start.size())
    return false;
  const double max = margin();
  return !(std::max(max_vertex_displacement_sq(), max_displacement_sq()) > max * max);
}

// Of vertices since then: from the end of that step or from its start, whichever is nearer, since
// boxes hold both.

double CandidatePairs::max_vertex_displacement_sq() const
{
  double max_sq = 0.0;
  for (const std::vector<Vec3> *positions : {&mesh.start, &mesh.end})
    for (std::size_t s = 0; s < positions->size(); s++) {
      const Vec3 from_start = (*positions)[s] - start_then[s],
                 from_end = (*positions)[s] - end_then[s];
      max_sq = std::max(max_sq, std::min(from_start.squaredNorm(), from_end.squaredNorm()));
    }
  return max_sq;
}

// Of particles that collide with this mesh.  All particles, twice in each step: one loop without
// branches.

double CandidatePairs::max_displacement_sq() const
{
  const int n = atom->nlocal, groupbits = mesh.groupbits, *const mask = atom->mask;
  if (n == 0) return 0.0;
  const double *const x = atom->x[0], *const then = positions_then[0].data();
  double max_sq = 0.0;
#pragma omp simd reduction(max : max_sq)
  for (int i = 0; i < n; i++) {
    const double dx = x[3 * i] - then[3 * i], dy = x[3 * i + 1] - then[3 * i + 1],
                 dz = x[3 * i + 2] - then[3 * i + 2];
    const double displacement_sq = mask[i] & groupbits ? dx * dx + dy * dy + dz * dz : 0.0;
    max_sq = std::max(max_sq, displacement_sq);
  }
  return max_sq;
}

const Box &CandidatePairs::swept_box(int t)
{
  if (!has_box[t]) boxes[t] = mesh.swept_box(t);
  has_box[t] = true;
  return boxes[t];
}

double CandidatePairs::memory_usage() const
{
  return discs.bytes() + bytes_of(candidates, positions_then, start_then, end_then, boxes, has_box);
}
