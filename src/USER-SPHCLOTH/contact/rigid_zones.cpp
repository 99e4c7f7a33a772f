// SPDX-License-Identifier: GPL-2.0-or-later
// Moves zones by the mean displacement of their members.

#include "contact/rigid_zones.h"

#include "atom.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/rank_error.h"

#include <utility>
#include <vector>

using namespace LAMMPS_NS;
using sphcloth::Sweep;
using Vec3 = Eigen::Vector3d;

void LAMMPS_NS::move_rigid_zones(LAMMPS *lmp, MovingTriangles &mesh, const ImpactZones &zones)
{
  const Atom *const atom = lmp->atom;
  struct Sum {
    double mass, displacement[3], momentum[3];    // of the free members
    double held, held_displacement[3], held_velocity[3];    // number of held members, and sums
  };
  constexpr int SIZE = sizeof(Sum) / sizeof(double);
  std::vector<Sum> mine(zones.size(), Sum{}), all(zones.size());
  std::vector<std::pair<int, int>> members;    // atom and zone
  for (int i = 0; i < atom->nlocal; i++)
    if (const int z = zones.zone_of(atom->tag[i]); z >= 0) members.emplace_back(i, z);
  const auto is_held = [&](int i) {
    return mesh.mesh->has_vertex(i) && mesh.mesh->inverse_mass(i) == 0.0;
  };

  for (const auto &[i, z] : members) {
    const Vec3 displacement = mesh.sweep_of(i).end - mesh.sweep_of(i).start;
    const double m = atom_mass(atom, i);
    (is_held(i) ? mine[z].held : mine[z].mass) += is_held(i) ? 1.0 : m;
    for (int d = 0; d < 3; d++) {
      (is_held(i) ? mine[z].held_displacement : mine[z].displacement)[d] +=
          is_held(i) ? displacement[d] : m * displacement[d];
      (is_held(i) ? mine[z].held_velocity : mine[z].momentum)[d] += is_held(i) ? atom->v[i][d]
                                                                               : m * atom->v[i][d];
    }
  }
  MPI_Allreduce(mine.data(), all.data(), SIZE * zones.size(), MPI_DOUBLE, MPI_SUM, lmp->world);

  for (const auto &[i, z] : members) {
    const Sum &sum = all[z];
    const Sweep sweep = mesh.sweep_of(i);
    Vec3 displacement, velocity, lost;
    for (int d = 0; d < 3; d++) {
      displacement[d] = sum.held > 0.0 ? sum.held_displacement[d] / sum.held
                                       : sum.displacement[d] / sum.mass;
      velocity[d] = sum.held > 0.0 ? sum.held_velocity[d] / sum.held : sum.momentum[d] / sum.mass;
      lost[d] = sum.momentum[d] - sum.mass * velocity[d];
    }
    if (!is_held(i)) {
      for (int d = 0; d < 3; d++) {
        atom->x[i][d] = sweep.start[d] + displacement[d];
        atom->v[i][d] = velocity[d];
      }
      continue;
    }
    const double apart = (sweep.end - sweep.start - displacement).norm();
    if (apart > mesh.rules.thickness)
      rank_error(lmp, FLERR,
                 "{}: held vertex {} moves {} away from others in one step and crushes what is "
                 "between them: move pins slower or lower the time step",
                 mesh.label, atom->tag[i], apart);
    mesh.push_held(i, lost / sum.held);
  }
}
