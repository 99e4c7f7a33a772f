// SPDX-License-Identifier: GPL-2.0-or-later
// Finds edges that pass through triangles.

#include "contact/tangles.h"

#include "comm.h"
#include "error.h"

#include <array>
#include <string>
#include <vector>

using namespace LAMMPS_NS;
using namespace sphcloth;

namespace {

// in the form in which ranks exchange it

struct Tangle {
  double ids[5];    // of the edge, and of the triangle
  double point[3];
};

constexpr int MAX_EXAMPLES = 3;    // of each rank, and of the message

struct Tangles {
  double count = 0.0;
  std::array<Tangle, MAX_EXAMPLES> example{};

  void add(const Tangle &one)
  {
    if (count < MAX_EXAMPLES) example[static_cast<int>(count)] = one;
    count++;
  }
};

Tangles find_tangles(const MovingTriangles &mesh, const MeshEdges &edges, bool cloth_meets_cloth)
{
  Tangles found;
  for_each_tangle(mesh, edges, cloth_meets_cloth, [&](int e, int t) {
    const auto &[p, q] = edges.edges[e];
    const auto &[a, b, c] = mesh.triangles[t];
    const std::vector<Vec3> &x = mesh.start;
    const Vec3 point = point_of_passing(x[p], x[q], x[a], x[b], x[c]);
    Tangle one{{}, {point[0], point[1], point[2]}};
    const int slots[5] = {p, q, a, b, c};
    for (int k = 0; k < 5; k++) one.ids[k] = static_cast<double>(edges.tag(slots[k]));
    found.add(one);
  });
  return found;
}

}    // namespace

void LAMMPS_NS::check_tangles(LAMMPS *lmp, const MovingTriangles &mesh, const MeshEdges &edges,
                              bool cloth_meets_cloth, const std::string &remedy)
{
  const Tangles mine = find_tangles(mesh, edges, cloth_meets_cloth);
  constexpr int SIZE = sizeof(Tangles) / sizeof(double);
  std::vector<Tangles> all(lmp->comm->nprocs);
  MPI_Allgather(&mine, SIZE, MPI_DOUBLE, all.data(), SIZE, MPI_DOUBLE, lmp->world);

  double count = 0.0;
  int shown = 0;
  std::string examples;
  for (const Tangles &one : all) {
    for (int k = 0; k < MAX_EXAMPLES && k < one.count && shown < MAX_EXAMPLES; k++, shown++) {
      const auto &[ids, point] = one.example[k];
      examples += fmt::format("{}edge {:.0f}-{:.0f} through triangle {:.0f}-{:.0f}-{:.0f} at "
                              "({:.6g}, {:.6g}, {:.6g})",
                              shown ? "; " : "", ids[0], ids[1], ids[2], ids[3], ids[4], point[0],
                              point[1], point[2]);
    }
    count += one.count;
  }
  if (count > 0.0)
    lmp->error->all(FLERR,
                    "{}: cloth starts tangled, {:.0f} edges pass through triangles: {}; {}",
                    mesh.label, count, examples, remedy);
}
