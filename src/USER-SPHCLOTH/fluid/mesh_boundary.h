// SPDX-License-Identifier: GPL-2.0-or-later
// A mesh as a wall to the fluid beside it: what the kernel of a particle misses behind the nearest
// point of the mesh is filled as behind a plane there, core/sph/plane_wall.h.  The mesh may be
// coarser than the fluid: what a particle pushes is spread over the triangle by the weights of that
// point.

#ifndef SPHCLOTH_FLUID_MESH_BOUNDARY_H
#define SPHCLOTH_FLUID_MESH_BOUNDARY_H

#include "core/sph/wall_profile.h"
#include "fluid/boundary_mesh.h"
#include "fluid/fluid_boundary.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class FluidState;

// All meshes of a scene together.  Where they cover a share lambda of the kernel of a particle, its
// density is the sum over particles over gamma = 1 - lambda, and forces are the gradient of the
// energy with this density: Feldman & Bonet, Int. J. Numer. Meth. Engng 72 (2007) 295.  With a
// calibrated density they add to the sum what a calibrated wall adds for the same share,
// core/sph/wall_profile.h.  Where several meshes are near, each counts as far as it does not lie
// behind nearer ones.

class MeshBoundary : protected Pointers, public FluidBoundary {
 public:
  using Vec3 = Eigen::Vector3d;

  MeshBoundary(LAMMPS *lmp_, const std::string &label_, int groupbit_) :
      Pointers(lmp_), label(label_), groupbit(groupbit_)
  {
  }

  // anew for each run, with the meshes that are there
  void init(FluidState *);
  enum class Mesh { CLOTH, OBSTACLE };
  void add(const ContactMesh *, TriangleSet *, Mesh);
  double reach() const;    // of fluid to a mesh until the next list build
  void update_candidates();    // after each list build

  void begin() override;
  bool renormalizes() const override { return !adds; }
  double inverse_gamma(int i) override;
  double density(int i, double of_particles) override;
  double density_rate(int i, double of_particles, double back) override;
  void push(int i, double p_over_rho2) override;
  void push_more(int i, double p_over_rho2, double times) override;
  void defer(const Take &) override;
  void prolong(double times) override { lasts = times; }
  void end() override;

  double approach(int i) override;
  bool moves_beside(int i) override { return first[i] >= 0; }    // any mesh may move
  bool has_vertices_beside(int i) override { return first[i] >= 0; }

  void add_stiffness(int i, sphcloth::Stiffness &) override;
  void find_vertex_stiffness(const FluidStability &) override;
  void add_row(int i, sphcloth::VertexRow &) override;
  bool has_vertices() const override;
  void add_gradients(int i, sphcloth::DirectionSums &) override;
  void add_springs(MeshScaling &, const std::vector<double> &strength) override;

  void want_wetting() override { wetting_wanted = true; }
  Wetting wetting(int i) const override;

 private:
  std::string label;
  const int groupbit;
  FluidState *fluid = nullptr;
  sphcloth::WallTable table;
  bool adds = false;    // instead of renormalizing
  std::vector<sphcloth::WallProfile> profiles;    // [ntypes + 1]
  std::vector<BoundaryMesh> sheets;
  std::vector<Mesh> kinds;    // of them
  std::vector<ClosestPoint> closest_points;    // of one particle together, the nearest first
  std::vector<int> first;    // of an owned particle, -1: none
  bool wetting_wanted = false;
  double lasts = 1.0;    // how many times as long as the step what was pushed acts
  std::vector<Vec3> wetted_by;    // by owned atom: mass of fluid, and that times its rates

  template <class Do> void for_closest_points(int i, Do something);
  void push(int i, double p_over_rho2, double times, bool first_push);
  double support(int i) const;
  sphcloth::WallTable::Value profile(const ClosestPoint &) const;
  double friction(const ClosestPoint &) const;
  void find_wetting();
  static double covered(const ClosestPoint &);
  Vec3 rise(const ClosestPoint &) const;
  Vec3 velocity_from(const ClosestPoint &) const;
};

}    // namespace LAMMPS_NS

#endif
