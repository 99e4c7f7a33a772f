// SPDX-License-Identifier: GPL-2.0-or-later
// The mesh of one cloth, the same on every rank: vertices by global ID, edges (LAMMPS bonds),
// triangles (angles) and hinges (dihedrals).

#ifndef SPHCLOTH_CLOTH_CLOTH_TOPOLOGY_H
#define SPHCLOTH_CLOTH_CLOTH_TOPOLOGY_H

#include "pointers.h"

#include <Eigen/Core>

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// elements of N vertices each, sorted, without duplicates

template <std::size_t N> struct ClothElements {
  std::vector<std::array<int, N>> vertices;    // indices into ClothTopology::ids
  std::vector<int> type;
  std::vector<int> first, incident;    // elements of vertex v: incident[first[v] .. first[v+1])

  std::size_t size() const { return vertices.size(); }
};

class ClothTopology : protected Pointers {
 public:
  // owner: the style that asks, for error messages

  ClothTopology(LAMMPS *lmp_, std::string owner_) : Pointers(lmp_), owner(std::move(owner_)) {}

  // collective: collects what the atoms of the group carry; an element that leaves the group is
  // an error, or left out

  enum class Leaving { REFUSED, LEFT_OUT };
  void gather(int groupbit, Leaving = Leaving::REFUSED);

  std::vector<tagint> ids;    // of the vertices, ascending
  ClothElements<2> edges;
  ClothElements<3> triangles;
  ClothElements<4> hinges;    // wing, edge, edge, wing

  // collective: x, y, z of all vertices, where the atoms are now
  std::vector<double> positions() const;
  // collective: from the positions of the atoms, which must not be farther apart than half a
  // periodic box
  void measure();
  void measure_triangles();    // alone
  double longest_edge() const { return longest; }    // of the triangles
  double widest_element() const { return widest; }

  int n_vertices() const { return static_cast<int>(ids.size()); }
  int index_of(tagint id) const;    // -1 if it is no vertex

  // the image of a vertex next to atom i, owned or ghost; -1 if this rank holds none
  int image_near(int vertex, int i) const;

  // the same, and the vector to it from atom i; it is an error if this rank holds none
  int image_here(int vertex, int i) const;
  Eigen::Vector3d from(int i, int vertex) const;

 private:
  std::string owner;
  double longest = 0.0, widest = 0.0;

  template <std::size_t N, class Collect>
  void gather_elements(ClothElements<N> &, const char *, Leaving, const int *, Collect);
  // of this rank's share of the elements
  template <std::size_t N>
  double width_sq(const ClothElements<N> &, const std::vector<double> &x) const;
};

}    // namespace LAMMPS_NS

#endif
