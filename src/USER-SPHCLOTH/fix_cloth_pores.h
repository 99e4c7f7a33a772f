// SPDX-License-Identifier: GPL-2.0-or-later
// fix cloth/pores: triangles that let water through, and what that costs it.

#ifdef FIX_CLASS
// clang-format off
FixStyle(cloth/pores,FixClothPores);
// clang-format on
#else

#ifndef LMP_FIX_CLOTH_PORES_H
#define LMP_FIX_CLOTH_PORES_H

#include "fix.h"

#include "lammps_util/particle_columns.h"
#include "pores/pore_mesh.h"
#include "pores/pore_options.h"
#include "pores/pore_rows.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixClothPores : public Fix {
 public:
  FixClothPores(class LAMMPS *, int, char **);
  ~FixClothPores() override;
  int setmask() override;
  void init() override;
  void setup_post_neighbor() override { post_neighbor(); }
  void post_neighbor() override;
  void initial_integrate(int) override;
  void post_integrate() override;
  double compute_vector(int) override;

  void grow_arrays(int nmax) override { state.grow(nmax); }
  void copy_arrays(int i, int j, int) override { state.copy(i, j); }
  void set_arrays(int i) override { state.clear(i); }
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override { return 1 + N_COLUMNS; }
  int maxsize_restart() override { return 1 + N_COLUMNS; }
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

 private:
  struct Counts {    // since the fix was made, of all that this rank has seen
    double up = 0.0, down = 0.0;    // particles
    double volume = 0.0;    // of those up, less those down
    double lost = 0.0;    // energy
  };
  struct Record;    // in restart files

  struct Mesh {
    PoreMesh pores;
    std::unique_ptr<PoreRows> rows;    // null: an obstacle
  };

  std::string label;
  PoreOptions options;
  PoreFluid fluid;
  std::vector<std::unique_ptr<Mesh>> meshes;
  // of a particle, on which side of porous triangles it is: 1 above, -1 below, 0: none is near; of
  // a vertex, how far water went through beside it, core/pores/pore_law.h
  enum Column { SIDE, FLOW, N_COLUMNS };
  ParticleColumns state;
  std::vector<double> side_before;
  Counts counts;
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();    // on meshes in the last step
  double last_dt = 0.0;

  void check_integrators();
  bool is_known(const ClothTopology &mesh) const;
  void find_meshes();
  void count_passages();
};

}    // namespace LAMMPS_NS

#endif
#endif
