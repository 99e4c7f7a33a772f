// SPDX-License-Identifier: GPL-2.0-or-later
// Mass scaling of the vertices of meshes that are walls to fluid (core/sph/mass_scaling.h).  A
// particle presses on the nearest point of a mesh; the spring between them is divided among the
// vertices of the triangle by the weights of the point, which is at least as stiff by Jensen's
// inequality.  Momentum is kept; angular momentum as far as the vertices of a triangle move alike.

#ifndef SPHCLOTH_FLUID_MESH_SCALING_H
#define SPHCLOTH_FLUID_MESH_SCALING_H

#include "core/sph/mass_scaling.h"
#include "fluid/boundary_mesh.h"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <vector>

namespace LAMMPS_NS {

// By what the velocity of a vertex changes in a step, and for which part of that the forces act on
// it; 0: it does not change.

struct VertexChange {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  double part_of_step = 0.0;
};

class MeshScaling {
 public:
  using Vec3 = Eigen::Vector3d;
  using Mat3 = Eigen::Matrix3d;
  using OfFluid = std::function<const sphcloth::FluidKick &(int fluid)>;
  using Take = std::function<void(int owned_atom, const Vec3 &)>;

  // anew in each evaluation: meshes, the same on all ranks, each with its springs behind it
  void begin();
  void begin_mesh(BoundaryMesh &);
  // of a particle that has this velocity
  void add(const ClosestPoint &, double stiffness, const Vec3 &direction, const Vec3 &velocity);

  // take(owned vertex, D_j); collective
  void sum_stiffness(const std::function<void(int owned_atom, const Mat3 &)> &take);
  // take(owned vertex, sum of a dt^2 d_kj e (e.dv_k + phi_k u_kj)), from kick(k); collective
  void carry(double dt, const OfFluid &kick, const Take &take);
  // give(k, impulse) to the fluid, from change(owned vertex); collective
  void give(double dt, const OfFluid &kick, const std::function<VertexChange(int)> &change,
            const std::function<void(int fluid, const Vec3 &impulse)> &give);

  double bytes() const;

 private:
  struct Spring {
    int fluid, mesh;
    std::array<int, 3> vertices;    // slots
    Vec3 weight, direction;
    double stiffness;
    std::array<double, 3> motion;    // of the fluid beside each vertex, along the direction
  };
  struct Mesh {
    BoundaryMesh *of = nullptr;
    std::vector<Vec3> sums, mixed;    // by slot
    std::vector<double> parts;    // of the step
  };
  std::vector<Spring> springs;
  std::vector<Mesh> meshes;    // buffers are kept from evaluation to evaluation
  std::size_t n_meshes = 0;

  void clear_sums();
};

}    // namespace LAMMPS_NS

#endif
