// SPDX-License-Identifier: GPL-2.0-or-later
// The points of one mesh that are nearest to fluid particles, and what particles push there: it is
// spread over the triangle by the weights of the point.

#ifndef SPHCLOTH_FLUID_BOUNDARY_MESH_H
#define SPHCLOTH_FLUID_BOUNDARY_MESH_H

#include "contact/triangle_set.h"
#include "core/geometry/disc_grid.h"
#include "core/sph/plane_wall.h"

#include <array>
#include <functional>
#include <vector>

namespace LAMMPS_NS {

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

  // groupbit: of the particles that feel it, which may change in every step
  BoundaryMesh(LAMMPS *lmp_, TriangleSet *set_, int groupbit_, Part part_ = Part::WATERTIGHT) :
      Pointers(lmp_), set(set_), groupbit(groupbit_), part(part_)
  {
  }

  // After each list build: which particles may come near a triangle until the next one.
  // reach(i): of the kernel of an owned particle, 0 for one that never feels this wall.
  void update_candidates(double skin, const std::function<double(int)> &reach);

  // where particles stand now, those within reach, added to what is there
  void find_closest_points(int sheet, std::vector<ClosestPoint> &closest_points);
  // the same at another time: where vertices, by slot, and particles, by atom, stood then
  void find_closest_points(int sheet, std::vector<ClosestPoint> &closest_points,
                           const std::vector<Vec3> &of_vertices,
                           const std::function<Vec3(int)> &of_particle);

  Vec3 velocity_of(int slot) const;
  Vec3 velocity_at(const ClosestPoint &) const;
  VertexHalo &halo() { return set->halo; }
  // Sums by slot, of all ranks, to owned vertices: take(atom, sum) where it is not 0.  They are 0
  // then.  Collective.
  void sum_up(std::vector<Vec3> &, const std::function<void(int, const Vec3 &)> &take);

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
    double distance;    // when they were found
  };
  // A particle, and the triangles that may be the nearest while it and the mesh move by no more
  // than margin() together
  struct Seeker {
    int particle;
    double reach;
    Vec3 at;    // when they were found
    double path;    // of the mesh then
    std::size_t first, last;    // candidates, nearest first
    std::size_t first_border, last_border;
  };
  TriangleSet *set;
  int groupbit;
  Part part;
  double skin = 0.0;
  std::vector<Candidate> candidates;
  std::vector<std::array<int, 2>> borders;    // slots of the ends
  std::vector<Seeker> seekers;
  std::vector<Vec3> positions, list_positions;    // by slot, now and at the list build
  // how far a vertex may have moved since the list build, by its largest step each time, and how
  // far one is from where it was
  double path = 0.0, displacement = 0.0;
  std::vector<sphcloth::Disc> discs;
  sphcloth::DiscGrid grid;    // at the list build
  std::vector<Candidate> near;    // of one particle
  std::vector<Vec3> forces, wetting;    // by slot
  std::vector<Vec3> stiffness;    // by slot: the sum over fluid, the rate of friction

  double margin() const;
  template <class OfVertex, class OfParticle>
  void find_closest_points_at(int sheet, std::vector<ClosestPoint> &, OfVertex, OfParticle);
  template <class OfVertex> void find_positions(OfVertex);
  void sort_triangles(double farthest);
  void find_candidates(const Vec3 &p, double within);
  void store_candidates(Seeker &, const Vec3 &p);
  Vec3 gap_to(const Vec3 &p, int triangle, Vec3 &weight) const;
  bool is_beyond(const Vec3 &p, const Seeker &, const ClosestPoint &) const;
  void find_border(const Vec3 &at, const Seeker &, ClosestPoint &) const;
  static void spread(const ClosestPoint &, const Vec3 &, std::vector<Vec3> &);
};

}    // namespace LAMMPS_NS

#endif
