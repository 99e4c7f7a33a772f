// SPDX-License-Identifier: GPL-2.0-or-later
// dihedral_style pbd: stiffness of the hinge constraint (5), per dihedral type.

#ifdef DIHEDRAL_CLASS
// clang-format off
DihedralStyle(pbd,DihedralPBD);
// clang-format on
#else

#ifndef LMP_DIHEDRAL_PBD_H
#define LMP_DIHEDRAL_PBD_H

#include "dihedral.h"

#include "cloth/pbd_material.h"

namespace LAMMPS_NS {

class DihedralPBD : public Dihedral, public HasPBDMaterials {
 public:
  DihedralPBD(class LAMMPS *);
  ~DihedralPBD() override;
  void compute(int, int) override;
  void coeff(int, char **) override;
  void init_style() override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_data(FILE *) override;

  bool owns(int type) const override { return setflag && setflag[type]; }
  const PBDMaterial &material(int type) const override { return materials[type]; }

 private:
  PBDMaterials materials;

  void allocate();
};

}    // namespace LAMMPS_NS

#endif
#endif
