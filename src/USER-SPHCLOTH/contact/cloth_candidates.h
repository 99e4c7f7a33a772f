// SPDX-License-Identifier: GPL-2.0-or-later
// Broad phase of cloth with cloth and with obstacles: the vertices and triangles, and the edges, of
// a mesh that may meet in a step.  Each pair is on one rank: that of its vertex, or of the vertex
// of both edges, of the cloth alone if the other is of an obstacle, that has the lowest ID.
//
// Lists are by pairs of patches of vertices.  Each is made with a margin, holds while its two
// patches stay within that, also over list builds of LAMMPS that leave vertices where they were,
// and is made anew alone.  A pair is measured where it may have come near since it was measured
// last.
// Which pairs are visited, and in which order, does not depend on when a list was made.

#ifndef SPHCLOTH_CONTACT_CLOTH_CANDIDATES_H
#define SPHCLOTH_CONTACT_CLOTH_CANDIDATES_H

#include "contact/contact_pair.h"
#include "contact/mesh_edges.h"
#include "contact/moving_triangles.h"
#include "core/contact/center_distances.h"
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
  template <class Visit> void for_near(double reach, Visit visit)
  {
    if (near.empty()) return;
    center_distances.load(mesh.start);
    for (PatchPair &both : near) {
      const double path_then = reach + both.path + both.in_step;
      if (both.nearest > path_then) continue;
      const double reach_in_step = reach + both.in_step;
      measure_centers(both, reach + both.approach, path_then);
      for (std::size_t k = 0; k < measured.size(); k++) {
        const ContactPair &pair = pairs[measured[k]];
        double distance = at_least[k];
        if (distance <= reach_in_step) {
          const sphcloth::ClosestPoints at =
              closest_points(pair.kind,
                             {mesh.start[pair.slots[0]], mesh.start[pair.slots[1]],
                              mesh.start[pair.slots[2]], mesh.start[pair.slots[3]]});
          distance = at.vector.norm();
          const double room = distance - reach;
          if (room <= 0.0 || (room <= limit && room <= longest_approach(pair))) visit(pair, at);
        }
        distances[measured[k]].measure(distance, both.path);
      }
      both.nearest = nearest_of(both);
    }
  }
  double max_reach() const;
  const MeetingRules rules;

  // Is a pair at this distance joined by a bond that is shorter than the thickness: by a seam?
  bool are_joined(const ContactPair &pair, double distance) const;

  double memory_usage() const;

 private:
  const MovingTriangles &mesh;
  const MeshEdges &edges;
  struct PatchPair {
    std::array<int, 2> patches;    // ascending
    // By which both may have come nearer since the list was made: step by step; until the patches
    // started anew; in this step; and in all.
    double path = 0.0, carried = 0.0, in_step = 0.0, approach = 0.0;
    double covered = 0.0;    // all pairs nearer than this are in the list
    int begin = 0, end = 0;    // of pairs
    double nearest = 0.0;    // of these, when they were measured last, with the path of then

    bool operator<(const PatchPair &other) const { return patches < other.patches; }
  };

  // Of a pair, lower bounds in single precision, since many are read: when its list was made, and
  // when it was measured last, with the path of then.
  struct Distances {
    float listed = 0.0, last = 0.0;

    void measure(double distance, double path)
    {
      constexpr double ROUNDED = 1.0 - 1e-6;
      last = static_cast<float>(ROUNDED * (distance + path));
      if (path == 0.0) listed = last;
    }
    bool is_beyond(double reach, double path) const { return listed > reach || last > path; }
  };

  sphcloth::MeshPatches patches;
  // of a patch pair: the pairs that are measured, their slots, and how near they are at least
  sphcloth::CenterDistances center_distances;
  std::vector<int> measured;
  std::vector<std::array<int, 4>> measured_slots;
  std::vector<double> at_least;
  std::vector<ContactPair> pairs, pairs_before;
  std::vector<Distances> distances, distances_before;    // of these
  std::vector<PatchPair> near, near_before;
  std::size_t unused = 0;    // of the pairs: those of lists that were made anew
  double range = 0.0;    // to which patches are near, when they started anew
  double limit = 0.0;    // of an approach
  int revision = 0;    // of the edges that lists are of; 0: there are none
  // of a search: boxes of patches, and their triangles and edges
  sphcloth::BoxGrid grid;
  std::vector<sphcloth::Box> boxes;
  std::vector<int> prepared;    // of patches: in which update
  int updates = 0;
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
  void measure_centers(const PatchPair &, double reach, double path);
  double nearest_of(const PatchPair &) const;
  double margin() const;
  void measure();
  void measure(PatchPair &) const;
  bool holds(const PatchPair &) const;
  void start_anew(bool known);
  void find_near();
  void sort_members();
  bool meet(int patch, int other) const;
  void keep(PatchPair &) const;
  void drop_unused();
  void find(PatchPair &);
  void prepare(int patch);
  void find_triangles(int patch_of_vertices, int patch);
  void find_edges(int patch, int other);
  bool orient(int &edge, int &other) const;
  void add(sphcloth::PairKind, const std::array<int, 4> &slots, const std::array<int, 2> &members);
  double cutoff = 0.0;    // of the list that is made
};

}    // namespace LAMMPS_NS

#endif
