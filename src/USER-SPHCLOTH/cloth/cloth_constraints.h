// SPDX-License-Identifier: GPL-2.0-or-later
// The constraints of one cloth: what its mesh, its rest positions and the coefficients of its types
// say, the same on every rank, and after each list build those that this rank projects.

#ifndef SPHCLOTH_CLOTH_CLOTH_CONSTRAINTS_H
#define SPHCLOTH_CLOTH_CLOTH_CONSTRAINTS_H

#include "cloth/cloth_topology.h"
#include "cloth/cloth_vertices.h"
#include "cloth/rest_box.h"
#include "cloth/vertex_halo.h"
#include "core/pbd/cloth_solver.h"
#include "lammps_util/particle_columns.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

struct PBDMaterial;

class ClothConstraints : protected Pointers {
 public:
  // owner: the fix, for error messages

  ClothConstraints(LAMMPS *lmp_, std::string owner_, const ClothTopology &mesh_) :
      Pointers(lmp_), owner(std::move(owner_)), mesh(mesh_), edges(mesh.edges), hinges(mesh.hinges)
  {
  }

  // 1. when the mesh was gathered.  rest_x: rest position of each atom, three columns.  sweeps:
  // that many together do what a stiffness says.  at_once: a sweep sees none of itself, so that a
  // constraint may do only a share.

  void measure_rest(int groupbit, const ParticleColumns &rest_x, const RestBox &rest_box);
  void color(int sweeps, bool at_once);

  // 2. after each list build, between reset() and connect() of the halo, which must have that many
  // channels: all ghosts, then the vertices of one color each

  int n_channels() const { return channel_of_hinge_color(hinges.colors); }
  void collect(VertexHalo &);

  // before a step dt: stiffnesses are those of the springs that they are in a step `reference`
  void rescale_stiffness(double reference, double dt)
  {
    const double ratio = (reference / dt) * (reference / dt);
    distance.rescale_stiffness(ratio);
    bending.rescale_stiffness(ratio);
  }

  bool any_soft_k() const;    // of the whole mesh: between 0 and 1

  static constexpr int ALL = 0;
  int channel_of_edge_color(int c) const { return 1 + c; }
  int channel_of_hinge_color(int c) const { return 1 + edges.colors * edges.layers + c; }

  // what this rank projects, with slots of the halo as vertices.  A type may be several constraints
  // at once: the colors of the second of each edge are behind those of the first.
  sphcloth::Constraints<2> distance;
  sphcloth::Constraints<4> bending;
  int edge_colors() const { return edges.colors; }    // of the first

  // of edge and hinge m of the mesh; an edge without a length or a constraint has no strain
  double rest_length(int m) const { return edges.rest[m]; }
  double rest_angle(int m) const { return hinges.rest[m]; }
  bool has_strain(int m) const;
  double mean_length() const { return mean; }
  // rest length of the shortest edge at an owned vertex, infinite without any; a seam, which closes
  // to nothing, does not count
  double shortest_edge(int owned_atom) const;
  // of this rank's edges, but for those between vertices that are both in a group of held_bits
  double largest_strain(const VertexHalo &, int held_bits) const;
  // an edge over half a periodic box ends the run; vertices where the last step has left them,
  // ghosts too
  void check_lengths(const ClothVertices &) const;

 private:
  template <std::size_t N> struct Kind {
    explicit Kind(const ClothElements<N> &elements_) : elements(elements_) {}

    const ClothElements<N> &elements;
    std::vector<double> rest;    // length or angle, by element
    std::vector<double> lever;    // mean square of the gradients in the rest shape, by element
    std::vector<int> color;
    int colors = 0, layers = 1;
    std::vector<std::vector<sphcloth::Spring>> springs;    // of a unit rest value, by type
  };

  template <std::size_t N> struct Found {
    int element;
    std::array<int, N> slots;
  };
  template <std::size_t N> using ByColor = std::vector<std::vector<Found<N>>>;
  ByColor<2> found_edges;
  ByColor<4> found_hinges;
  std::vector<int> found_for;    // mesh vertex of each slot
  bool known_without_ghosts = false;

  std::string owner;
  const ClothTopology &mesh;
  Kind<2> edges;
  Kind<4> hinges;
  double mean = 0.0;
  std::vector<int> constraints_of;    // of a mesh vertex: how many; empty: not at once

  const PBDMaterial *material_of_edge(int type) const;
  const PBDMaterial *material_of_hinge(int type) const;
  template <std::size_t N> void count(const Kind<N> &);
  template <std::size_t N> double share_of(const std::array<int, N> &vertices) const;
  double size_of(const sphcloth::Spring &, const Kind<2> &) const;
  double size_of(const sphcloth::Spring &, const Kind<4> &) const { return 1.0; }
  template <std::size_t N>
  ByColor<N> find(const Kind<N> &, VertexHalo &, const std::vector<int> &vertex_of_slot) const;
  template <std::size_t N>
  void fill(sphcloth::Constraints<N> &, const Kind<N> &, const ByColor<N> &, int idle) const;
  void ask_for_ghosts(VertexHalo &) const;
};

}    // namespace LAMMPS_NS

#endif
