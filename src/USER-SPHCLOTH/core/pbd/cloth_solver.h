// Projection of the constraints of a cloth, colour by colour.
//
// No two constraints of one colour share a vertex, so a colour is a loop without order: groups of
// four constraints become columns, are projected as vectors, and are written back.  The result
// does not depend on where in a group a constraint stands.

#ifndef SPHCLOTH_CORE_PBD_CLOTH_SOLVER_H
#define SPHCLOTH_CORE_PBD_CLOTH_SOLVER_H

#include <array>
#include <functional>
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

// Constraints of N vertices sorted by colour.  Every colour is filled up to whole groups with
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
    for (auto *list : {&rest, &k, &compliance, &most, &lambda, &given}) list->clear();
    acting = 1.0;
  }
  // one after the other, colour by colour
  // share: what one sweep may do of it
  void add(const std::array<int, N> &vertices, const Spring &spring, double share = 1.0)
  {
    for (std::size_t q = 0; q < N; q++) slot[q].push_back(vertices[q]);
    rest.push_back(spring.rest);
    k.push_back(share * spring.k);
    hard.push_back(spring.k == 1.0);
    compliance.push_back(spring.compliance);
    most.push_back(spring.most);
    lambda.push_back(0.0);
  }
  void close_color()
  {
    std::array<int, N> vertices;
    vertices.fill(idle);
    while (size() % GROUP<double> != 0) add(vertices, {0.0, 0.0, 0.0, 0.0});
    begin.push_back(size());
  }

  // The springs that the constraints are where they do what k says, in steps whose square is one over
  // `ratio` of that there: see the share of a spring in constraints.h.
  void rescale_stiffness(double ratio)
  {
    if (ratio == acting) return;
    if (given.empty()) given = k;
    acting = ratio;
    for (int m = 0; m < size(); m++)
      if (!hard[m]) k[m] = rescaled_stiffness(given[m], ratio);
  }

  int size() const { return static_cast<int>(rest.size()); }
  int colors() const { return static_cast<int>(begin.size()) - 1; }
  bool is_idle(int m) const { return slot[0][m] == idle; }
  double bytes() const
  {
    double sum = bytes_of(rest, k, compliance, most, lambda, given);
    for (const std::vector<int> &vertex : slot) sum += bytes_of(vertex);
    return sum;
  }

  std::vector<int> begin{0};    // of each colour, and the end
  std::array<std::vector<int>, N> slot;
  AlignedVector<double> rest, k, compliance, most, lambda;
  std::vector<char> hard;    // not in part, as (9) with k < 1

 private:
  int idle = 0;
  AlignedVector<double> given;    // k where its ratio is 1, unless it always is
  double acting = 1.0;
};

// What a sweep works on.  Vertices of constraints are indices into these.  Vertices move from where they
// were at the start of the (sub)step: ways are short, so that what two vertices exchange is not
// rounded as places are, and momentum is kept.

struct ClothState {
  const Vertex *start = nullptr;    // places
  Vertex *displacement =
      nullptr;    // since then, moved (Gauss-Seidel); the inverse masses are these
  bool along_start = false;    // project edges along the directions that they had at the start
  Vertex *change = nullptr;    // Jacobi: add up here what the ways would change by, or null
  double inv_dt_sq = 0.0;
};

void project(Constraints<2> &, int color, const ClothState &);
void project(Constraints<4> &, int color, const ClothState &);

// takes the share of the stretching motion out of the velocities v of one colour
void damp(const Constraints<2> &, int color, const Vertex *p, Vertex *v, double share);

// C + a lambda, which vanishes in a converged step: largest of the constraints that are to be met in
// full and are not slack.  Of lengths it is relative, to the rest length or to `length` if that is 0.
double residual(const Constraints<2> &, const Vertex *p, double inv_dt_sq, double length);
double residual(const Constraints<4> &, const Vertex *p, double inv_dt_sq);

// lambda grad C on every vertex with w = 0: on(slot, vector), once for each constraint that it is in.
// With `start` edges have the directions that they had there.
using OnHeld = std::function<void(int, const Vec3 &)>;
void for_each_held(const Constraints<2> &, const Vertex *p, const Vertex *start, const OnHeld &on);
void for_each_held(const Constraints<4> &, const Vertex *p, const Vertex *start, const OnHeld &on);

// C^2/(2 compliance), summed over the compliant constraints whose first vertex is below n_owned
double elastic_energy(const Constraints<2> &, const Vertex *p, int n_owned);
double elastic_energy(const Constraints<4> &, const Vertex *p, int n_owned);

}    // namespace sphcloth

#endif
