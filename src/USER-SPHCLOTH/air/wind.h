// SPDX-License-Identifier: GPL-2.0-or-later
// The velocity of the air: numbers or variables, with a gust that it carries along.

#ifndef SPHCLOTH_AIR_WIND_H
#define SPHCLOTH_AIR_WIND_H

#include "core/air/gust_field.h"
#include "lammps_util/number_or_variable.h"
#include "pointers.h"

#include <Eigen/Core>

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;
class VertexHalo;

class Wind : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  Wind(LAMMPS *lmp_, std::string owner_) : Pointers(lmp_), owner(std::move(owner_)) {}

  // what follows the keywords
  void read_mean(ArgReader &);
  void read_gust(ArgReader &);

  // of variables: do they exist, and of which style are they?  Before each run.
  void check();
  // at the time of the forces; collective
  void find(int igroup);
  // of owned vertices, in the order of their slots
  void add_to(const VertexHalo &, std::vector<Vec3> &velocities);

  // The gust is carried as far in a step; how far it has come is kept in restart files.
  void carry(double dt) { carried += dt * mean(); }
  Vec3 carried = Vec3::Zero();

  double bytes() const;

 private:
  const std::string owner;
  static constexpr auto STYLES = NumberOrVariable::Styles::EQUAL_OR_ATOM;
  std::array<NumberOrVariable, 3> along{NumberOrVariable(STYLES), NumberOrVariable(STYLES),
                                        NumberOrVariable(STYLES)};
  sphcloth::GustField gust;
  std::array<std::vector<double>, 3> point, velocity;

  // 0 of what differs between atoms
  Vec3 mean() const { return {along[0].value(), along[1].value(), along[2].value()}; }
};

}    // namespace LAMMPS_NS

#endif
