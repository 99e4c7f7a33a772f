// SPDX-License-Identifier: GPL-2.0-or-later
// Collects the triangles in reach of a rank, and checks their winding.

#include "contact/triangle_set.h"

#include "atom.h"
#include "contact/triangle_ends.h"
#include "error.h"
#include "lammps_util/rank_error.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

using namespace LAMMPS_NS;

TriangleSet::TriangleSet(LAMMPS *lmp_, ContactMesh *mesh_, const std::string &label_) :
    Pointers(lmp_), label(label_), mesh(mesh_), halo(lmp), ghosts(lmp, label)
{
}

Eigen::Vector3d TriangleSet::position(int slot) const
{
  const double *x = atom->x[halo.atom_of(slot)];
  return {x[0], x[1], x[2]};
}

void TriangleSet::rebuild(double max_distance)
{
  if (at_border.empty()) find_border();
  std::vector<int> owned, reach;
  for (int i = 0; i < atom->nlocal + atom->nghost; i++) {
    if (!mesh->has_vertex(i)) continue;
    reach.push_back(i);
    if (i < atom->nlocal) owned.push_back(i);
  }
  halo.reset(1, owned);
  triangles.clear();
  element.clear();
  add_triangles(reach);
  for (int s = halo.n_owned(); s < halo.n_slots(); s++) halo.need(s, 0);
  halo.connect();
  find_incident();
  check_reach(max_distance);
}

// Every image of a triangle once, from the view of its first vertex; an image with a ghost vertex
// out of reach is too far from this rank's particles to matter.

void TriangleSet::add_triangles(const std::vector<int> &reach)
{
  const ClothTopology &cloth = mesh->topology();
  const ClothElements<3> &t = cloth.triangles;
  for (int i : reach) {
    const int vertex = cloth.index_of(atom->tag[i]);
    if (vertex < 0) continue;
    for (int k = t.first[vertex]; k < t.first[vertex + 1]; k++) {
      const std::array<int, 3> &members = t.vertices[t.incident[k]];
      if (members[0] != vertex) continue;
      const int j = cloth.image_near(members[1], i), l = cloth.image_near(members[2], i);
      if ((j < 0 || l < 0) && i < atom->nlocal)
        rank_error(
            lmp, FLERR,
            "{}: the triangle of vertices {}, {} and {} is larger than the ghost cut-off: raise "
            "it with 'comm_modify cutoff', or refine the mesh",
            label, cloth.ids[vertex], cloth.ids[members[1]], cloth.ids[members[2]]);
      if (j < 0 || l < 0) continue;
      triangles.push_back({halo.slot_of(i), halo.slot_of(j), halo.slot_of(l)});
      element.push_back(t.incident[k]);
    }
  }
}

void TriangleSet::find_incident()
{
  first.assign(halo.n_slots() + 2, 0);
  for (const std::array<int, 3> &t : triangles)
    for (int s : t) first[s + 2]++;
  std::partial_sum(first.begin(), first.end(), first.begin());
  incident.resize(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); t++)
    for (int s : triangles[t]) incident[first[s + 1]++] = static_cast<int>(t);
}

void TriangleSet::check_reach(double max_distance)
{
  if (!ghosts.matters()) return;
  double longest_sq = 0.0;
  for (const std::array<int, 3> &t : triangles)
    for (int q = 0; q < 3; q++) {
      const double *a = atom->x[halo.atom_of(t[q])], *b = atom->x[halo.atom_of(t[(q + 1) % 3])];
      longest_sq =
          std::max(longest_sq, (Vec3(a[0], a[1], a[2]) - Vec3(b[0], b[1], b[2])).squaredNorm());
    }
  longest_here = std::sqrt(longest_sq);
  const double needed = longest_here + max_distance, reach = ghosts.reach();
  if (needed > reach)
    rank_error(
        lmp, FLERR,
        "{}: the longest edge of the mesh and the reach of its triangles are {}, more than the "
        "ghost cut-off {}: raise it with 'comm_modify cutoff', or refine the mesh",
        label, needed, reach);
}

void TriangleSet::find_border()
{
  const auto is_watertight = [this](std::size_t m) { return passing.empty() || passing[m] == 0; };
  const auto at = count_at_edges(mesh->topology(), is_watertight);
  at_border.resize(at.size());
  for (std::size_t m = 0; m < at.size(); m++)
    for (int q = 0; q < 3; q++) at_border[m][q] = is_watertight(m) && at[m][q].chosen == 1;
}

bool TriangleSet::let_through(int first_type, int last_type, int groupbit)
{
  const std::vector<int> &type = mesh->topology().triangles.type;
  const auto is_of = [&](int one) { return one >= first_type && one <= last_type; };
  if (std::none_of(type.begin(), type.end(), is_of)) return false;
  passing.resize(type.size(), 0);
  for (std::size_t m = 0; m < type.size(); m++)
    if (is_of(type[m])) passing[m] |= groupbit;
  at_border.clear();
  return true;
}

bool TriangleSet::is_open()
{
  if (at_border.empty()) find_border();
  return std::any_of(at_border.begin(), at_border.end(),
                     [](const auto &sides) { return sides[0] || sides[1] || sides[2]; });
}

void TriangleSet::check_winding() const
{
  const ClothTopology &cloth = mesh->topology();
  std::map<std::array<int, 2>, int> at_edge;    // as a triangle runs along it
  for (const auto &t : cloth.triangles.vertices)
    for (int q = 0; q < 3; q++)
      if (++at_edge[{t[q], t[(q + 1) % 3]}] > 1)
        error->all(
            FLERR,
            "{}: two triangles run from vertex {} to vertex {}: a mesh with two sides must be "
            "wound alike everywhere ('sphcloth mesh' does that); or give 'sides no'",
            label, cloth.ids[t[q]], cloth.ids[t[(q + 1) % 3]]);
}
