// SPDX-License-Identifier: GPL-2.0-or-later
// fix wall/sph: plane walls without wall particles.

#ifdef FIX_CLASS
// clang-format off
FixStyle(wall/sph,FixWallSPH);
// clang-format on
#else

#ifndef LMP_FIX_WALL_SPH_H
#define LMP_FIX_WALL_SPH_H

#include "atom.h"
#include "fix.h"

#include "core/sph/plane_wall.h"
#include "core/sph/shifting.h"
#include "core/sph/wall_impact.h"
#include "core/sph/wall_profile.h"
#include "fluid/fluid_boundary.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/number_or_variable.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;
class FluidState;

class FixWallSPH : public Fix, public FluidBoundary {
 public:
  FixWallSPH(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int vflag) override { post_force(vflag); }
  void post_force(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_scalar() override;
  double compute_vector(int) override;
  void *extract(const char *, int &) override;

  // another fix, of the same words, may have had its walls elsewhere
  std::uint64_t settings() const override
  {
    const bool is_new = std::any_of(walls.begin(), walls.end(),
                                    [](const Wall &wall) { return !wall.last_position; });
    return is_new ? hash_with(words_hash, std::string_view(id)) : words_hash;
  }
  void begin() override;
  double density(int i, double of_particles) override;
  double density_rate(int i, double of_particles, double back) override;
  void push(int i, double p_over_rho2) override { push(i, p_over_rho2, 1.0, true); }
  void push_more(int i, double p_over_rho2, double times) override
  {
    push(i, p_over_rho2, times, false);
  }
  bool knows_gradients() const override { return true; }
  void complete_gradient(int i, double *) override;
  void push_turn(int i, const Eigen::Vector3d &) override;
  void defer(const Take &) override { std::fill(mine.begin(), mine.end(), 0.0); }
  void prolong(double times) override;

  double approach(int i) override;
  bool moves_beside(int i) override;
  void add_stiffness(int i, sphcloth::Stiffness &) override;

  // what the walls of the last evaluation add to the concentration gradient of a fluid particle
  void add_to(sphcloth::ConcentrationGradient &, int i);

 private:
  std::uint64_t words_hash = EMPTY_HASH;    // of the command
  struct Record;    // in restart files

  struct Wall {
    int face;             // 0 to 5: xlo, xhi, ylo, yhi, zlo, zhi
    bool at_edge;         // of the box, wherever that is
    NumberOrVariable given;
    double position;
    std::optional<double> last_position;    // before the last step
    double velocity[3];    // along the plane as given, across it from the motion of the plane

    int axis() const { return face / 2; }
    bool has_place() const { return !at_edge && !given.is_variable(); }
    bool moves() const
    {
      return velocity[0] != 0.0 || velocity[1] != 0.0 || velocity[2] != 0.0 ||
          last_position != position;
    }
    double inwards() const { return face % 2 == 0 ? 1.0 : -1.0; }
    double distance(const double *x) const { return inwards() * (x[axis()] - position); }
    double last_distance(const double *x) const { return inwards() * (x[axis()] - *last_position); }
  };

  struct Press {    // of a wall on a particle
    int particle, axis;
    double virial;
  };

  std::string label;
  FluidState *fluid;
  std::vector<Wall> walls;
  std::vector<NumberOrVariable *> positions;
  bool slip, any_moves;
  double reflection;    // 1, and the pressure behind the plane over the particle's own
  std::array<int, 6> wall_at;    // by face; -1: none
  std::array<double, 3> open_low, open_high;    // out of reach of the walls across each axis
  sphcloth::WallTable table;
  sphcloth::WallImpact impact;
  std::vector<sphcloth::WallProfile> profiles;    // [ntypes + 1]

  struct OfType {    // of a type of fluid, in this evaluation
    double support, rho0, stiffness, nu, impact;
  };
  std::vector<OfType> types;    // [ntypes + 1]

  sphcloth::JointWalls near;    // in reach of the particle that was asked for last
  // Those of each particle in this evaluation, and where by particle
  struct Range {
    int first, n;    // n < 0: not asked for yet
  };
  std::vector<sphcloth::NearWall> found, measured;
  std::vector<Range> found_at;
  std::vector<Press> presses;    // kept only for fix_modify virial yes
  std::vector<double> mine, all;    // force on each wall, x, y, z, then the energy; of all ranks
  bool summed;

  void read_walls(ArgReader &);
  void read_velocity(ArgReader &);
  void check_face(const Wall &) const;
  void locate(Wall &, double);
  void take_materials();
  void find_open_space();
  bool query(int i);
  bool measure(int i, double back);
  void measure(int i, double back, std::vector<sphcloth::NearWall> &into) const;
  // d rho_i / d distance from near[n], beside the others
  double slope(int i, std::size_t n) const
  {
    const OfType &type = types[atom->type[i]];
    return type.rho0 * near.slope(n) / type.support;
  }
  // The gradient that a layer lacks over that of what a wall adds: a profile makes up for forces
  // that are not doubled.
  double lacking(int i) const { return profiles[atom->type[i]].changes() ? 0.5 * reflection : 1.0; }
  // velocity of particle i away from wall k
  double departure(int i, std::size_t k) const
  {
    const int axis = walls[k].axis();
    return walls[k].inwards() * (atom->v[i][axis] - walls[k].velocity[axis]);
  }
  // alpha c0 h_s rho0/rho D/H^2, D the value of the table
  double impact_rate(int i, double of_table) const
  {
    const OfType &type = types[atom->type[i]];
    return type.impact / atom->rho[i] * of_table / (2.0 * type.support);
  }
  void push(int i, double p_over_rho2, double times, bool first);
  double output(int);
};

}    // namespace LAMMPS_NS

#endif
#endif
