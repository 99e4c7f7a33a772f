// SPDX-License-Identifier: GPL-2.0-or-later
// create_cloth: a rectangular or round sheet of vertices, bonds, triangles and hinges.

#ifdef COMMAND_CLASS
// clang-format off
CommandStyle(create_cloth,CreateCloth);
// clang-format on
#else

#ifndef LMP_CREATE_CLOTH_H
#define LMP_CREATE_CLOTH_H

#include "command.h"

#include "core/pbd/sheet_mesh.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;

class CreateCloth : public Command {
 public:
  CreateCloth(class LAMMPS *);
  void command(int, char **) override;

 private:
  using Vec3 = Eigen::Vector3d;

  int itype;
  double areal_mass;
  Vec3 center, axis_u, axis_v;
  double length, width, radius, spacing;    // either length and width or radius
  std::optional<sphcloth::Pattern> pattern;
  int bond_type, shear_type, triangle_type, hinge_type;
  int groupbit;
  std::vector<std::pair<class Region *, int>> pins;    // region, group bit

  sphcloth::Sheet sheet;
  sphcloth::MeshTopology mesh;
  tagint first_id;

  void read_options(ArgReader &);
  sphcloth::Pattern read_pattern(ArgReader &) const;
  Vec3 read_vector(ArgReader &, const std::string &) const;
  int read_group(ArgReader &) const;
  void check_shape() const;
  void check_types() const;
  void check_box() const;
  void check_capacity() const;
  Vec3 position(int) const;
  void create_vertices();
  void set_masses(int);
  void create_topology();
};

}    // namespace LAMMPS_NS

#endif
#endif
