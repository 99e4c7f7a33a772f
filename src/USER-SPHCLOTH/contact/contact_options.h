// SPDX-License-Identifier: GPL-2.0-or-later
// The arguments of fix cloth/contact.

#ifndef SPHCLOTH_CONTACT_CONTACT_OPTIONS_H
#define SPHCLOTH_CONTACT_CONTACT_OPTIONS_H

#include "contact/contact_rules.h"
#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;

class ContactOptions : protected Pointers {
 public:
  ContactRules rules, cloth_rules;    // of particles and obstacles, and of cloth with cloth
  bool cloth_meets_cloth = false;
  bool untangle = false;    // what passes through cloth at the start of a run
  bool walls = false;    // meshes complete the kernel of the fluid
  std::vector<int> obstacle_groups;

  ContactOptions(LAMMPS *lmp_, const std::string &owner_) : Pointers(lmp_), owner(owner_) {}
  void read(ArgReader &);

 private:
  const std::string owner;

  bool read_of_cloth(ArgReader &, const std::string &keyword);
  void read_obstacle(ArgReader &);
  void complete_rules();
};

}    // namespace LAMMPS_NS

#endif
