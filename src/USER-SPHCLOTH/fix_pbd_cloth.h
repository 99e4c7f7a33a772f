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
#include "vertex_halo.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;

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
  double memory_usage() override;

  const ClothTopology &topology() const { return mesh; }
  double inverse_mass(int owned_atom) const;    // 0 for a pinned vertex

 private:
  using Vec3 = Eigen::Vector3d;

  // the constraints that this rank projects, sorted by colour, vertices as slots of the halo
  template <std::size_t N> struct Constraints {
    std::vector<int> colour;    // of every constraint of the mesh
    int n_colours = 0;
    std::vector<int> first;    // of each colour in the lists below, n_colours + 1 entries
    std::vector<std::array<int, N>> slots;
    std::vector<double> rest, stiffness;    // rest length or angle, k' of (9)
  };

  std::string label;
  int iterations;
  int pinbit;              // 0: nothing is pinned
  double damping;          // rate at which stretching motion decays, 1/time
  double **rest_x;         // rest position of each vertex, unwrapped
  ClothTopology mesh;
  VertexHalo halo;
  std::vector<double> edge_rest, hinge_rest;              // by element of the mesh
  std::vector<double> edge_stiffness, hinge_stiffness;    // k' by type; < 0: not a pbd type
  Constraints<2> distance;
  Constraints<4> bending;
  std::vector<Vec3> p, v;      // predicted positions and velocities, by slot
  std::vector<double> w;       // inverse masses, by slot
  double pin_force[3];         // of the last step, this rank's part

  void read_options(ArgReader &);
  void take_rest_positions(const char *);
  void check_overlap();
  void check_pins();
  void read_stiffness();
  void measure_rest();
  void colour_mesh();
  template <std::size_t N>
  void collect(Constraints<N> &, const ClothElements<N> &, const std::vector<double> &,
               const std::vector<double> &);
  int slot_of_vertex(int, int);
  void ask_for_ghosts(const std::vector<int> &);
  void predict();
  void project_all();
  void damp();
  void finish();
  double largest_strain() const;

  static constexpr int ALL = 0;    // halo channels: all ghosts, then one per colour
  int channel_of_edge_colour(int c) const { return 1 + c; }
  int channel_of_hinge_colour(int c) const { return 1 + distance.n_colours + c; }
};

}    // namespace LAMMPS_NS

#endif
#endif
