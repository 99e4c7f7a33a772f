// SPDX-License-Identifier: GPL-2.0-or-later
// One row per edge or hinge of the mesh that this rank owns.

#include "compute_pbd_local.h"

#include "atom.h"
#include "core/pbd/constraints.h"
#include "core/util/bytes.h"
#include "fix_pbd_cloth.h"
#include "lammps_util/arg_reader.h"
#include "memory.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

/* ----------------------------------------------------------------------
   compute ID group pbd/local fix-ID edge|hinge keyword ...
------------------------------------------------------------------------- */

ComputePBDLocal::ComputePBDLocal(LAMMPS *lmp_, int narg, char **arg) :
    Compute(lmp_, narg, arg), label(fmt::format("compute {} pbd/local", id)), room(0),
    cloth(nullptr)
{
  ArgReader args(lmp, label, narg, arg, 3);
  cloth_id = args.word("ID of a fix pbd/cloth");
  of_hinges = args.choice("kind", {"edge", "hinge"}) == 1;
  FixPBDCloth::find(lmp, label, cloth_id);
  const std::vector<std::string> known = of_hinges
      ? std::vector<std::string>{"id1", "id2", "id3", "id4", "type", "rest", "angle", "curvature"}
      : std::vector<std::string>{"id1", "id2", "type", "rest", "length", "strain"};
  do columns.push_back(args.choice("keyword", known));
  while (args.more());

  local_flag = 1;
  size_local_cols = columns.size() == 1 ? 0 : static_cast<int>(columns.size());
}

ComputePBDLocal::~ComputePBDLocal()
{
  memory->destroy(vector_local);
  memory->destroy(array_local);
}

void ComputePBDLocal::init() { cloth = FixPBDCloth::find(lmp, label, cloth_id); }

/* ---------------------------------------------------------------------- */

void ComputePBDLocal::compute_local()
{
  invoked_local = update->ntimestep;
  cloth = FixPBDCloth::find(lmp, label, cloth_id);
  const ClothTopology &mesh = cloth->topology();
  rows.clear();
  if (of_hinges)
    collect(mesh.hinges, [this](int m, int i) { return measure_hinge(m, i); });
  else
    collect(mesh.edges, [this](int m, int i) { return measure_edge(m, i); });

  size_local_rows = static_cast<int>(rows.size());
  const int n = static_cast<int>(columns.size());
  if (size_local_rows > room) {
    room = size_local_rows;
    if (n == 1)
      memory->grow(vector_local, room, "pbd/local:vector");
    else
      memory->grow(array_local, room, n, "pbd/local:array");
  }
  for (int r = 0; r < size_local_rows; r++) {
    double *row = n == 1 ? vector_local + r : array_local[r];
    for (int k = 0; k < n; k++) row[k] = rows[r][columns[k]];
  }
}

// an element is on the rank that owns its first vertex

template <std::size_t N, class Measure>
void ComputePBDLocal::collect(const ClothElements<N> &elements, Measure measure)
{
  const ClothTopology &mesh = cloth->topology();
  for (std::size_t m = 0; m < elements.size(); m++) {
    const auto &vertices = elements.vertices[m];
    const int i = atom->map(mesh.ids[vertices[0]]);
    if (i < 0 || i >= atom->nlocal) continue;
    bool in_group = true;
    for (int vertex : vertices)
      in_group = in_group && atom->mask[mesh.image_here(vertex, i)] & groupbit;
    if (!in_group) continue;
    Row row;
    for (std::size_t q = 0; q < N; q++) row[q] = static_cast<double>(mesh.ids[vertices[q]]);
    row[N] = elements.type[m];
    const std::array<double, 3> measured = measure(static_cast<int>(m), i);
    std::copy(measured.begin(), measured.end(), row.begin() + N + 1);
    rows.push_back(row);
  }
}

// rest length, length, strain

std::array<double, 3> ComputePBDLocal::measure_edge(int m, int i) const
{
  const ClothTopology &mesh = cloth->topology();
  const double rest = cloth->rest().rest_length(m),
               length = mesh.from(i, mesh.edges.vertices[m][1]).norm();
  return {rest, length, cloth->rest().has_strain(m) ? length / rest - 1.0 : 0.0};
}

// Rest angle, angle, curvature: the angle is spread over a third of the heights of the two
// triangles, as in Grinspun, Hirani, Desbrun & Schroeder, SCA 2003.  A hinge without an angle has
// none.

std::array<double, 3> ComputePBDLocal::measure_hinge(int m, int i) const
{
  const ClothTopology &mesh = cloth->topology();
  const auto &[a, e1, e2, b] = mesh.hinges.vertices[m];
  const Vec3 p1 = mesh.from(i, e1), p2 = mesh.from(i, e2), pb = mesh.from(i, b);
  const Vec3 edge = p2 - p1;
  const double angle = hinge_angle(Vec3::Zero(), p1, p2, pb);
  if (std::isnan(angle)) return {cloth->rest().rest_angle(m), 0.0, 0.0};
  const double heights = (edge.cross(p1).norm() + edge.cross(pb - p1).norm()) / edge.norm();
  return {cloth->rest().rest_angle(m), angle, 3.0 * angle / heights};
}

double ComputePBDLocal::memory_usage()
{
  return static_cast<double>(room * columns.size() * sizeof(double)) + bytes_of(rows);
}
