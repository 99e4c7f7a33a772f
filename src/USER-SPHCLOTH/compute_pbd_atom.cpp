// SPDX-License-Identifier: GPL-2.0-or-later
// Strain, normal, area and mean curvature at vertices, from the edges and triangles around each.

#include "compute_pbd_atom.h"

#include "atom.h"
#include "fix_pbd_cloth.h"
#include "lammps_util/arg_reader.h"
#include "memory.h"
#include "update.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   compute ID group pbd/atom fix-ID keyword ...
------------------------------------------------------------------------- */

ComputePBDAtom::ComputePBDAtom(LAMMPS *lmp_, int narg, char **arg) :
    Compute(lmp_, narg, arg), label(fmt::format("compute {} pbd/atom", id)), nmax(0), cloth(nullptr)
{
  ArgReader args(lmp, label, narg, arg, 3);
  cloth_id = args.word("ID of a fix pbd/cloth");
  FixPBDCloth::find(lmp, label, cloth_id);
  do
    columns.push_back(static_cast<Column>(args.choice(
        "keyword", {"strain", "curvature", "area", "nx", "ny", "nz", "fx", "fy", "fz"})));
  while (args.more());

  peratom_flag = 1;
  size_peratom_cols = columns.size() == 1 ? 0 : static_cast<int>(columns.size());
}

ComputePBDAtom::~ComputePBDAtom()
{
  memory->destroy(vector_atom);
  memory->destroy(array_atom);
}

bool ComputePBDAtom::asks_for(Column first, Column last) const
{
  return std::any_of(columns.begin(), columns.end(),
                     [=](Column c) { return first <= c && c <= last; });
}

void ComputePBDAtom::init()
{
  FixPBDCloth *found = FixPBDCloth::find(lmp, label, cloth_id);
  if (asks_for(Column::FX, Column::FZ)) found->want_reaction_forces();
  cloth = found;
}

/* ---------------------------------------------------------------------- */

void ComputePBDAtom::compute_peratom()
{
  invoked_peratom = update->ntimestep;
  cloth = FixPBDCloth::find(lmp, label, cloth_id);
  make_room();
  const int n = static_cast<int>(columns.size());
  const bool in_sheet = asks_for(Column::CURVATURE, Column::NZ);
  for (int i = 0; i < atom->nlocal; i++) {
    double *row = n == 1 ? vector_atom + i : array_atom[i];
    const bool vertex = atom->mask[i] & groupbit && atom->mask[i] & cloth->groupbit;
    const VertexGeometry geometry = vertex && in_sheet ? geometry_of(i) : VertexGeometry();
    for (int k = 0; k < n; k++) row[k] = vertex ? value(columns[k], i, geometry) : 0.0;
  }
}

void ComputePBDAtom::make_room()
{
  if (atom->nmax <= nmax) return;
  nmax = atom->nmax;
  if (size_peratom_cols == 0)
    memory->grow(vector_atom, nmax, "pbd/atom:vector");
  else
    memory->grow(array_atom, nmax, size_peratom_cols, "pbd/atom:array");
}

double ComputePBDAtom::value(Column column, int i, const VertexGeometry &geometry) const
{
  switch (column) {
    case Column::STRAIN: return strain(i);
    case Column::CURVATURE: return geometry.curvature;
    case Column::AREA: return geometry.area;
    case Column::NX:
    case Column::NY:
    case Column::NZ:
      return geometry.normal[static_cast<int>(column) - static_cast<int>(Column::NX)];
    default:
      return cloth->reaction_force(i)[static_cast<int>(column) - static_cast<int>(Column::FX)];
  }
}

// the largest in size of its edges, with its sign

double ComputePBDAtom::strain(int i) const
{
  const ClothTopology &mesh = cloth->topology();
  const int vertex = mesh.index_of(atom->tag[i]);
  double largest = 0.0;
  for (int k = mesh.edges.first[vertex]; k < mesh.edges.first[vertex + 1]; k++) {
    const int m = mesh.edges.incident[k];
    if (!cloth->rest().has_strain(m)) continue;
    const auto &[a, b] = mesh.edges.vertices[m];
    const double strain =
        mesh.from(i, a == vertex ? b : a).norm() / cloth->rest().rest_length(m) - 1.0;
    if (std::fabs(strain) > std::fabs(largest)) largest = strain;
  }
  return largest;
}

// What a triangle of a vertex and edges b and c from it adds: Meyer, Desbrun, Schroeder & Barr,
// Visualization and Mathematics III (2003) 35, section 3.3: its Voronoi region, or a half or
// quarter of an obtuse triangle.

static double mixed_area(const Eigen::Vector3d &b, const Eigen::Vector3d &c)
{
  const double twice = b.cross(c).norm(), at_vertex = b.dot(c), at_b = b.dot(b - c),
               at_c = c.dot(c - b);
  if (at_vertex < 0.0) return 0.25 * twice;
  if (at_b < 0.0 || at_c < 0.0) return 0.125 * twice;
  return (c.squaredNorm() * at_b + b.squaredNorm() * at_c) / (8.0 * twice);
}

// Mean curvature H from the gradient of the area of the triangles around, 2 H A n: the same,
// equation (8).

ComputePBDAtom::VertexGeometry ComputePBDAtom::geometry_of(int i) const
{
  const ClothTopology &mesh = cloth->topology();
  const ClothElements<3> &t = mesh.triangles;
  const int vertex = mesh.index_of(atom->tag[i]);
  Vec3 sum = Vec3::Zero(), gradient = Vec3::Zero();
  VertexGeometry geometry;
  double mixed = 0.0;
  for (int k = t.first[vertex]; k < t.first[vertex + 1]; k++) {
    std::array<int, 3> members = t.vertices[t.incident[k]];
    std::rotate(members.begin(), std::find(members.begin(), members.end(), vertex), members.end());
    const Vec3 b = mesh.from(i, members[1]), c = mesh.from(i, members[2]);
    const Vec3 twice = b.cross(c);    // the area, twice
    if (twice.squaredNorm() == 0.0) continue;
    geometry.area += twice.norm() / 6.0;
    mixed += mixed_area(b, c);
    sum += twice;
    gradient += 0.5 * (b - c).cross(twice.normalized());
  }
  if (sum.squaredNorm() == 0.0) return geometry;
  geometry.normal = sum.normalized();
  geometry.curvature = gradient.dot(geometry.normal) / (2.0 * mixed);
  return geometry;
}

double ComputePBDAtom::memory_usage()
{
  return sizeof(double) * static_cast<double>(nmax) * static_cast<double>(columns.size());
}
