// Triangles of atoms that no cloth solver moves, and how the vertices of a cloth meet them.

#ifndef SPHCLOTH_CONTACT_OBSTACLE_H
#define SPHCLOTH_CONTACT_OBSTACLE_H

#include "cloth/solver_coupling.h"
#include "contact/contact_mesh.h"
#include "contact/contact_surface.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixPBDCloth;

// fixed, or moved by another fix, which finds the forces of contact in f

class Obstacle : public ContactMesh, protected Pointers {
 public:
  Obstacle(LAMMPS *lmp_, const std::string &owner, int groupbit_) :
      Pointers(lmp_), groupbit(groupbit_), mesh(lmp, owner)
  {
  }
  void gather() { mesh.gather(groupbit); }
  void set_pushes(double **of_atoms) { pushes = of_atoms; }

  const ClothTopology &topology() const override { return mesh; }
  bool has_vertex(int i) const override;
  double inverse_mass(int) const override { return 0.0; }
  double inverse_mass_in_solver(int) const override { return 0.0; }
  void push_held(int i, const Eigen::Vector3d &impulse) override;

  const int groupbit;

 private:
  ClothTopology mesh;
  double **pushes = nullptr;    // per atom: mass times velocity in this step
};

// While a cloth is solved its vertices are kept out of an obstacle after each sweep.

class ObstacleCoupling : public SolverCoupling, protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  ObstacleCoupling(LAMMPS *lmp_, FixPBDCloth *cloth_, ContactSurface *surface_,
                   const ContactRules *rules_) :
      Pointers(lmp_), cloth(cloth_), surface(surface_), rules(rules_)
  {
  }

  bool begin_step(const sphcloth::Vertex *start, const sphcloth::Vertex *end, double dt) override;
  void begin_substep(const sphcloth::Vertex *start, const sphcloth::Vertex *v, double dt) override;
  void project(sphcloth::Vertex *displacement) override;
  void end_substep(sphcloth::Vertex *v, double dt) override;
  void end_step() override;
  Vec3 impulse_on(int slot) const override { return received[slot]; }

 private:
  struct Meeting {    // of a vertex of the cloth
    int slot;
    int first, last;    // its triangles: near[first] to near[last - 1]
    Vec3 start = Vec3::Zero();
    // of the substep: the triangle that it was pushed from last, where, and how far
    int triangle = -1;
    Vec3 weight = Vec3::Zero(), normal = Vec3::Zero();
    double push = 0.0, speed_before = 0.0;
  };

  FixPBDCloth *cloth;
  ContactSurface *surface;
  const ContactRules *rules;
  double step_dt = 0.0, elapsed = 0.0;    // of the step, up to the end of the substep
  const sphcloth::Vertex *substep_start = nullptr;
  std::vector<int> near;
  std::vector<Meeting> meetings;
  std::vector<Vec3> received;    // by slot of the cloth

  Vec3 velocity_from(const Meeting &, const sphcloth::Vertex &) const;
};

}    // namespace LAMMPS_NS

#endif
