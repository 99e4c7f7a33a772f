// SPDX-License-Identifier: GPL-2.0-or-later
// fix sph/emit: pours fluid particles through a disc or a rectangle.

#ifdef FIX_CLASS
// clang-format off
FixStyle(sph/emit,FixSPHEmit);
// clang-format on
#else

#ifndef LMP_FIX_SPH_EMIT_H
#define LMP_FIX_SPH_EMIT_H

#include "fix.h"

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;

class FixSPHEmit : public Fix {
 public:
  FixSPHEmit(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void post_integrate() override;
  void pre_exchange() override;
  void post_run() override;
  double compute_scalar() override { return static_cast<double>(emitted); }
  double compute_vector(int) override;
  double memory_usage() override;
  void write_restart(FILE *) override;
  void restart(char *) override;

  // what came in so far, plain, for restart files; energy: kinetic, of mass times velocity squared
  struct Poured {
    double mass, momentum[3], energy;
  };
  const Poured &poured() const { return came_in; }

 private:
  using Vec3 = Eigen::Vector3d;
  struct Record;    // in restart files

  std::string label;
  bigint total, emitted;
  int itype;
  double spacing;
  double mass;    // of a particle, 0: that of water at rest
  double rho0 = 0.0;    // its density
  Vec3 center, velocity;
  double extent[2];    // radius of the disc, or the two sides of the rectangle
  bool disc;
  double start;                 // physical time of the first layer
  double layer_time;            // between layers: spacing / speed
  bigint layers;                // poured so far
  Poured came_in{};             // so far
  tagint largest_id = 0;        // of atoms so far, also of those that have left
  std::vector<tagint> ids;      // of owned atoms when the last run ended
  std::vector<Vec3> pattern;    // one layer, relative to the center
  Vec3 sides[2];                // unit vectors along those of a rectangle
  bool warned = false;

  void read_options(ArgReader &);
  void make_pattern();
  double due() const { return start + static_cast<double>(layers) * layer_time; }
  bool layer_is_due() const;
  double mass_of_one() const;
  void follow_renumbering();
  void emit_layer(double);
  bigint count_in_the_way(double age) const;
  void warn_of_backwater(bigint particles);
  void add_particle(const Vec3 &, tagint);
};

}    // namespace LAMMPS_NS

#endif
#endif
