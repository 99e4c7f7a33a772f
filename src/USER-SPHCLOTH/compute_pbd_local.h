// SPDX-License-Identifier: GPL-2.0-or-later
// compute pbd/local: strain of every edge, or angle and curvature of every hinge, of a cloth.

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(pbd/local,ComputePBDLocal);
// clang-format on
#else

#ifndef LMP_COMPUTE_PBD_LOCAL_H
#define LMP_COMPUTE_PBD_LOCAL_H

#include "compute.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

template <std::size_t N> struct ClothElements;
class FixPBDCloth;

class ComputePBDLocal : public Compute {
 public:
  ComputePBDLocal(class LAMMPS *, int, char **);
  ~ComputePBDLocal() override;
  void init() override;
  void compute_local() override;
  double memory_usage() override;

 private:
  // all that is known of an edge: ID, ID, type, rest, length, strain;
  // of a hinge: ID, ID, ID, ID, type, rest, angle, curvature
  using Row = std::array<double, 8>;

  std::string label, cloth_id;
  bool of_hinges;
  std::vector<int> columns;    // of a row, in the user's order
  std::vector<Row> rows;
  int room;    // rows that the array has
  const FixPBDCloth *cloth;

  template <std::size_t N, class Measure> void collect(const ClothElements<N> &, Measure measure);
  std::array<double, 3> measure_edge(int m, int i) const;
  std::array<double, 3> measure_hinge(int m, int i) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
