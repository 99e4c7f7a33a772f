// SPDX-License-Identifier: GPL-2.0-or-later
// Contact of several cloths and obstacles that may meet: as with one mesh of all.

#ifndef SPHCLOTH_CONTACT_JOINED_CONTACT_H
#define SPHCLOTH_CONTACT_JOINED_CONTACT_H

#include "contact/joined_cloths.h"
#include "contact/mesh_contact.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class JoinedContact {
 public:
  struct Meshes {
    std::vector<ContactMesh *> cloths, obstacles;
    int cloth_bits, obstacle_bits;    // group bits of their vertices
  };

  // see MovingTriangles and MeshContact for the others
  JoinedContact(LAMMPS *lmp, const Meshes &meshes, const std::string &label, int particle_bits,
                const MeetingRules &rules, ContactCounts &counts, StepStart &step_start) :
      joined(lmp, label, all_of(meshes), meshes.cloth_bits | meshes.obstacle_bits),
      triangles(lmp, &joined, label, particle_bits, rules.others, counts, step_start),
      contact(lmp, triangles, true, meshes.obstacle_bits, rules),
      coupling(lmp, contact.rows(), triangles, contact.edges())
  {
    for (const ContactMesh *cloth : meshes.cloths) parts.push_back(coupling.add_part(cloth));
  }

  JoinedCloths joined;
  MovingTriangles triangles;
  MeshContact contact;
  JoinedCoupling coupling;
  std::vector<SolverCoupling *> parts;    // what takes part in the solver of each cloth

 private:
  static std::vector<ContactMesh *> all_of(const Meshes &meshes)
  {
    std::vector<ContactMesh *> all = meshes.cloths;
    all.insert(all.end(), meshes.obstacles.begin(), meshes.obstacles.end());
    return all;
  }
};

}    // namespace LAMMPS_NS

#endif
