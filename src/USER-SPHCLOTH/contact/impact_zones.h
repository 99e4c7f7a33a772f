// SPDX-License-Identifier: GPL-2.0-or-later
// Rigid impact zones: sets of atoms that move as one, the same on all ranks.
// Provot, Graphics Interface 1997.

#ifndef SPHCLOTH_CONTACT_IMPACT_ZONES_H
#define SPHCLOTH_CONTACT_IMPACT_ZONES_H

#include "lmptype.h"

#include <map>
#include <vector>

namespace LAMMPS_NS {

class ImpactZones {
 public:
  // groups of four IDs that belong together; false if that was known of all of them
  bool join(const std::vector<tagint> &groups)
  {
    bool any_new = false;
    for (std::size_t k = 0; k < groups.size(); k += 4)
      for (int q = 0; q < 4; q++) {
        parent.try_emplace(groups[k + q], groups[k + q]);
        any_new = any_new || root(groups[k + q]) != root(groups[k]);
        parent[root(groups[k + q])] = root(groups[k]);
      }
    number.clear();
    for (const auto &[id, ignored] : parent) number.try_emplace(root(id), number.size());
    return any_new;
  }
  int size() const { return static_cast<int>(number.size()); }
  int zone_of(tagint id) const    // -1: in none
  {
    return parent.count(id) ? number.at(root(id)) : -1;
  }

 private:
  std::map<tagint, tagint> parent;
  std::map<tagint, int> number;
  tagint root(tagint id) const
  {
    while (parent.at(id) != id) id = parent.at(id);
    return id;
  }
};

}    // namespace LAMMPS_NS

#endif
