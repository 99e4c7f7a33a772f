// SPDX-License-Identifier: GPL-2.0-or-later
// compute pbd/atom: strain, curvature, area and normal of a cloth at its vertices, and the forces
// that hold them.

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(pbd/atom,ComputePBDAtom);
// clang-format on
#else

#ifndef LMP_COMPUTE_PBD_ATOM_H
#define LMP_COMPUTE_PBD_ATOM_H

#include "compute.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixPBDCloth;

class ComputePBDAtom : public Compute {
 public:
  ComputePBDAtom(class LAMMPS *, int, char **);
  ~ComputePBDAtom() override;
  void init() override;
  void compute_peratom() override;
  double memory_usage() override;

 private:
  using Vec3 = Eigen::Vector3d;
  enum class Column { STRAIN, CURVATURE, AREA, NX, NY, NZ, FX, FY, FZ };

  struct VertexGeometry {    // of a vertex in its sheet
    double area = 0.0;    // a third of its triangles
    Vec3 normal = Vec3::Zero();    // of unit length, or 0 where there is no triangle
    double curvature = 0.0;    // mean curvature
  };

  std::string label, cloth_id;
  std::vector<Column> columns;    // in the user's order
  int nmax;
  const FixPBDCloth *cloth;

  bool asks_for(Column first, Column last) const;
  void make_room();
  double value(Column, int i, const VertexGeometry &) const;
  double strain(int i) const;
  VertexGeometry geometry_of(int i) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
