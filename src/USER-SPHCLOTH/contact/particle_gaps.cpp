// SPDX-License-Identifier: GPL-2.0-or-later
// Puts particles back that the solver has left too near to triangles.

#include "contact/particle_gaps.h"

#include "atom.h"
#include "comm.h"
#include "core/contact/point_passage.h"
#include "error.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

// Of the gap: what may be missing behind the solver, and how much farther a particle is put back,
// so that the next pass finds it resolved.  The smaller it is, the less depends on whether
// a particle was put back.
static constexpr double SLACK = 1e-6, OVERSHOOT = 1e-10;

// of the thickness: how far a particle would have come for substeps to be shorter
static constexpr double NOTICED = 0.01;

// of the thickness: what a particle that is too near may get back in one step
static constexpr double RECOVERY = 0.1;

// Of the speed with which a particle came too near behind the solver, so much is removed: the
// whole approach, unless it hardly came too near.
static constexpr double APPROACH_FACTOR = 10.0;

// of one particle: what one triangle puts back may penetrate another
static constexpr int MAX_PASSES = 20;

template <class Visit> void ParticleGaps::for_particles(Visit visit)
{
  int particle = -1;
  const auto leave = [&] {
    if (particle >= 0) visit(particle);
    near.clear();
  };
  candidates.for_near(mesh.rules.thickness, [&](int i, int t, const ClosestPoints &at) {
    if (i != particle) leave();
    particle = i;
    near.push_back({t, at.vector.norm()});
  });
  leave();
}

// No sweep becomes longer by what is put back, and the region in which triangles are known must
// cover them.

bool ParticleGaps::keep()
{
  if (candidates.none()) return false;
  velocities.clear();
  candidates.update();
  double mine[2] = {0.0, region.max_vertex_displacement()}, all[2];
  for_particles([&](int particle) {
    if (put_back(particle)) mine[0] = 1.0;
  });
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_MAX, world);
  region.check(all[1]);
  if (all[0] == 0.0) return false;
  velocities.solve();
  return true;
}

// From the triangle in which it is deepest, again and again.  One that was too near before the step
// gets a part of the way back.  Was it hit?

bool ParticleGaps::put_back(int particle)
{
  Sweep sweep = mesh.sweep_of(particle);
  const Vec3 unhindered = sweep.end;
  bool hit = false, moved = false;
  for (int pass = 0; pass < MAX_PASSES; pass++) {
    const Gap gap = deepest(sweep, pass == 0);
    if (gap.triangle < 0) break;
    const double too_near = gap.too_near + gap.normal.dot(sweep.end - unhindered);
    sweep.end += gap.depth * gap.normal;
    for (int d = 0; d < 3; d++) atom->x[particle][d] = sweep.end[d];
    mesh.step_start.atoms_moved();
    moved = true;
    if (!gap.hit) continue;
    hit = true;
    mesh.counts.stops++;
    const ContactPair pair = mesh.pair_of(particle, gap.triangle);
    mesh.end[pair.slots[0]] = sweep.end;
    mesh.counts.missed += approach_left(particle, gap) / mesh.w[pair.slots[0]];
    velocities.add(
        ContactRow(pair, {1.0, -gap.weight[0], -gap.weight[1], -gap.weight[2]}, gap.normal, 0.0),
        gap.max_approach, too_near);
  }
  if (moved) mesh.step_start.moved.push_back(particle);
  return hit;
}

// Speed towards the triangle without a displacement, if that would have been seen

double ParticleGaps::approach_left(int particle, const Gap &gap) const
{
  const double *v = atom->v[particle];
  const double towards = -gap.normal.dot(Vec3(v[0], v[1], v[2]));
  const double left = std::clamp(towards, 0.0, gap.depth / update->dt);
  return left * update->dt > NOTICED * mesh.rules.thickness ? left : 0.0;
}

ParticleGaps::Gap ParticleGaps::deepest(const Sweep &sweep, bool first) const
{
  Gap deepest;
  for (const Near &pair : near) {
    Gap gap = gap_over(sweep, pair);
    if (first) recover(gap, sweep.end, pair.triangle);
    if (is_deeper(gap, deepest)) deepest = gap;
  }
  return deepest;
}

// A particle that is nearer to another triangle at the same edge or vertex only counts if it passes
// through: the normal of a surface is that of the triangle that is nearest.

ParticleGaps::Gap ParticleGaps::gap_over(const Sweep &p, const Near &pair) const
{
  Gap gap;
  const auto &[a, b, c] = mesh.triangles[pair.triangle];
  const FourPoints start{p.start, mesh.start[a], mesh.start[b], mesh.start[c]},
      end{p.end, mesh.end[a], mesh.end[b], mesh.end[c]};
  const double kept = std::min(mesh.rules.thickness, pair.distance), slack = SLACK * kept,
               height = height_over(end), side = height_over(start) >= 0.0 ? 1.0 : -1.0;
  if (side * height > 0.0 && distance_along_centers(PairKind::POINT_TRIANGLE, end) >= kept)
    return gap;
  const Vec3 normal = (end[2] - end[1]).cross(end[3] - end[1]).normalized();
  if (side * height <= 0.0) {
    PairMotion motion{PairKind::POINT_TRIANGLE, start, {}};
    for (int k = 0; k < 4; k++) motion.displacement[k] = end[k] - start[k];
    if (const auto weight = passage(motion)) {
      gap = {pair.triangle, true, *weight, side * normal};
      gap.too_near = std::max(0.0, kept - gap.normal.dot(end[0] - end[1]));
      gap.depth = gap.too_near + slack;
      gap.max_approach = std::numeric_limits<double>::infinity();
      return gap;
    }
  }
  if (std::fabs(normal.dot(end[0] - end[1])) >= kept) return gap;
  const Vec3 vector = distance_vector(end[0], end[1], end[2], end[3], gap.weight);
  const double distance = vector.norm(), into = kept - distance - slack;
  if (into <= 0.0 || mesh.is_nearer_to_another(pair.triangle, gap.weight, vector)) return gap;
  gap.triangle = pair.triangle;
  gap.hit = true;
  if (gap.weight.minCoeff() > 0.0 || distance == 0.0)
    gap.normal = height != 0.0 ? Vec3(std::copysign(1.0, height) * normal) : Vec3(side * normal);
  else
    gap.normal = vector / distance;
  gap.depth = into + OVERSHOOT * kept;
  gap.too_near = kept - distance;
  gap.max_approach = APPROACH_FACTOR * into / update->dt;
  return gap;
}

// at least a part of the thickness, if something of it is missing; false if nothing is

bool ParticleGaps::recover(Gap &gap, const Vec3 &p, int t) const
{
  if (gap.max_approach == std::numeric_limits<double>::infinity()) return false;
  const auto &[a, b, c] = mesh.triangles[t];
  const double thickness = mesh.rules.thickness;
  const FourPoints end{p, mesh.end[a], mesh.end[b], mesh.end[c]};
  if (distance_along_centers(PairKind::POINT_TRIANGLE, end) >= thickness) return false;
  Vec3 weight;
  const Vec3 vector = distance_vector(end[0], end[1], end[2], end[3], weight);
  const double distance = vector.norm();
  if (distance == 0.0 || distance >= thickness) return false;
  if (mesh.is_nearer_to_another(t, weight, vector)) return false;
  gap.triangle = t;
  gap.weight = weight;
  gap.normal = vector / distance;
  gap.depth = std::max(gap.depth, std::min(thickness - distance, RECOVERY * thickness));
  return true;
}

// Two triangles may be hit alike, on an edge: then all ranks take the same one.

bool ParticleGaps::is_deeper(const Gap &gap, const Gap &than) const
{
  if (!(gap.depth > 0.0)) return false;
  if (than.triangle < 0 || gap.depth > than.depth * (1.0 + SEAM)) return true;
  return gap.depth >= than.depth * (1.0 - SEAM) &&
      mesh.element[gap.triangle] < mesh.element[than.triangle];
}

void ParticleGaps::warn_of_too_near()
{
  if (candidates.none()) return;
  mesh.load_step();
  candidates.update();
  bigint mine = 0, all;
  tagint example = 0, one;
  for_particles([&](int i) {
    const Vec3 p = mesh.sweep_of(i).end;
    const bool too_near = std::any_of(near.begin(), near.end(), [&](const Near &pair) {
      Gap gap;
      return recover(gap, p, pair.triangle);
    });
    if (!too_near) return;
    mine++;
    example = std::max(example, atom->tag[i]);
  });
  MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  MPI_Allreduce(&example, &one, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  if (all > 0 && comm->me == 0)
    error->warning(FLERR,
                   "{}: {} particles start nearer to the triangles than the thickness {}, atom {} "
                   "for example: they get their gap by a tenth of it per step; place them farther "
                   "away, or lower the thickness",
                   mesh.label, all, mesh.rules.thickness, one);
}
