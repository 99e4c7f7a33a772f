// SPDX-License-Identifier: GPL-2.0-or-later
// The triangles of one mesh that are within reach of a rank, and where their vertices are.

#ifndef SPHCLOTH_CONTACT_TRIANGLE_SET_H
#define SPHCLOTH_CONTACT_TRIANGLE_SET_H

#include "cloth/vertex_halo.h"
#include "contact/contact_mesh.h"
#include "lammps_util/ghost_reach.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class TriangleSet : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  TriangleSet(LAMMPS *, ContactMesh *, const std::string &label);

  // after each list build; a particle must see the whole of each triangle that is nearer than this
  void rebuild(double max_distance);

  // Is any there, on any rank?
  bool has_triangles() const { return mesh->topology().triangles.size() > 0; }

  // sides need triangles that are wound alike
  void check_winding() const;

  const std::string label;    // for error messages
  ContactMesh *const mesh;
  VertexHalo halo;
  std::vector<std::array<int, 3>> triangles;    // slots
  std::vector<int> element;    // of the mesh, of each triangle
  std::vector<int> first, incident;    // triangles at slot s: incident[first[s] .. first[s+1])

  // Has the mesh a border?  One without it has all fluid on one side.
  bool is_open();

  // Triangles of these types let particles of these groups through, for the rest of a run: fix
  // cloth/pores.  To contact, sides and walls the mesh ends where they begin.
  bool let_through(int first_type, int last_type, int groupbit);    // are there any?
  bool has_pores() const { return !passing.empty(); }
  bool is_porous(int t) const { return !passing.empty() && passing[element[t]] != 0; }
  bool lets_through(int t, int mask) const
  {
    return !passing.empty() && (passing[element[t]] & mask) != 0;
  }

  // nothing is beyond the edge of an element that is opposite to a vertex
  bool is_border(int m, int opposite) const { return at_border[m][opposite]; }

  // is a point of a triangle, by its barycentric weights, on the border?
  bool is_on_border(int t, const Vec3 &weight) const
  {
    for (int q = 0; q < 3; q++)
      if (weight[q] <= 0.0 && is_border(element[t], q)) return true;
    return false;
  }

  // of the triangles that are here, at the last list build
  double longest_edge_here() const { return longest_here; }

  // vertices as they are now, ghosts too
  Vec3 position(int slot) const;

 private:
  std::vector<std::array<bool, 3>> at_border;    // of each element
  std::vector<int> passing;    // bits of groups that an element lets through; empty: none does

  GhostReach ghosts;
  double longest_here = 0.0;

  void find_border();
  void find_incident();
  void add_triangles(const std::vector<int> &reach);
  void check_reach(double max_distance);
};

}    // namespace LAMMPS_NS

#endif
