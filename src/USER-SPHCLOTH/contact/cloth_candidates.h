// SPDX-License-Identifier: GPL-2.0-or-later
// Broad phase of cloth with cloth and with obstacles: the vertices and triangles, and the edges, of
// a mesh that may meet in a step.  Each pair is on one rank: that of its vertex, or of the vertex
// of both edges, of the cloth alone if the other is of an obstacle, that has the lowest ID.
//
// The list is made with a margin.  It holds while patches of vertices stay within that, but for
// what they move as a whole, also over list builds of LAMMPS that leave vertices where they were.
// Which pairs are visited does not depend on when it was made.

#ifndef SPHCLOTH_CONTACT_CLOTH_CANDIDATES_H
#define SPHCLOTH_CONTACT_CLOTH_CANDIDATES_H

#include "contact/mesh_edges.h"
#include "contact/moving_triangles.h"
#include "contact/patch_pairs.h"
#include "core/contact/closest_points.h"
#include "core/geometry/disc_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace LAMMPS_NS {

struct ClothPair {
  sphcloth::PairKind kind;
  std::array<int, 4> slots;    // vertex and triangle, or two edges
  std::array<int, 2> members;    // triangle: the second; edges: both
  bool with_obstacle;
  bool joined;    // by a bond that is shorter than the thickness: a seam
  double distance;    // when the list was made
};

class ClothCandidates : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  ClothCandidates(LAMMPS *lmp_, const MovingTriangles &mesh_, const MeshEdges &edges_,
                  const ClothRules &rules_) :
      Pointers(lmp_), rules(rules_), mesh(mesh_), edges(edges_)
  {
  }

  // After each list build of LAMMPS: pairs of the same vertices and triangles are kept.
  void rebuild();

  // After each change of the sweeps of vertices.  The two sides of a pair are taken to approach by
  // at most `max_approach` in this step.
  void update(double max_approach = std::numeric_limits<double>::infinity());

  // Pairs that may come as near as `reach`, at most max_reach(), in this step, in an order of their
  // own: visit(pair, closest points at the start of the step).
  template <class Visit> void for_near(double reach, Visit visit) const
  {
    for (int k = 0; k < patches.size(); k++) {
      const double reach_then = reach + patches.approach(k);
      if (nearest[k] > reach_then) continue;
      for (int n = first[k]; n < first[k + 1]; n++) {
        const ClothPair &pair = pairs[order[n]];
        if (pair.distance > reach_then) continue;
        const std::array<int, 4> &s = pair.slots;
        const sphcloth::ClosestPoints at = closest_points(
            pair.kind, {mesh.start[s[0]], mesh.start[s[1]], mesh.start[s[2]], mesh.start[s[3]]});
        const double room = at.vector.norm() - reach;
        if (room <= 0.0 || (room <= limit && room <= longest_approach(pair))) visit(pair, at);
      }
    }
  }
  double max_reach() const;
  const ClothRules rules;

  double memory_usage() const;

 private:
  const MovingTriangles &mesh;
  const MeshEdges &edges;
  std::vector<ClothPair> pairs;
  // by pairs of patches: pairs[order[first[k]]] to pairs[order[first[k + 1] - 1]], and the nearest
  PatchPairs patches;
  std::vector<int> first, order, patches_of;
  std::vector<double> nearest;
  std::array<int, 2> last_patches{};    // of the last pair that was found, and their number
  int last_pair = 0;
  bool known = false;
  // of the list
  std::vector<tagint> tags;
  std::vector<std::array<int, 3>> triangles;
  double cutoff = 0.0, patch_range = 0.0;    // of pairs, and of patches
  double limit = 0.0;    // of an approach
  // of a search: triangles and edges of cloth, or of obstacles
  std::vector<int> triangles_there, edges_there;
  std::vector<sphcloth::Disc> discs;
  sphcloth::DiscGrid disc_grid;
  std::vector<sphcloth::Box> boxes;
  sphcloth::BoxGrid box_grid;

  // how much nearer to one another both sides may come in this step
  double longest_approach(const ClothPair &pair) const
  {
    const int n = sphcloth::first_side(pair.kind);
    double longest_sq = 0.0;
    for (int i = 0; i < n; i++)
      for (int j = n; j < 4; j++)
        longest_sq = std::max(longest_sq,
                              (stride_of(pair.slots[i]) - stride_of(pair.slots[j])).squaredNorm());
    return std::sqrt(longest_sq);
  }
  Vec3 stride_of(int slot) const { return mesh.end[slot] - mesh.start[slot]; }
  double margin() const;
  bool holds() const;
  void find();
  void find_among(bool obstacles);
  void find_triangles(bool obstacles);
  void find_edges(bool obstacles);
  bool are_joined(sphcloth::PairKind, const std::array<int, 4> &slots) const;
  void sort();
  void add(sphcloth::PairKind, const std::array<int, 4> &slots, const std::array<int, 2> &members);
};

}    // namespace LAMMPS_NS

#endif
