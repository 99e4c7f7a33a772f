// SPDX-License-Identifier: GPL-2.0-or-later
// compute sph/atom: what pair_style sph/tait and fix sph/integrate know of each particle.

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(sph/atom,ComputeSPHAtom);
// clang-format on
#else

#ifndef LMP_COMPUTE_SPH_ATOM_H
#define LMP_COMPUTE_SPH_ATOM_H

#include "compute.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixClothContact;
class FixSPHIntegrate;
class FluidState;

class ComputeSPHAtom : public Compute {
 public:
  ComputeSPHAtom(class LAMMPS *, int, char **);
  ~ComputeSPHAtom() override;
  void init() override;
  void compute_peratom() override;
  double memory_usage() override;

 private:
  enum class Column { DENSITY, PRESSURE, ENERGY, SOUND, VOLUME, NEIGHBORS, DT, ACTIVE, SIDE };

  std::string label;
  std::vector<Column> columns;    // in the user's order
  int nmax;
  FluidState *fluid;
  FixSPHIntegrate *stepper;    // only where a column needs it
  FixClothContact *sheets;     // the same

  Column read_column(class ArgReader &) const;
  bool asks_for(Column) const;
  void find_styles();
  void check_evaluated() const;
  void make_room();
  double value(Column, int i) const;
  double value_of_fluid(Column, int i) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
