// SPDX-License-Identifier: GPL-2.0-or-later
// Intersection contour minimization: Volino & Magnenat-Thalmann, ACM Trans. Graph. 25 (2006) 1154.
//
// Each rank finds the places where its edges pass through triangles.  All ranks know all of them,
// sort them, and find the same displacements, which ghosts follow without a message.

#include "contact/untangle.h"

#include "atom.h"
#include "comm.h"
#include "contact/tangles.h"
#include "core/contact/intersection_contour.h"
#include "lammps_util/atom_tools.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

using namespace LAMMPS_NS;
using namespace sphcloth;

namespace {

// one edge through one triangle, in the form in which ranks exchange it

struct Passing {
  double vertex[5];    // in the topology: of the edge, of the triangle
  double weight[5];    // of the point; negative in the triangle
  double inverse_mass[5];
  double triangle;    // elements of the mesh
  double beside[2];    // the triangles at the edge, or -1
  double shorter[3];    // minus the gradient of the contour's length

  bool operator<(const Passing &other) const
  {
    return std::lexicographical_compare(vertex, vertex + 5, other.vertex, other.vertex + 5);
  }
};

Passing passing_of(const MovingTriangles &mesh, const MeshEdges &edges, int e, int t)
{
  const auto &[p, q] = edges.edges[e];
  const auto &[a, b, c] = mesh.triangles[t];
  const std::vector<Vec3> &x = mesh.start;
  const Vec3 normal = (x[b] - x[a]).cross(x[c] - x[a]).normalized();
  Passing one{};
  const int slots[5] = {p, q, a, b, c};
  const std::array<double, 5> weight = weights_of_passing(x[p], x[q], x[a], x[b], x[c]);
  for (int k = 0; k < 5; k++) {
    one.vertex[k] = mesh.mesh->topology().index_of(edges.tag(slots[k]));
    one.weight[k] = weight[k];
    one.inverse_mass[k] = mesh.w[slots[k]];
  }
  one.triangle = mesh.element[t];
  one.beside[0] = one.beside[1] = -1.0;
  Vec3 along = Vec3::Zero();
  int n = 0;
  const int owned = edges.vertex_of_lowest(e), other = owned == p ? q : p;
  for (int k = mesh.first[owned]; k < mesh.first[owned + 1]; k++) {
    const int beside = mesh.incident[k];
    for (const int r : mesh.triangles[beside]) {
      const auto &of = mesh.triangles[beside];
      if (r == p || r == q || std::find(of.begin(), of.end(), other) == of.end()) continue;
      along += along_contour(x[p], x[q], x[r], normal);
      if (n < 2) one.beside[n++] = mesh.element[beside];
    }
  }
  const Vec3 shorter = shortening(x[p], x[q], normal, along);
  for (int d = 0; d < 3; d++) one.shorter[d] = shorter[d];
  return one;
}

std::vector<Passing> all_passings(LAMMPS *lmp, const MovingTriangles &mesh, const MeshEdges &edges,
                                  bool cloth_meets_cloth)
{
  std::vector<Passing> mine;
  for_each_tangle(mesh, edges, cloth_meets_cloth,
                  [&](int e, int t) { mine.push_back(passing_of(mesh, edges, e, t)); });
  std::vector<Passing> all = allgather(mine, lmp->comm->nprocs, lmp->world);
  std::sort(all.begin(), all.end());
  return all;
}

// Segments of contours, each in two triangles, joined to contours.  The sign of a segment tells
// whether its lower triangle is on the side of the contour's root.

class Contours {
 public:
  struct Node {
    int root, sign;
  };

  // of an edge that passes through a triangle: +1 if it is on the side of the root
  Node add(const Passing &one)
  {
    const Node node = find(segment(one.beside[0], one.triangle));
    const int sign = one.beside[0] < one.triangle ? 1 : -1;
    if (one.beside[1] >= 0.0) {
      const Node next = find(segment(one.beside[1], one.triangle));
      const int next_sign = one.beside[1] < one.triangle ? 1 : -1;
      if (next.root != node.root)
        parent[next.root] = {node.root, sign * node.sign * next_sign * next.sign};
    }
    return {node.root, sign * node.sign};
  }

  Node of(const Passing &one)
  {
    const Node node = find(segment(one.beside[0], one.triangle));
    return {node.root, one.beside[0] < one.triangle ? node.sign : -node.sign};
  }

  std::size_t size() const { return parent.size(); }

 private:
  std::map<std::pair<double, double>, int> number;
  std::vector<Node> parent;

  int segment(double a, double b)
  {
    const auto [at, is_new] =
        number.try_emplace(std::minmax(a, b), static_cast<int>(parent.size()));
    if (is_new) parent.push_back({at->second, 1});
    return at->second;
  }

  Node find(int s) const
  {
    Node node{s, 1};
    while (parent[node.root].root != node.root)
      node = {parent[node.root].root, node.sign * parent[node.root].sign};
    return node;
  }
};

// A contour moves as a whole: what its ends would do alone cancels along a straight piece.  If it
// cancels over the whole contour, each end moves by itself.

void share_directions(std::vector<Passing> &passings)
{
  constexpr double CANCELED = 0.05;    // the sum, over that of the magnitudes
  Contours contours;
  for (const Passing &one : passings) contours.add(one);
  std::vector<Vec3> sum(contours.size(), Vec3::Zero());
  std::vector<double> magnitude(contours.size(), 0.0);
  for (const Passing &one : passings) {
    const auto [root, sign] = contours.of(one);
    const Vec3 shorter(one.shorter[0], one.shorter[1], one.shorter[2]);
    sum[root] += sign * shorter;
    magnitude[root] += shorter.norm();
  }
  for (Passing &one : passings) {
    const auto [root, sign] = contours.of(one);
    if (!(sum[root].norm() > CANCELED * magnitude[root])) continue;
    const Vec3 direction = sign * sum[root].normalized();
    for (int d = 0; d < 3; d++) one.shorter[d] = direction[d];
  }
}

// Edge and triangle move apart by a step, in inverse proportion to their masses, equal and opposite
// as in ClothRows: masses are split over all places that a vertex takes part in.  By vertex of the
// topology.

std::map<int, Vec3> displacements(const std::vector<Passing> &passings, double step)
{
  constexpr double FULL = 0.1;    // gradient of the contour's length from which a step is whole
  constexpr double LEAST = 0.25;    // share of the mass of a vertex that has little weight
  std::map<int, double> split;
  for (const Passing &one : passings)
    for (int k = 0; k < 5; k++) split[static_cast<int>(one.vertex[k])] += std::fabs(one.weight[k]);
  std::map<int, Vec3> found;
  for (const Passing &one : passings) {
    const Vec3 shorter(one.shorter[0], one.shorter[1], one.shorter[2]);
    const double smallest = LEAST * *std::max_element(one.inverse_mass, one.inverse_mass + 5);
    double w = 0.0;
    for (int k = 0; k < 5; k++) {
      const double shared = split[static_cast<int>(one.vertex[k])];
      w += one.inverse_mass[k] * std::fabs(one.weight[k]) * shared;
    }
    if (!(w > 0.0)) continue;
    const Vec3 apart = step / std::max(FULL, shorter.norm()) / std::max(w, smallest) * shorter;
    for (int k = 0; k < 5; k++)
      found.try_emplace(static_cast<int>(one.vertex[k]), Vec3::Zero()).first->second +=
          one.inverse_mass[k] * one.weight[k] * apart;
  }
  return found;
}

// Moves atoms to where the passes have brought their vertices, and prints how far.

void finish(LAMMPS *lmp, const MovingTriangles &mesh, int passes)
{
  double mine[2] = {0.0, 0.0}, farthest;
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    const double by = (mesh.start[s] - mesh.end[s]).norm();
    if (by == 0.0) continue;
    mine[0] = std::max(mine[0], by);
    mine[1]++;
    double *x = lmp->atom->x[mesh.halo.atom_of(s)];
    for (int d = 0; d < 3; d++) x[d] = mesh.start[s][d];
  }
  double moved;
  MPI_Allreduce(&mine[0], &farthest, 1, MPI_DOUBLE, MPI_MAX, lmp->world);
  MPI_Allreduce(&mine[1], &moved, 1, MPI_DOUBLE, MPI_SUM, lmp->world);
  if (lmp->comm->me == 0)
    utils::logmesg(lmp, "{}: untangled in {} passes: {:.0f} vertices moved, by at most {:.6g}\n",
                   mesh.label, passes, moved, farthest);
}

}    // namespace

bool LAMMPS_NS::untangle(LAMMPS *lmp, MovingTriangles &mesh, const MeshEdges &edges,
                         bool cloth_meets_cloth, double step)
{
  mesh.load_positions();
  std::vector<int> vertex(mesh.halo.n_slots());
  for (int s = 0; s < mesh.halo.n_slots(); s++)
    vertex[s] = mesh.mesh->topology().index_of(edges.tag(s));
  int pass = 0;
  for (; pass < MAX_PASSES_OF_UNTANGLING; pass++) {
    std::vector<Passing> passings = all_passings(lmp, mesh, edges, cloth_meets_cloth);
    if (passings.empty()) break;
    share_directions(passings);
    const std::map<int, Vec3> by = displacements(passings, step);
    for (int s = 0; s < mesh.halo.n_slots(); s++)
      if (const auto found = by.find(vertex[s]); found != by.end()) mesh.start[s] += found->second;
  }
  // what cannot be parted stays as it was given
  if (pass == 0 || pass == MAX_PASSES_OF_UNTANGLING) return false;
  finish(lmp, mesh, pass);
  return true;
}
