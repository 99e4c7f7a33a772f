// SPDX-License-Identifier: GPL-2.0-or-later
// Broad phase of cloth with cloth and with obstacles: the vertices and triangles, and the edges, of
// a mesh that may meet in a step.  Each pair is on one rank: that of its vertex, or of the vertex
// of both edges, of the cloth alone if the other is of an obstacle, that has the lowest ID.
//
// Lists are by pairs of patches of vertices.  Each is made with a margin and holds while its two
// patches stay within that, also over list builds of LAMMPS that leave vertices where they were.
// Which pairs are visited, and in which order, does not depend on when a list was made.

#ifndef SPHCLOTH_CONTACT_CLOTH_CANDIDATES_H
#define SPHCLOTH_CONTACT_CLOTH_CANDIDATES_H

#include "contact/contact_pair.h"
#include "contact/mesh_edges.h"
#include "contact/moving_triangles.h"
#include "core/contact/mesh_patches.h"
#include "core/geometry/box_grid.h"
#include "core/geometry/hull_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace LAMMPS_NS {

class ClothCandidates : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  ClothCandidates(LAMMPS *lmp_, const MovingTriangles &mesh_, const MeshEdges &edges_,
                  const MeetingRules &rules_) :
      Pointers(lmp_), rules(rules_), mesh(mesh_), edges(edges_)
  {
  }

  bool none() const { return !edges.needed; }    // cloth meets nothing but particles

  // Behind each list build of LAMMPS pairs of the same vertices and triangles are kept.

  // After each change of the sweeps of vertices.  The two sides of a pair are taken to approach by
  // at most `max_approach` in this step.
  void update(double max_approach = std::numeric_limits<double>::infinity());

  // Pairs that may come as near as `reach`, at most max_reach(), in this step: visit(pair, closest
  // points at the start of the step).
  template <class Visit> void for_near(double reach, Visit visit) const
  {
    for (const PatchPair &both : near) {
      const double reach_then = reach + both.approach;
      if (both.nearest > reach_then) continue;
      for (int n = both.begin; n < both.end; n++) {
        const ContactPair &pair = pairs[n];
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
  const MeetingRules rules;

  double memory_usage() const;

 private:
  const MovingTriangles &mesh;
  const MeshEdges &edges;
  struct PatchPair {
    std::array<int, 2> patches;    // ascending
    // By which both may have come nearer since the list was made: until the patches started anew,
    // and until the end of this step.
    double carried = 0.0, approach = 0.0;
    double covered = 0.0;    // all pairs nearer than this are in the list
    int begin = 0, end = 0;    // of pairs
    double nearest = std::numeric_limits<double>::infinity();

    bool operator<(const PatchPair &other) const { return patches < other.patches; }
  };

  sphcloth::MeshPatches patches;
  std::vector<ContactPair> pairs, pairs_before;
  std::vector<PatchPair> near, near_before;
  double range = 0.0;    // to which patches are near, when they started anew
  double limit = 0.0;    // of an approach
  int revision = 0;    // of the edges that lists are of; 0: there are none
  // of a search: boxes of patches, and their triangles and edges
  sphcloth::BoxGrid grid;
  std::vector<sphcloth::Box> boxes;
  std::vector<int> first_triangle, triangles_of, first_edge, edges_of;
  sphcloth::TriangleColumns triangle_columns;
  sphcloth::EdgeColumns edge_columns;

  // how much nearer to one another both sides may come in this step
  double longest_approach(const ContactPair &pair) const
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
  double approach_in_step(const PatchPair &) const;
  void measure();
  bool holds(const PatchPair &) const;
  bool all_hold() const;
  void start_anew(bool known);
  void find_near();
  void sort_members();
  void fill_columns();
  bool meet(int patch, int other) const;
  bool keep(PatchPair &, double in_step);
  void find(PatchPair &, double in_step);
  void find_triangles(int patch_of_vertices, int patch);
  void find_edges(int patch, int other);
  bool orient(int &edge, int &other) const;
  bool are_joined(sphcloth::PairKind, const std::array<int, 4> &slots) const;
  void add(sphcloth::PairKind, const std::array<int, 4> &slots, const std::array<int, 2> &members);
  double cutoff = 0.0;    // of the list that is made
};

}    // namespace LAMMPS_NS

#endif
