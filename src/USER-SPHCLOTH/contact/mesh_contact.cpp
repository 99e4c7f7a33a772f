// SPDX-License-Identifier: GPL-2.0-or-later
// The phases of contact with a mesh, and what a run starts from.

#include "contact/mesh_contact.h"

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

MeshContact::MeshContact(LAMMPS *lmp_, MovingTriangles &triangles_, bool meets_cloth,
                         int obstacle_bits, const MeetingRules &rules_) :
    Pointers(lmp_), triangles(triangles_), rules(rules_),
    mesh_edges(lmp, triangles, obstacle_bits, meets_cloth), of_particles(lmp, triangles),
    of_cloth(lmp, triangles, mesh_edges, rules),
    contact_rows(lmp, triangles, mesh_edges, of_particles, of_cloth, rules),
    gaps(lmp, triangles, of_particles, rules),
    guarantee(lmp, triangles, mesh_edges, of_particles, of_cloth, rules)
{
}

void MeshContact::rebuild()
{
  mesh_edges.rebuild();
  contact_rows.rebuild();
  of_particles.clear();
  gaps.rebuild();
  guarantee.rebuild();
}

bool MeshContact::resolve()
{
  const WallTimer clock(triangles.counts.seconds);
  triangles.step_start.atoms_moved();
  triangles.load_step();
  const bool any = gaps.keep();
  return guarantee.resolve_collisions() || any;
}

// Vertices that move far bring new ghosts, and these may bring new tangles.

void MeshContact::untangle()
{
  if (of_cloth.none()) return;
  constexpr int MAX_ROUNDS = 3;
  for (int round = 0; round < MAX_ROUNDS; round++) {
    triangles.rebuild(rules.max_thickness());
    mesh_edges.rebuild();
    if (!LAMMPS_NS::untangle(lmp, triangles, mesh_edges, rules.cloth_meets_cloth,
                             0.5 * rules.max_thickness()))
      return;
    move_to_owners();
  }
}

// as before a list build

void MeshContact::move_to_owners() const
{
  if (domain->triclinic) domain->x2lamda(atom->nlocal);
  domain->pbc();
  comm->exchange();
  comm->borders();
  if (domain->triclinic) domain->lamda2x(atom->nlocal + atom->nghost);
}

void MeshContact::check_start(bool untangled)
{
  gaps.warn_of_too_near();
  if (of_cloth.none()) return;
  triangles.load_positions();
  if (rules.cloth_meets_cloth) check_heights();
  check_tangles(lmp, triangles, mesh_edges, rules.cloth_meets_cloth,
                untangled
                    ? fmt::format("'untangle yes' has not parted them in {} passes: place the "
                                  "cloths and obstacles apart",
                                  MAX_PASSES_OF_UNTANGLING)
                    : "place the cloths and obstacles apart, or add 'untangle yes'");
  of_cloth.update();
  warn_of_too_near();
}

// Vertices of neighboring triangles are as far apart as these are high: a thickness above that
// would push a flat cloth apart.

void MeshContact::check_heights() const
{
  double mine = std::numeric_limits<double>::infinity(), lowest;
  for (const auto &[i, j, k] : triangles.triangles) {
    if (mesh_edges.is_obstacle(i)) continue;
    const Vec3 a = triangles.end[i], b = triangles.end[j], c = triangles.end[k];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    mine = std::min(mine, (b - a).cross(c - a).norm() / longest);
  }
  MPI_Allreduce(&mine, &lowest, 1, MPI_DOUBLE, MPI_MIN, world);
  const double thickness = rules.cloth.thickness;
  if (thickness > lowest)
    error->all(FLERR,
               "{}: the thickness {} of cloth that meets cloth is above the height {:.6g} of the "
               "lowest triangle: lower it with 'cloth/thickness', or make the mesh coarser",
               triangles.label, thickness, lowest);
}

void MeshContact::warn_of_too_near()
{
  bigint mine = 0, all;
  of_cloth.for_near(rules.max_thickness(), [&](const ContactPair &pair, const ClosestPoints &at) {
    const double distance = at.vector.norm();
    if (!of_cloth.are_joined(pair, distance) && distance < 0.999 * rules.of(pair.meeting).thickness)
      mine++;
  });
  MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all > 0 && comm->me == 0)
    error->warning(FLERR,
                   "{}: {} pairs of vertices and triangles or of edges, of cloth and cloth or "
                   "obstacles, start nearer to one another than the thickness: they get their gap "
                   "by a tenth of it per step; place them farther apart, or lower the thickness",
                   triangles.label, all);
}

double MeshContact::memory_usage() const
{
  return mesh_edges.memory_usage() + of_particles.memory_usage() + of_cloth.memory_usage() +
      contact_rows.memory_usage() + gaps.memory_usage() + guarantee.memory_usage();
}
