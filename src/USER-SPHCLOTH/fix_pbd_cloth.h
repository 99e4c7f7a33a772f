// fix pbd/cloth: position-based dynamics of cloth, (7) to (9) and lines 19 to 29 of Algorithm 1.

#ifdef FIX_CLASS
// clang-format off
FixStyle(pbd/cloth,FixPBDCloth);
// clang-format on
#else

#ifndef LMP_FIX_PBD_CLOTH_H
#define LMP_FIX_PBD_CLOTH_H

#include "fix.h"

#include "cloth_topology.h"
#include "core/cloth_solver.h"
#include "vertex_halo.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;
struct PBDMaterial;

class FixPBDCloth : public Fix {
 public:
  FixPBDCloth(class LAMMPS *, int, char **);
  ~FixPBDCloth() override;
  int setmask() override;
  void init() override;
  void setup_post_neighbor() override { post_neighbor(); }
  void post_neighbor() override;
  void initial_integrate(int) override;
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

  const ClothTopology &topology() const { return mesh; }
  double inverse_mass(int owned_atom) const;    // 0 for a pinned vertex

 private:
  using Vec3 = Eigen::Vector3d;

  // GAUSS_SEIDEL: a projection sees all before it.  JACOBI: it sees none of its own sweep, and the
  // share that it may move is one over the number of constraints at its vertices.  SUBSTEPS: as
  // many small steps as there are iterations, each with one sweep.
  enum class Solver { GAUSS_SEIDEL, JACOBI, SUBSTEPS };

  std::string label;
  Solver solver;
  int iterations;
  bool from_start;    // edges are projected along where they were at the start of the step
  double tolerance;    // of the residual, 0: all iterations are done
  int pinbit;    // 0: nothing is pinned
  double damping;    // rate at which stretching motion decays, 1/time
  double **rest_x;    // rest position of each vertex, unwrapped
  ClothTopology mesh;
  VertexHalo halo;

  // by element of the mesh: rest length or angle, colour
  std::vector<double> edge_rest, hinge_rest;
  std::vector<int> edge_colour, hinge_colour;
  int edge_colours, hinge_colours;
  // a type may be several constraints at once; the second of an edge has a colour of its own
  int edge_layers;
  double mean_length;
  std::vector<int> crowd;    // of a mesh vertex: constraints that it is in

  // what this rank projects, with slots of the halo as vertices
  sphcloth::Constraints<2> distance;
  sphcloth::Constraints<4> bending;
  sphcloth::Vertices p, v, start, change;    // by slot, and one idle vertex behind
  double pin_force[3];    // of the last step, this rank's part
  int sweeps;    // of the last step
  bool remembered;    // the next two are of the last step, this rank's part
  double last_residual, last_energy;
  bool started;    // velocities are those of half a step ago, see direction start

  void read_options(ArgReader &);
  void take_rest_positions(const char *);
  void check_overlap();
  void check_masses();
  void check_pins();
  void check_styles();
  const PBDMaterial *material_of_edge(int type) const;
  const PBDMaterial *material_of_hinge(int type) const;
  void measure_rest();
  void colour_mesh();
  template <std::size_t N, class MaterialOf>
  void count_constraints(const ClothElements<N> &, MaterialOf);
  template <std::size_t N, class MaterialOf>
  void collect(sphcloth::Constraints<N> &, const ClothElements<N> &, const std::vector<int> &colour,
               int n_colours, int layers, const std::vector<double> &rest, int n_types, MaterialOf);
  double share_of(const int *vertices, int n) const;
  int slot_of_vertex(int, int);
  void ask_for_ghosts(const std::vector<int> &);
  int substeps() const { return solver == Solver::SUBSTEPS ? iterations : 1; }
  void load();
  void substep(int n);
  void damp();
  void project_all(double dt);
  void gauss_seidel(const sphcloth::ClothState &);
  void jacobi(const sphcloth::ClothState &);
  void store();
  double residual() const;
  bool converged() const;
  void remember();
  double largest_strain() const;

  static constexpr int ALL = 0;    // halo channels: all ghosts, then one per colour
  int channel_of_edge_colour(int c) const { return 1 + c; }
  int channel_of_hinge_colour(int c) const { return 1 + edge_colours * edge_layers + c; }
};

}    // namespace LAMMPS_NS

#endif
#endif
