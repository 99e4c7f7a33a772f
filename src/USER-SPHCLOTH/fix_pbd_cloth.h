// SPDX-License-Identifier: GPL-2.0-or-later
// fix pbd/cloth: position-based dynamics of cloth, (7) to (9) and lines 19 to 29 of Algorithm 1.

#ifdef FIX_CLASS
// clang-format off
FixStyle(pbd/cloth,FixPBDCloth);
// clang-format on
#else

#ifndef LMP_FIX_PBD_CLOTH_H
#define LMP_FIX_PBD_CLOTH_H

#include "fix.h"

#include "atom.h"
#include "cloth/cloth_constraints.h"
#include "cloth/cloth_options.h"
#include "cloth/cloth_topology.h"
#include "cloth/cloth_vertices.h"
#include "cloth/half_kick_correction.h"
#include "cloth/held_vertices.h"
#include "cloth/holder_forces.h"
#include "cloth/reference_step.h"
#include "cloth/solver_coupling.h"
#include "cloth/substepping.h"
#include "contact/contact_mesh.h"
#include "fluid/scaled_vertices.h"
#include "lammps_util/box_faces.h"
#include "lammps_util/ghost_reach.h"
#include "lammps_util/list_guard.h"
#include "lammps_util/replaced_velocities.h"
#include "lammps_util/timed_dumps.h"
#include "stepping/limited_vertices.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixPBDCloth : public Fix, public ContactMesh, public LimitedVertices {
 public:
  FixPBDCloth(class LAMMPS *, int, char **);
  ~FixPBDCloth() override;
  int setmask() override;
  void init() override;
  void setup_pre_exchange() override { require_inside_box(lmp, label, groupbit); }
  void setup_post_neighbor() override;
  void pre_exchange() override;
  void min_pre_exchange() override
  {
    vertices.load_positions(atom->x);
    pre_exchange();
  }
  void post_neighbor() override;
  void min_post_neighbor() override { post_neighbor(); }
  void post_integrate() override;
  void setup_pre_reverse(int eflag, int vflag) override { pre_reverse(eflag, vflag); }
  void pre_reverse(int, int) override;
  void post_run() override { velocities.end_run(atom); }
  void end_of_step() override { renew_computes_for_timed_dumps(lmp); }
  double compute_vector(int) override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override { return maxsize_restart(); }
  int maxsize_restart() override
  {
    return 2 + rest_x.count() + holders.columns.count() + half_kick.impulse.count();
  }
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

  // the fix of that ID, or an error in the name of the style that asks
  static FixPBDCloth *find(LAMMPS *, const std::string &asking, const std::string &id);

  const ClothTopology &topology() const override { return mesh; }
  bool has_vertex(int i) const override { return held.is_vertex(i); }
  double inverse_mass(int i) const override { return held.inverse_mass(i); }
  double inverse_mass_in_solver(int i) const override { return held.inverse_mass_in_solver(i); }
  void push_held(int i, const Eigen::Vector3d &impulse) override
  {
    holders.add_impulse(i, impulse);
  }

  bool is_attached(int i) const { return held.is_attached(i); }
  // Of an owned vertex behind its solver, over the step; that of its holder, if it has one.  What
  // moves it without a velocity does not count.
  Eigen::Vector3d mean_velocity(int i)
  {
    if (held.inverse_mass(i) == 0.0) return Vec3(atom->v[i]);
    const double inv_dt = 1.0 / update->dt;
    return inv_dt * (Vec3(atom->x[i]) - vertices.step_start[vertices.halo.slot_of(i)]);
  }

  // takes part in the projections until the next init()
  void register_coupling(SolverCoupling *coupling)
  {
    couplings.insert(couplings.end() - 1, coupling);
  }
  void register_first_coupling(SolverCoupling *coupling)
  {
    couplings.insert(couplings.begin(), coupling);
  }
  // Until then the first of these cloths solves all of them, substep by substep; it is an error if
  // their solvers differ.
  static void solve_together(const std::vector<FixPBDCloth *> &);

  // Share of the impulses in the contacts of the last step that the solver did not pass on.  Where
  // masses are scaled, pressure stops what comes, and springs between it and the vertices.
  void missed_in_contact(double share)
  {
    if (!scaled.on()) substepping.missed_in_contact(share);
  }

  // rest lengths and angles of the edges and hinges of the topology
  const ClothConstraints &rest() const { return constraints; }
  double shortest_edge(int i) const override { return constraints.shortest_edge(i); }

  // force of an atom's holder on the cloth in the last step: 0 for a free vertex.  Known from the
  // next step on if it is asked for before a run.
  void want_reaction_forces() { holders.want(); }
  Eigen::Vector3d reaction_force(int owned_atom) const;

 private:
  struct Record;    // in restart files
  using Vec3 = Eigen::Vector3d;

  std::string label;
  ClothOptions options;
  HeldVertices held;

  ParticleColumns rest_x;    // rest position of each vertex, unwrapped
  RestBox rest_box;
  ClothTopology mesh;
  GhostReach ghosts;
  ClothConstraints constraints;
  ReferenceStep reference;
  ClothVertices vertices;
  ListGuard lists_of_atoms;
  HolderForces holders;
  ReplacedVelocities velocities;
  HalfKickCorrection half_kick;    // of the solver substeps
  Substepping substepping;
  ScaledVertices scaled;    // of those beside fluid
  std::vector<SolverCoupling *> couplings;    // the last: `scaled`, which sees what others did
  std::vector<SolverCoupling *> present;    // those that are near in this step
  std::vector<FixPBDCloth *> solved_here;    // cloths that this fix solves: itself, or none

  double holder_force[3];    // in the last step, this rank's part
  bool measured;    // the next three are of the last step, this rank's part
  double last_residual, last_energy, last_unconverged;

  void begin_step(int substeps);
  void begin_couplings();
  void end_step();
  void load();
  void store();
  void measure();
  static constexpr int N_KEPT = 4;
  ParticleColumns *kept(int n);
};

// all of them; one that is defined after the fix that asks is an error in its name
std::vector<FixPBDCloth *> cloths_before(LAMMPS *, const Fix *, const std::string &asking);

}    // namespace LAMMPS_NS

#endif
#endif
