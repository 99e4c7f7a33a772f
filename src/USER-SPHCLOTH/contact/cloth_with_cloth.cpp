// SPDX-License-Identifier: GPL-2.0-or-later
// Joins meshes where there are several, and checks what a run starts from.

#include "contact/cloth_with_cloth.h"

#include "atom.h"
#include "comm.h"
#include "contact/tangles.h"
#include "contact/untangle.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

static std::unique_ptr<JoinedCloths> join(LAMMPS *lmp, const std::string &label,
                                          const ClothWithCloth::Meshes &meshes)
{
  std::vector<ContactMesh *> all = meshes.cloths;
  all.insert(all.end(), meshes.obstacles.begin(), meshes.obstacles.end());
  if (all.size() == 1) return nullptr;
  return std::make_unique<JoinedCloths>(lmp, label, all, meshes.cloth_bits | meshes.obstacle_bits);
}

ClothWithCloth::ClothWithCloth(LAMMPS *lmp_, const Meshes &meshes, const std::string &label,
                               const ClothRules &rules, ContactCounts &counts,
                               const ParticleColumns &last_positions) :
    Pointers(lmp_), joined(join(lmp, label, meshes)),
    triangles(lmp, joined ? static_cast<ContactMesh *>(joined.get()) : meshes.cloths.front(), label,
              0, rules.obstacle, counts, last_positions),
    edges(lmp, triangles, meshes.obstacle_bits), candidates(lmp, triangles, edges, rules),
    rows(lmp, triangles, edges, candidates), guarantee(lmp, triangles, edges, candidates)
{
  if (joined) {
    coupling = std::make_unique<JoinedCoupling>(lmp, rows, triangles, edges);
    for (const ContactMesh *cloth : meshes.cloths) parts.push_back(coupling->add_part(cloth));
  } else
    parts = {&rows};
}

void ClothWithCloth::rebuild()
{
  triangles.rebuild(candidates.rules.max_thickness());
  edges.rebuild();
  rows.rebuild();
  guarantee.rebuild();
  if (coupling) coupling->rebuild();
}

// Vertices that move far bring new ghosts, and these may bring new tangles.

void ClothWithCloth::untangle()
{
  constexpr int MAX_ROUNDS = 3;
  for (int round = 0; round < MAX_ROUNDS; round++) {
    triangles.rebuild(candidates.rules.max_thickness());
    edges.rebuild();
    if (!LAMMPS_NS::untangle(lmp, triangles, edges, candidates.rules.cloth_meets_cloth,
                             0.5 * candidates.rules.max_thickness()))
      return;
    move_to_owners();
  }
}

// as before a list build

void ClothWithCloth::move_to_owners() const
{
  if (domain->triclinic) domain->x2lamda(atom->nlocal);
  domain->pbc();
  comm->exchange();
  comm->borders();
  if (domain->triclinic) domain->lamda2x(atom->nlocal + atom->nghost);
}

void ClothWithCloth::check_start(bool untangled)
{
  triangles.load_positions();
  if (candidates.rules.cloth_meets_cloth) check_heights();
  check_tangles(lmp, triangles, edges, candidates.rules.cloth_meets_cloth,
                untangled
                    ? fmt::format("'untangle yes' has not parted them in {} passes: place the "
                                  "cloths and obstacles apart",
                                  MAX_PASSES_OF_UNTANGLING)
                    : "place the cloths and obstacles apart, or add 'untangle yes'");
  candidates.update();
  warn_of_too_near();
}

// Vertices of neighboring triangles are as far apart as these are high: a thickness above that
// would push a flat cloth apart.

void ClothWithCloth::check_heights() const
{
  double mine = std::numeric_limits<double>::infinity(), lowest;
  for (const auto &[i, j, k] : triangles.triangles) {
    if (edges.is_obstacle(i)) continue;
    const Vec3 a = triangles.end[i], b = triangles.end[j], c = triangles.end[k];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    mine = std::min(mine, (b - a).cross(c - a).norm() / longest);
  }
  MPI_Allreduce(&mine, &lowest, 1, MPI_DOUBLE, MPI_MIN, world);
  const double thickness = candidates.rules.cloth.thickness;
  if (thickness > lowest)
    error->all(FLERR,
               "{}: the thickness {} of cloth that meets cloth is above the height {:.6g} of the "
               "lowest triangle: lower it with 'cloth/thickness', or make the mesh coarser",
               triangles.label, thickness, lowest);
}

void ClothWithCloth::warn_of_too_near() const
{
  bigint mine = 0, all;
  candidates.for_near(candidates.rules.max_thickness(),
                      [&](const ClothPair &pair, const ClosestPoints &at) {
                        const double thickness = candidates.rules.of(pair.with_obstacle).thickness;
                        if (!pair.joined && at.vector.norm() < 0.999 * thickness) mine++;
                      });
  MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all > 0 && comm->me == 0)
    error->warning(FLERR,
                   "{}: {} pairs of vertices and triangles or of edges, of cloth and cloth or "
                   "obstacles, start nearer to one another than the thickness: they get their gap "
                   "by a tenth of it per step; place them farther apart, or lower the thickness",
                   triangles.label, all);
}

double ClothWithCloth::memory_usage() const
{
  return triangles.memory_usage() + edges.memory_usage() + candidates.memory_usage() +
      rows.memory_usage() + guarantee.memory_usage() + (coupling ? coupling->memory_usage() : 0.0);
}
