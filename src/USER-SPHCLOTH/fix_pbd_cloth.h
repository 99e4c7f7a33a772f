// fix pbd/cloth: position-based dynamics of cloth, (7) to (9) and lines 19 to 29 of Algorithm 1.

#ifdef FIX_CLASS
// clang-format off
FixStyle(pbd/cloth,FixPBDCloth);
// clang-format on
#else

#ifndef LMP_FIX_PBD_CLOTH_H
#define LMP_FIX_PBD_CLOTH_H

#include "fix.h"

#include "cloth/cloth_constraints.h"
#include "cloth/cloth_topology.h"
#include "cloth/pin_motion.h"
#include "cloth/solver_coupling.h"
#include "cloth/vertex_halo.h"
#include "contact/contact_mesh.h"
#include "core/pbd/cloth_solver.h"
#include "stepping/limited_vertices.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;

class FixPBDCloth : public Fix, public ContactMesh, public LimitedVertices {
 public:
  FixPBDCloth(class LAMMPS *, int, char **);
  ~FixPBDCloth() override;
  int setmask() override;
  void init() override;
  void setup_post_neighbor() override { post_neighbor(); }
  void post_neighbor() override;
  void post_integrate() override;
  void setup_pre_reverse(int eflag, int vflag) override { pre_reverse(eflag, vflag); }
  void pre_reverse(int, int) override;
  double compute_vector(int) override;

  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

  // the fix of that ID, or an error in the name of the style that asks
  static FixPBDCloth *find(LAMMPS *, const std::string &asking, const std::string &id);

  const ClothTopology &topology() const override { return mesh; }
  bool has_vertex(int atom) const override;
  double inverse_mass(int owned_atom) const override;
  double inverse_mass_in_solver(int owned_atom) const override;
  void push_held(int owned_atom, const Eigen::Vector3d &impulse) override;
  int n_owned() const { return halo.n_owned(); }

  // takes part in the projections until the next init()
  void register_coupling(SolverCoupling *coupling) { couplings.push_back(coupling); }

  // of edge and hinge m of the topology; an edge without a length or a constraint has no strain
  double rest_length(int m) const { return constraints.rest_length(m); }
  double rest_angle(int m) const { return constraints.rest_angle(m); }
  bool has_strain(int m) const { return constraints.has_strain(m); }
  // rest length of the shortest edge at an owned vertex, infinite without any
  double shortest_edge(int owned_atom) const override;

  // force of an atom's holder on the cloth in the last step: 0 for a free vertex.  Known from the
  // next step on if it is asked for before a run.
  void want_reaction_forces();
  Eigen::Vector3d reaction_force(int owned_atom) const;

 private:
  using Vec3 = Eigen::Vector3d;

  // GAUSS_SEIDEL: a projection sees all before it.  JACOBI: it sees none of its own sweep, and the
  // share that it may move is one over the number of constraints at its vertices.  SUBSTEPS: as
  // many small steps as there are iterations, each with one sweep.
  enum class Solver { GAUSS_SEIDEL, JACOBI, SUBSTEPS };

  std::string label;
  Solver solver;
  int iterations;
  bool symmetric_sweeps;    // a sweep goes through the constraints and back
  bool from_start;    // edges are projected along where they were at the start of the step
  double tolerance;    // of the residual, 0: all iterations are done
  double step_given;    // for which k holds, by the user; 0: not given
  double step_of_k;    // for which k holds, 0: it holds for every step
  int pinbit;    // 0: nothing is pinned
  PinMotion pin_motion;
  int attachbit;    // vertices that another fix integrates, with the pull of the cloth on them
  double damping;    // rate at which stretching motion decays, 1/time
  double **rest_x;    // rest position of each vertex, unwrapped
  double **hold;    // what the cloth does to the holder of a vertex; null: not wanted
  double **lent;    // impulse that forces have given ahead of time, see lend(); null: none
  ClothTopology mesh;
  ClothConstraints constraints;
  VertexHalo halo;

  // by slot, and one idle vertex behind: places, velocities, places at the start of the (sub)step, ways
  // since then, and of one Jacobi sweep
  sphcloth::Vertices p, v, start, displacement, change;
  std::vector<int> attached;    // slots
  std::vector<double> kick;    // inverse mass to the forces: 0 also for attached vertices
  double holding[3];    // force of the holders in the last step, this rank's part
  int sweeps;    // of the last step
  bool remembered;    // the next two are of the last step, this rank's part
  double last_residual, last_energy;
  std::vector<SolverCoupling *> couplings, present;    // those that are near in this step
  bool started;    // velocities are those of half a step ago, see direction start
  bool steps_jump;    // between powers of two
  double step_dt, shortest_of_late;    // steps: the one that is taken
  int substeps;    // of it

  void read_options(ArgReader &);
  void take_rest_positions(const char *);
  void check_overlap();
  void check_masses();
  void begin_couplings();
  int read_held(ArgReader &, const std::string &keyword);
  bool is_held(int atom) const;
  bool is_pinned(int atom) const;
  void check_styles();
  double step_of_stiffness() const;
  int usual_substeps() const { return solver == Solver::SUBSTEPS ? iterations : 1; }
  void cut_step();
  double substep_dt() const { return step_dt / substeps; }
  void move_pins();
  void load();
  void load_attached(int slot);
  sphcloth::Vertex velocity_of_attached(int slot) const;
  void substep(int n);
  void go();
  void damp();
  void project_all(double dt);
  void gauss_seidel(const sphcloth::ClothState &);
  void project_color(int color, const sphcloth::ClothState &);
  void jacobi(const sphcloth::ClothState &);
  void store();
  void lend();
  double all_lent(int dimension) const;
  void start_pulls();
  template <std::size_t N> void add_pull_on_pins(const sphcloth::Constraints<N> &);
  void apply_reactions();
  double residual() const;
  bool converged() const;
  void remember();
  double largest_strain() const;

  static constexpr int ALL = ClothConstraints::ALL;
};

}    // namespace LAMMPS_NS

#endif
#endif
