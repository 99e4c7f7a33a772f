// SPDX-License-Identifier: GPL-2.0-or-later
// Several cloths and obstacles as one mesh, and a coupling of that mesh in the solvers of all
// cloths.

#ifndef SPHCLOTH_CONTACT_JOINED_CLOTHS_H
#define SPHCLOTH_CONTACT_JOINED_CLOTHS_H

#include "cloth/solver_coupling.h"
#include "contact/contact_mesh.h"
#include "contact/mesh_edges.h"
#include "contact/moving_triangles.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class JoinedCloths : public ContactMesh {
 public:
  // groupbits: of all of them
  JoinedCloths(LAMMPS *lmp, const std::string &owner, std::vector<ContactMesh *> cloths_,
               int groupbits) : cloths(std::move(cloths_)), mesh(lmp, owner)
  {
    mesh.gather(groupbits);
  }

  const ClothTopology &topology() const override { return mesh; }
  bool has_vertex(int i) const override { return of(i) != nullptr; }
  double inverse_mass(int i) const override { return of(i)->inverse_mass(i); }
  double inverse_mass_in_solver(int i) const override { return of(i)->inverse_mass_in_solver(i); }
  void push_held(int i, const Eigen::Vector3d &impulse) override { of(i)->push_held(i, impulse); }

  void measure() { mesh.measure(); }

 private:
  std::vector<ContactMesh *> cloths;
  ClothTopology mesh;

  ContactMesh *of(int i) const
  {
    for (ContactMesh *cloth : cloths)
      if (cloth->has_vertex(i)) return cloth;
    return nullptr;
  }
};

// The solvers of the cloths go through their phases together.  Each has a part of the coupling,
// which copies its vertices; the last part that is called in a phase calls the coupling of all, and
// copies what that changes back to all.  Vertices of obstacles are on their way from where the last
// step has left them to where they are.

class JoinedCoupling : protected Pointers {
 public:
  JoinedCoupling(LAMMPS *lmp_, SolverCoupling &all_, const MovingTriangles &mesh_,
                 const MeshEdges &edges_) : Pointers(lmp_), all(all_), mesh(mesh_), edges(edges_)
  {
  }

  // one for each cloth, in the order in which they are solved
  SolverCoupling *add_part(const ContactMesh *cloth);

  void rebuild();    // after each list build, behind that of the mesh of all

  double memory_usage() const;

 private:
  struct Part : public SolverCoupling {
    Part(JoinedCoupling &whole_, const ContactMesh *cloth_, bool first_) :
        whole(whole_), cloth(cloth_), first(first_)
    {
    }
    bool begin_step(const sphcloth::Vertex *, const sphcloth::Vertex *, double) override;
    void begin_substep(const sphcloth::Vertex *, const sphcloth::Vertex *, double) override;
    void project(sphcloth::Vertex *) override;
    void end_substep(sphcloth::Vertex *, double) override;
    void end_step() override;
    Eigen::Vector3d impulse_on(int slot) const override;

    void gather(const sphcloth::Vertex *from, std::vector<sphcloth::Vertex> &to) const;
    bool is_last() const { return this == whole.parts.back().get(); }

    JoinedCoupling &whole;
    const ContactMesh *const cloth;
    const bool first;
    std::vector<int> slots;    // of the mesh of all, by owned vertices of the cloth
    sphcloth::Vertex *target = nullptr;    // of this phase
  };

  SolverCoupling &all;
  const MovingTriangles &mesh;
  const MeshEdges &edges;
  std::vector<int> moved;    // slots of obstacles
  double step_dt = 0.0, substep_dt = 0.0;
  double elapsed = 0.0;    // of the step, with this substep
  std::vector<std::unique_ptr<Part>> parts;
  bool present = false, obstacles_rest = false;    // in this step
  std::vector<sphcloth::Vertex> start, other;    // owned vertices of all

  void start_obstacles();
  void move_obstacles(double position, double displacement);
  void scatter();
};

}    // namespace LAMMPS_NS

#endif
