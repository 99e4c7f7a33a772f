// SPDX-License-Identifier: GPL-2.0-or-later
// The velocity of the air: numbers or variables, with a gust that it carries along.

#ifndef SPHCLOTH_AIR_WIND_H
#define SPHCLOTH_AIR_WIND_H

#include "core/air/gust_field.h"
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
  void carry(double dt) { carried += dt * mean; }
  Vec3 carried = Vec3::Zero();

  double bytes() const;

 private:
  const std::string owner;
  std::array<std::string, 3> variable;    // names; empty: numbers
  std::array<int, 3> index{-1, -1, -1};
  std::array<bool, 3> per_atom{};
  Vec3 mean = Vec3::Zero();    // 0 of what differs between atoms
  sphcloth::GustField gust;
  std::array<std::vector<double>, 3> of_atom, point, velocity;

  bool varies() const;
  void check_variable(int d);
};

}    // namespace LAMMPS_NS

#endif
