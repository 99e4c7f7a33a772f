// SPDX-License-Identifier: GPL-2.0-or-later
// Gathers the bonds, angles and dihedrals of all ranks into one mesh, in an order that does not
// depend on the ranks.

#include "cloth/cloth_topology.h"

#include "atom.h"
#include "comm.h"
#include "core/geometry/buckets.h"
#include "domain.h"
#include "error.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/lammps_version.h"
#include "lammps_util/rank_error.h"

#include <algorithm>
#include <cmath>
#include <tuple>

using namespace LAMMPS_NS;

// One way to write each element, so that two copies of it compare equal: edges ascending,
// triangles rotated to start with the smallest vertex, hinges with the edge ascending.

static void canonical(std::array<int, 2> &e)
{
  if (e[0] > e[1]) std::swap(e[0], e[1]);
}

static void canonical(std::array<int, 3> &t)
{
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
}

static void canonical(std::array<int, 4> &h)
{
  if (h[1] > h[2]) std::reverse(h.begin(), h.end());
}

// What two copies of a canonical element have in common.  A hinge with its wings exchanged is the
// same one, with the other sign of its angle.

template <std::size_t N> static std::array<int, N> identity(const std::array<int, N> &e)
{
  std::array<int, N> same = e;
  if (N == 4 && e.front() > e.back()) std::swap(same.front(), same.back());
  return same;
}

int ClothTopology::index_of(tagint id) const
{
  // most often they are numbers in a row
  if (!ids.empty() && id >= ids.front()) {
    const std::size_t k = id - ids.front();
    if (k < ids.size() && ids[k] == id) return static_cast<int>(k);
  }
  const auto it = std::lower_bound(ids.begin(), ids.end(), id);
  return it != ids.end() && *it == id ? static_cast<int>(it - ids.begin()) : -1;
}

int ClothTopology::image_near(int vertex, int i) const
{
  int j = atom->map(ids[vertex]);
  if (j < 0) return -1;
  // the nearest of the images that are here may still be one across the box
  if (atom->sametag[j] >= 0) j = domain->closest_image(i, j);
  const double *a = atom->x[i], *b = atom->x[j];
  return domain->minimum_image_check(a[0] - b[0], a[1] - b[1], a[2] - b[2]) ? -1 : j;
}

int ClothTopology::image_here(int vertex, int i) const
{
  const int j = image_near(vertex, i);
  if (j < 0)
    rank_error(
        lmp, FLERR,
        "{}: vertex {} is out of reach of vertex {} on this rank: raise the ghost cut-off with "
        "'comm_modify cutoff' to the size of two edges",
        owner, ids[vertex], atom->tag[i]);
  return j;
}

Eigen::Vector3d ClothTopology::from(int i, int vertex) const
{
  const double *a = atom->x[i], *b = atom->x[image_here(vertex, i)];
  return {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
}

std::vector<double> ClothTopology::positions() const
{
  std::vector<double> mine(3 * ids.size(), 0.0), x(mine.size());
  for (int i = 0; i < atom->nlocal; i++)
    if (const int vertex = index_of(atom->tag[i]); vertex >= 0)
      std::copy(atom->x[i], atom->x[i] + 3, &mine[3 * vertex]);
  MPI_Allreduce(mine.data(), x.data(), static_cast<int>(x.size()), MPI_DOUBLE, MPI_SUM, world);
  return x;
}

// Each rank measures a part of the elements.

template <std::size_t N>
double ClothTopology::width_sq(const ClothElements<N> &elements, const std::vector<double> &x) const
{
  double largest = 0.0;
  for (std::size_t m = comm->me; m < elements.size(); m += comm->nprocs)
    for (int a : elements.vertices[m])
      for (int b : elements.vertices[m]) {
        if (b >= a) continue;
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = x[3 * a + k] - x[3 * b + k];
        release::minimum_image(domain, d);
        largest = std::max(largest, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      }
  return largest;
}

void ClothTopology::measure()
{
  const std::vector<double> x = positions();
  const double of_triangles = width_sq(triangles, x);
  const double here[2] = {of_triangles,
                          std::max({of_triangles, width_sq(edges, x), width_sq(hinges, x)})};
  double all[2];
  MPI_Allreduce(here, all, 2, MPI_DOUBLE, MPI_MAX, world);
  longest = std::sqrt(all[0]);
  widest = std::sqrt(all[1]);
}

void ClothTopology::measure_triangles()
{
  const double here = width_sq(triangles, positions());
  double all;
  MPI_Allreduce(&here, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  longest = std::sqrt(all);
}

void ClothTopology::gather(int groupbit, Leaving leaving)
{
  const int nlocal = atom->nlocal;
  std::vector<tagint> mine;
  for (int i = 0; i < nlocal; i++)
    if (atom->mask[i] & groupbit) mine.push_back(atom->tag[i]);
  ids = allgather(mine, comm->nprocs, world);
  std::sort(ids.begin(), ids.end());

  gather_elements(edges, "bond", leaving, atom->num_bond, [&](int i, int m, auto add) {
    add({atom->tag[i], atom->bond_atom[i][m]}, atom->bond_type[i][m]);
  });
  gather_elements(triangles, "angle", leaving, atom->num_angle, [&](int i, int m, auto add) {
    add({atom->angle_atom1[i][m], atom->angle_atom2[i][m], atom->angle_atom3[i][m]},
        atom->angle_type[i][m]);
  });
  gather_elements(hinges, "dihedral", leaving, atom->num_dihedral, [&](int i, int m, auto add) {
    add({atom->dihedral_atom1[i][m], atom->dihedral_atom2[i][m], atom->dihedral_atom3[i][m],
         atom->dihedral_atom4[i][m]},
        atom->dihedral_type[i][m]);
  });
}

// counts: of each atom, null where the atom style has no such elements

template <std::size_t N, class Collect>
void ClothTopology::gather_elements(ClothElements<N> &elements, const char *what, Leaving leaving,
                                    const int *counts, Collect collect)
{
  // elements of owned atoms with at least one vertex in the cloth, or all, as N IDs and a type
  std::vector<tagint> mine;
  const auto take = [&](const std::array<tagint, N> &members, int type) {
    if (type <= 0) return;    // switched off by LAMMPS
    bool any = false, all = true;
    for (tagint id : members) {
      any = any || index_of(id) >= 0;
      all = all && index_of(id) >= 0;
    }
    if (!any || (!all && leaving == Leaving::LEFT_OUT)) return;
    mine.insert(mine.end(), members.begin(), members.end());
    mine.push_back(type);
  };
  for (int i = 0; counts && i < atom->nlocal; i++)
    for (int m = 0; m < counts[i]; m++) collect(i, m, take);
  const std::vector<tagint> all = allgather(mine, comm->nprocs, world);

  struct Element {
    std::array<int, N> vertices;
    int type;
  };
  std::vector<Element> sorted(all.size() / (N + 1));
  for (std::size_t m = 0; m < sorted.size(); m++) {
    const tagint *record = &all[m * (N + 1)];
    for (std::size_t k = 0; k < N; k++) {
      sorted[m].vertices[k] = index_of(record[k]);
      if (sorted[m].vertices[k] < 0)
        error->all(
            FLERR,
            "{}: a {} of atom {} leaves the group at atom {}: put both into the fix group or "
            "delete the {}",
            owner, what, record[k ? 0 : 1], record[k], what);
    }
    canonical(sorted[m].vertices);
    sorted[m].type = static_cast<int>(record[N]);
  }
  // Copies of an element are one, written as that with the lowest IDs first.  Those of another type
  // are constraints of their own, but a triangle is none: it has its lowest type.
  std::sort(sorted.begin(), sorted.end(), [](const Element &a, const Element &b) {
    return std::make_tuple(identity(a.vertices), a.type, a.vertices) <
        std::make_tuple(identity(b.vertices), b.type, b.vertices);
  });
  const auto last =
      std::unique(sorted.begin(), sorted.end(), [](const Element &a, const Element &b) {
        return identity(a.vertices) == identity(b.vertices) && (N == 3 || a.type == b.type);
      });
  sorted.erase(last, sorted.end());
  std::sort(sorted.begin(), sorted.end(), [](const Element &a, const Element &b) {
    return std::tie(a.vertices, a.type) < std::tie(b.vertices, b.type);
  });

  elements.vertices.clear();
  elements.type.clear();
  for (const Element &e : sorted) {
    elements.vertices.push_back(e.vertices);
    elements.type.push_back(e.type);
  }
  const auto for_each = [&](auto add) {
    for (std::size_t m = 0; m < sorted.size(); m++)
      for (int v : sorted[m].vertices) add(static_cast<std::size_t>(v), static_cast<int>(m));
  };
  sphcloth::sort_into_buckets(n_vertices(), for_each, elements.first, elements.incident);
}
