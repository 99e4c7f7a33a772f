// SPDX-License-Identifier: GPL-2.0-or-later
// Where the boundary particles whose volumes are measured were when that was done last, ghosts too:
// have any moved since, with a velocity or without?

#ifndef SPHCLOTH_FLUID_MEASURED_POSITIONS_H
#define SPHCLOTH_FLUID_MEASURED_POSITIONS_H

#include "core/sph/fluid.h"
#include "core/util/bytes.h"

#include <algorithm>
#include <array>
#include <vector>

namespace LAMMPS_NS {

class MeasuredPositions {
 public:
  // for new lists; is_measured(type)
  template <class Is> void begin_lists(const sphcloth::Particles &p, int n_types, Is is_measured)
  {
    types.resize(n_types + 1);
    for (Type &type : types) type.atoms.clear();
    for (int i = 0; i < p.n_all; i++)
      if (is_measured(p.type[i])) types[p.type[i]].atoms.push_back(i);
    for (Type &type : types) type.x.resize(type.atoms.size());
  }

  void note(const sphcloth::Particles &p, int itype)
  {
    auto &[atoms, x] = types[itype];
    for (std::size_t k = 0; k < atoms.size(); k++) std::copy_n(p.x + 3 * atoms[k], 3, x[k].begin());
  }

  bool have_moved(const sphcloth::Particles &p, int itype) const
  {
    const auto &[atoms, x] = types[itype];
    for (std::size_t k = 0; k < atoms.size(); k++)
      if (!std::equal(x[k].begin(), x[k].end(), p.x + 3 * atoms[k])) return true;
    return false;
  }

  double bytes() const
  {
    double sum = 0.0;
    for (const Type &type : types) sum += sphcloth::bytes_of(type.atoms, type.x);
    return sum;
  }

 private:
  struct Type {
    std::vector<int> atoms;
    std::vector<std::array<double, 3>> x;
  };
  std::vector<Type> types;
};

}    // namespace LAMMPS_NS

#endif
