// SPDX-License-Identifier: GPL-2.0-or-later
// fix cloth/air: wind and drag on the triangles of cloth.

#ifdef FIX_CLASS
// clang-format off
FixStyle(cloth/air,FixClothAir);
// clang-format on
#else

#ifndef LMP_FIX_CLOTH_AIR_H
#define LMP_FIX_CLOTH_AIR_H

#include "fix.h"

#include "air/added_mass.h"
#include "air/air_mesh.h"
#include "air/air_options.h"
#include "air/water_beside.h"
#include "air/wind_shade.h"
#include "lammps_util/particle_columns.h"
#include "lammps_util/replaced_velocities.h"

#include <Eigen/Core>

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixPBDCloth;

class FixClothAir : public Fix {
 public:
  FixClothAir(class LAMMPS *, int, char **);
  ~FixClothAir() override;
  int setmask() override;
  void init() override;
  void setup_post_neighbor() override { post_neighbor(); }
  void post_neighbor() override;
  void setup(int vflag) override { post_force(vflag); }
  void post_force(int) override;
  void initial_integrate(int) override;
  void post_integrate() override;
  void post_run() override { velocities.end_run(atom); }
  double compute_vector(int) override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override { return maxsize_restart(); }
  int maxsize_restart() override { return 2 + motion.count(); }
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

 private:
  using Vec3 = Eigen::Vector3d;
  struct Record;    // in restart files
  struct Cloth {
    FixPBDCloth *fix;
    std::unique_ptr<AirMesh> mesh;
    std::unique_ptr<AddedMass> added;    // null: there is none
    std::vector<Vec3> velocity;    // of owned vertices, before the step
  };

  std::string label;
  AirOptions options;
  WaterBeside water;
  WindShade shade;
  std::vector<Cloth> cloths;
  // of the last step, per atom: mean velocity of a vertex, and what it gained of that by all but
  // the air; not a number before the first; and, with shaded, its position when the lee was found
  enum Column { VELOCITY, GAIN = 3, SEEN = 6, N_COLUMNS = SEEN + 3 };
  ParticleColumns motion;
  ReplacedVelocities velocities;
  double last_dt = 0.0;

  // of the last step, this rank's part: impulse, work, area; work since the fix was made, of all
  // that this rank has seen
  Vec3 impulse = Vec3::Zero();
  double step_work = 0.0, area = 0.0, work = 0.0;

  Vec3 kept(int column, int i) const
  {
    return {motion[column][i], motion[column + 1][i], motion[column + 2][i]};
  }
  void forget_motion(int i);
  void refuse_vertices_of_others();
  void load(Cloth &);
  void find_shade();
  void apply(const Cloth &);
  void end_step(const Cloth &);
};

}    // namespace LAMMPS_NS

#endif
#endif
