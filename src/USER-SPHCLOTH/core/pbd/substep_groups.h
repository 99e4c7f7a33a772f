// SPDX-License-Identifier: GPL-2.0-or-later
// What is so soft, or decays so slowly, that it need not be done in each substep: once for a group
// of them, for the time of all, in the middle one.
//
// Forces that act in impulses at equal distances are symplectic and of second order:
// Tuckerman, Berne & Martyna, J. Chem. Phys. 97 (1992) 1990.

#ifndef SPHCLOTH_CORE_PBD_SUBSTEP_GROUPS_H
#define SPHCLOTH_CORE_PBD_SUBSTEP_GROUPS_H

#include <algorithm>
#include <cmath>

namespace sphcloth {

struct SubstepGroups {
  int substeps = 1, groups = 1;

  SubstepGroups() = default;
  // of a step of dt, none longer than `longest`, but at least a substep
  SubstepGroups(int substeps_, double dt, double longest) :
      substeps(substeps_),
      groups(dt < longest * substeps_ ? static_cast<int>(std::max(1.0, std::ceil(dt / longest)))
                                      : substeps_)
  {
  }

  bool are_single() const { return groups == substeps; }
  // so many substeps are done for in substep n; 0: none
  int done_in(int n) const
  {
    const int group = ((n + 1) * groups - 1) / substeps;
    return n == begin(group) + (size(group) - 1) / 2 ? size(group) : 0;
  }
  int last_size() const { return size(groups - 1); }

 private:
  int begin(int group) const { return group * substeps / groups; }
  int size(int group) const { return begin(group + 1) - begin(group); }
};

}    // namespace sphcloth

#endif
