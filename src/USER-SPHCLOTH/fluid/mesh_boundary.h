// SPDX-License-Identifier: GPL-2.0-or-later
// A mesh as a wall to the fluid beside it: what the kernel of a particle misses behind the nearest
// point of the mesh is filled as behind a plane there, core/sph/plane_wall.h.  The mesh may be
// coarser than the fluid: what a particle pushes is spread over the triangle by the weights of that
// point.

#ifndef SPHCLOTH_FLUID_MESH_BOUNDARY_H
#define SPHCLOTH_FLUID_MESH_BOUNDARY_H

#include "contact/triangle_set.h"
#include "core/sph/plane_wall.h"
#include "core/sph/wall_profile.h"
#include "fluid/fluid_boundary.h"

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FluidState;

// the point of a mesh that is nearest to a particle

struct ClosestPoint {
  int particle = 0, sheet = 0, triangle = 0;
  std::array<int, 3> vertices{};    // slots
  Eigen::Vector3d weight, normal;    // barycentric; from the mesh to the particle
  double distance = 0.0;
  Eigen::Vector3d from_border =
      Eigen::Vector3d::Zero();    // in the plane, unit; 0: the border is far
  double border_distance = 0.0;
  double share = 1.0;    // of what fills, beside other meshes
  sphcloth::WallTable::Value value{}, beyond{};    // of plane and border
};

class BoundaryMesh : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  enum class Part { WATERTIGHT, ALL };

  BoundaryMesh(LAMMPS *lmp_, TriangleSet *set_, Part part_ = Part::WATERTIGHT) :
      Pointers(lmp_), set(set_), part(part_)
  {
  }

  // After each list build: triangles that may be nearest to a particle until the next one.
  // reach(i): of the kernel of an owned particle, 0 for one that does not feel this wall.
  void update_candidates(double skin, const std::function<double(int)> &reach);

  // where particles stand now, those within reach, added to what is there
  void find_closest_points(int sheet, std::vector<ClosestPoint> &closest_points);

  Vec3 velocity_at(const ClosestPoint &) const;

  // force on the mesh at a foot; handed over to owned vertices, take(atom, force)
  void give(const ClosestPoint &closest, const Vec3 &push) { spread(closest, push, forces); }
  void hand_over(const std::function<void(int, const Vec3 &)> &take) { sum_up(forces, take); }

  // The same of the fluid that moves with the mesh: its mass, and that times its rates of sound and
  // viscosity
  void wet(const ClosestPoint &closest, const Vec3 &quantity)
  {
    spread(closest, quantity, wetting);
  }
  void hand_over_wetting(const std::function<void(int, const Vec3 &)> &take)
  {
    sum_up(wetting, take);
  }
  // The same for the limit of stability: sums over the fluid that presses, and how fast friction
  // stops a vertex; and what the vertices around a foot have
  void forget_stiffness() { std::fill(stiffness.begin(), stiffness.end(), Vec3::Zero()); }
  void press(const ClosestPoint &closest, double weight, double friction)
  {
    spread(closest, Vec3(weight, friction, 0.0), stiffness);
  }
  void complete_stiffness();
  Vec3 stiffness_at(const ClosestPoint &) const;

 private:
  struct Candidate {
    int triangle;
    double distance;    // at the list build
  };
  struct Seeker {
    int particle;
    double reach;
    Vec3 at;    // at the list build
    std::size_t first, last;    // candidates, nearest first
    std::size_t first_border, last_border;
  };
  TriangleSet *set;
  Part part;
  double skin = 0.0;
  std::vector<Candidate> candidates;
  std::vector<std::array<int, 2>> borders;    // slots of the ends
  std::vector<Seeker> seekers;
  std::vector<Vec3> positions, list_positions;    // by slot, now and at the list build
  std::vector<Vec3> forces, wetting;    // by slot
  std::vector<Vec3> stiffness;    // by slot: the sum over fluid, the rate of friction

  void find_positions();
  void keep_nearest(const Vec3 &p, double within, std::vector<Candidate> &near) const;
  Vec3 gap_to(const Vec3 &p, int triangle, Vec3 &weight) const;
  bool is_beyond(const Vec3 &p, const std::vector<Candidate> &nearest_first) const;
  void find_border(const Vec3 &at, const Seeker &, ClosestPoint &) const;
  static void spread(const ClosestPoint &, const Vec3 &, std::vector<Vec3> &);
  void sum_up(std::vector<Vec3> &, const std::function<void(int, const Vec3 &)> &take);
};

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
  void add(const ContactMesh *, TriangleSet *);
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
