// SPDX-License-Identifier: GPL-2.0-or-later
// bond_style pbd: stiffness of the distance constraint (4), per bond type.

#ifdef BOND_CLASS
// clang-format off
BondStyle(pbd,BondPBD);
// clang-format on
#else

#ifndef LMP_BOND_PBD_H
#define LMP_BOND_PBD_H

#include "bond.h"

#include "cloth/pbd_material.h"

namespace LAMMPS_NS {

class BondPBD : public Bond, public HasPBDMaterials {
 public:
  BondPBD(class LAMMPS *);
  ~BondPBD() override;
  void compute(int, int) override;
  void coeff(int, char **) override;
  void init_style() override;
  double equilibrium_distance(int) override { return 0.0; }
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_data(FILE *) override;
  double single(int, double, int, int, double &) override;

  bool owns(int type) const override { return setflag && setflag[type]; }
  const PBDMaterial &material(int type) const override { return materials[type]; }

 private:
  PBDMaterials materials;

  void allocate();
};

}    // namespace LAMMPS_NS

#endif
#endif
