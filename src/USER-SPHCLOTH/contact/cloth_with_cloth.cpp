// SPDX-License-Identifier: GPL-2.0-or-later
// Joins cloths where there are several, and checks what a run starts from.

#include "contact/cloth_with_cloth.h"

#include "atom.h"
#include "comm.h"
#include "contact/tangles.h"
#include "error.h"

#include <algorithm>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

static ContactMesh *one_of(const std::vector<ContactMesh *> &cloths, JoinedCloths *joined)
{
  return joined ? static_cast<ContactMesh *>(joined) : cloths.front();
}

ClothWithCloth::ClothWithCloth(LAMMPS *lmp_, const std::vector<ContactMesh *> &cloths,
                               int groupbits, const std::string &label, const ContactRules &rules_,
                               ContactCounts &counts, const ParticleColumns &last_positions) :
    Pointers(lmp_),
    joined(cloths.size() > 1 ? new JoinedCloths(lmp, label, cloths, groupbits) : nullptr),
    triangles(lmp, one_of(cloths, joined.get()), label, 0, rules_, counts, last_positions),
    edges(lmp, triangles), candidates(lmp, triangles, edges),
    rows(lmp, triangles, edges, candidates), guarantee(lmp, triangles, candidates)
{
  parts = {&rows};
  if (!joined) return;
  coupling = std::make_unique<JoinedCoupling>(lmp, rows, triangles.halo);
  parts.clear();
  for (const ContactMesh *cloth : cloths) parts.push_back(coupling->add_part(cloth));
}

void ClothWithCloth::rebuild()
{
  triangles.rebuild(triangles.rules.thickness);
  edges.rebuild();
  candidates.clear();
  rows.rebuild();
  guarantee.rebuild();
  if (coupling) coupling->rebuild();
}

void ClothWithCloth::check_start()
{
  triangles.load_positions();
  check_heights();
  check_tangles(lmp, triangles, edges);
  candidates.update();
  warn_of_too_near();
}

// Vertices of neighboring triangles are as far apart as these are high: a thickness above that would
// push a flat cloth apart.

void ClothWithCloth::check_heights() const
{
  double mine = std::numeric_limits<double>::infinity(), lowest;
  for (const auto &[i, j, k] : triangles.triangles) {
    const Vec3 a = triangles.end[i], b = triangles.end[j], c = triangles.end[k];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    mine = std::min(mine, (b - a).cross(c - a).norm() / longest);
  }
  MPI_Allreduce(&mine, &lowest, 1, MPI_DOUBLE, MPI_MIN, world);
  if (triangles.rules.thickness > lowest)
    error->all(FLERR,
               "{}: the thickness {} of cloth that meets cloth is above the height {:.6g} of the "
               "lowest triangle: lower it with 'cloth/thickness', or make the mesh coarser",
               triangles.label, triangles.rules.thickness, lowest);
}

void ClothWithCloth::warn_of_too_near() const
{
  bigint mine = 0, all;
  candidates.for_near(0.999 * triangles.rules.thickness,
                      [&mine](const ClothPair &pair, const ClosestPoints &) {
                        if (!pair.joined) mine++;
                      });
  MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all > 0 && comm->me == 0)
    error->warning(FLERR,
                   "{}: {} pairs of vertices and triangles or of edges start nearer to one another "
                   "than the thickness {}: they get their gap by a tenth of it per step; place the "
                   "cloths farther apart, or lower the thickness",
                   triangles.label, all, triangles.rules.thickness);
}

double ClothWithCloth::memory_usage() const
{
  return triangles.memory_usage() + edges.memory_usage() + candidates.memory_usage() +
      rows.memory_usage() + guarantee.memory_usage() + (coupling ? coupling->memory_usage() : 0.0);
}
