// SPDX-License-Identifier: GPL-2.0-or-later
// Projection of the constraints of a cloth, color by color.
//
// No two constraints of one color share a vertex, so a color is a loop without order: groups of
// four constraints become columns, are projected as vectors, and are written back.  The result
// does not depend on where in a group a constraint stands.

#ifndef SPHCLOTH_CORE_PBD_CLOTH_SOLVER_H
#define SPHCLOTH_CORE_PBD_CLOTH_SOLVER_H

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "core/pbd/constraints.h"
#include "core/util/bytes.h"
#include "core/util/simd.h"

namespace sphcloth {

// a vertex, or its velocity, or its displacement, with the inverse mass

struct Vertex {
  double x = 0.0, y = 0.0, z = 0.0, w = 0.0;
};

using Vertices = AlignedVector<Vertex>;

// Two vectors of constraints: while a processor waits for the one it computes the other.
inline constexpr int CONSTRAINT_GROUP = 2 * GROUP<double>;

// Constraints of N vertices sorted by color.  Every color is filled up to whole groups with
// constraints of a vertex that has no mass, `idle`.

template <std::size_t N> class Constraints {
 public:
  void clear(int colors, int idle_vertex)
  {
    idle = idle_vertex;
    begin.assign(1, 0);
    begin.reserve(colors + 1);
    for (auto &s : slot) s.clear();
    hard.clear();
    for (auto *list :
         {&rest, &k, &compliance, &max_lambda, &lambda, &per_size, &weight, &reference_k})
      list->clear();
    step_ratio = 1.0;
  }
  // in order of their colors; share: the part of a projection that one sweep may do; size: what its
  // error is relative to, 0 if nothing but its compliance says how far it may be off; lever: mean
  // square of the gradients at its vertices, 0 if no load of it counts
  void add(const std::array<int, N> &vertices, const Spring &spring, double share = 1.0,
           double size = 1.0, double lever = 1.0)
  {
    for (std::size_t q = 0; q < N; q++) slot[q].push_back(vertices[q]);
    rest.push_back(spring.rest);
    k.push_back(share * spring.k);
    hard.push_back(spring.k == 1.0);
    compliance.push_back(spring.compliance);
    max_lambda.push_back(spring.max_lambda);
    lambda.push_back(0.0);
    per_size.push_back(size > 0.0 ? 1.0 / size : 0.0);
    weight.push_back(lever);
  }
  void close_color()
  {
    std::array<int, N> vertices;
    vertices.fill(idle);
    while (size() % CONSTRAINT_GROUP != 0) add(vertices, {0.0, 0.0, 0.0, 0.0});
    begin.push_back(size());
  }
  // once, when all have been added: of vertices the w are read
  void weigh(const Vertex *of)
  {
    for (int m = 0; m < size(); m++) {
      double w = 0.0;
      for (std::size_t q = 0; q < N; q++) w += of[slot[q][m]].w;
      weight[m] *= w;
    }
  }

  // The smallest compliance over W, of all that can move, 0 if a stiffness k says how soft one is;
  // or of those alone that have a compliance and no size
  double min_compliance_per_weight(bool without_size = false) const
  {
    double smallest = std::numeric_limits<double>::infinity();
    for (int m = 0; m < size(); m++)
      if (weight[m] > 0.0 && !(without_size && (per_size[m] != 0.0 || !hard[m])))
        smallest = std::min(smallest, hard[m] ? compliance[m] / weight[m] : 0.0);
    return smallest;
  }

  // k of soft constraints such that they stay the springs that k is in a reference step.  ratio:
  // the square of that step over the square of the present one.
  void rescale_stiffness(double ratio)
  {
    if (ratio == step_ratio) return;
    if (reference_k.empty()) reference_k = k;
    step_ratio = ratio;
    for (int m = 0; m < size(); m++)
      if (!hard[m]) k[m] = rescaled_stiffness(reference_k[m], ratio);
  }

  int size() const { return static_cast<int>(rest.size()); }
  int colors() const { return static_cast<int>(begin.size()) - 1; }
  bool is_idle(int m) const { return slot[0][m] == idle; }
  double bytes() const
  {
    double sum = bytes_of(rest, k, compliance, max_lambda, lambda, per_size, weight, reference_k);
    for (const std::vector<int> &vertex : slot) sum += bytes_of(vertex);
    return sum;
  }

  std::vector<int> begin{0};    // of each color, and the end
  std::array<std::vector<int>, N> slot;
  AlignedVector<double> rest, k, compliance, max_lambda, lambda;
  AlignedVector<double> per_size;    // 1/size
  AlignedVector<double> weight;    // W, with the gradients of the rest shape
  std::vector<char> hard;    // k = 1: to be met in full

 private:
  int idle = 0;
  AlignedVector<double> reference_k;    // k at a ratio of 1; empty before the first other ratio
  double step_ratio = 1.0;
};

// What a sweep works on.  Vertices of constraints are indices into these.  Displacements count from
// the start of the (sub)step: they are short, so that what two vertices exchange is not rounded as
// positions are, and momentum is kept.

struct ClothState {
  const Vertex *start = nullptr;    // positions
  // since then; Gauss-Seidel changes them.  Their w are the inverse masses.
  Vertex *displacement = nullptr;
  bool along_start = false;    // project edges along the directions that they had at the start
  Vertex *change = nullptr;    // Jacobi: sum of the changes of displacements; or null
  double inv_dt_sq = 0.0;    // times a compliance: an inverse mass
  // part of its error that one projection may take: 1, or less where a stiffer one is not stable
  double max_edge_share = 1.0, max_hinge_share = 1.0;
  // part of the way that a projection asks for, where it acts for several substeps: the velocity
  // makes the rest
  double part_of_way = 1.0;
  // square of the longest substep, which the solver of unloaded constraints is as soft as, over
  // that of the present one
  double longest_sq = 1.0;
  // error that the solver may add to the size of a constraint, which hardens on the way there; 0:
  // it is as soft under any load
  double max_edge_error = 0.0, max_hinge_error = 0.0;
  // compliance that the solver may add to a constraint without a size, over its own
  double without_size = 0.0;
};

// A single sweep goes from one end to the other: the forces that it makes of constraints that share
// vertices have no energy, and feed the motion unless each takes only part of its error.  A loaded
// sheet gains energy from a share of 0.37 of its hinges on, a free one from 0.65 on; water that
// strikes a sheet gains from rigid edges that take all, and not from a share of 0.91 down.
inline constexpr double STABLE_HINGE_SHARE = 0.25, STABLE_EDGE_SHARE = 0.8;

void project(Constraints<2> &, int color, const ClothState &);
void project(Constraints<4> &, int color, const ClothState &);

// takes the share of the stretching motion out of the velocities v of one color
void damp(const Constraints<2> &, int color, const Vertex *p, Vertex *v, double share);

}    // namespace sphcloth

#endif
