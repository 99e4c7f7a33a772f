// SPDX-License-Identifier: GPL-2.0-or-later
// Projects distances (4) and hinges (5), (6) by (7) and (8).

#include "core/pbd/cloth_solver.h"

#include <algorithm>

#include "core/pbd/solver_softness.h"

namespace sphcloth {

namespace {

  constexpr int WIDE = CONSTRAINT_GROUP, HALF = GROUP<double>;

  // Rows and columns.  In memory a vertex is a row: x, y, z and w.  A group of constraints is
  // projected in columns: x of each, y of each, and so on.  Only differences of vertices are
  // needed, so these are taken row by row and then turned into columns, with a w in the lane that
  // is free. What a vertex is moved by, but for its w, is turned back into rows, whose last lane is
  // 0: added to the rows of the vertices they leave w as it is.

  struct Column {
    alignas(64) double x[WIDE], y[WIDE], z[WIDE], w[WIDE];

    SPHCLOTH_INLINE void put(int l, double a, double b, double c) { x[l] = a, y[l] = b, z[l] = c; }
  };

  struct Rows {
    Row of[WIDE];

    SPHCLOTH_INLINE void to(Column &c) const
    {
      for (int l = 0; l < WIDE; l += HALF) to_columns(of + l, c.x + l, c.y + l, c.z + l, c.w + l);
    }
    SPHCLOTH_INLINE void from(const Column &c)
    {
      for (int l = 0; l < WIDE; l += HALF) to_rows(c.x + l, c.y + l, c.z + l, of + l);
    }
  };

  SPHCLOTH_INLINE const Row &row(const Vertex &v) { return *reinterpret_cast<const Row *>(&v); }
  SPHCLOTH_INLINE Row &row(Vertex &v) { return *reinterpret_cast<Row *>(&v); }

  // An edge in a sweep: its compliance, and the part of the error that it comes to and is not
  // pulled back for, since it pulls as the tangent of a spring that hardens.

  struct EdgeSpring {
    double compliance, offset;
  };

  SPHCLOTH_INLINE EdgeSpring edge_spring(double error, double w, double material, double taken,
                                         const SolverSoftness &s)
  {
    const double by_share = taken * s.softness;
    const double a = std::max(material, by_share) + SINGLE_SWEEP_SOFTNESS * (s.softness - w);
    const double hardens =
        (by_share > material ? by_share : 0.0) + SINGLE_SWEEP_SOFTNESS * s.softness;
    const double steeper = a + s.steeper * std::min(a, hardens);
    const double tangent = steeper > 0.0 ? a / steeper : 1.0;
    return {a * tangent, error * (1.0 - tangent)};
  }

  // What all constraints of a kind have in common in a sweep.  share: of its error that one takes;
  // allowed: error that the solver may add

  struct Sweep {
    double inv_dt_sq, inv_share, softest, longest_sq, per_allowed, without_size, part_of_way;

    Sweep(const ClothState &s, double share, double allowed) :
        inv_dt_sq(s.inv_dt_sq), inv_share(1.0 / share),
        softest(inv_share - 1.0 + SINGLE_SWEEP_SOFTNESS), longest_sq(std::max(1.0, s.longest_sq)),
        per_allowed(allowed > 0.0 ? 1.0 / allowed : 0.0), without_size(s.without_size),
        part_of_way(s.part_of_way)
    {
    }
  };

  // A group of edges in columns: at the start of the substep and so far; once projected, what their
  // ends are moved by.  One loop over all of it would not be vectors, three are.

  struct EdgeGroup {
    Column start, now;

    SPHCLOTH_INLINE void read(const Constraints<2> &c, int m, const Vertex *at_start,
                              const Vertex *displacement)
    {
      const int *one = &c.slot[0][m], *two = &c.slot[1][m];
      Rows before, so_far;
      for (int l = 0; l < WIDE; l++) {
        const Row &way1 = row(displacement[one[l]]), &way2 = row(displacement[two[l]]);
        before.of[l] = row(at_start[one[l]]) - row(at_start[two[l]]);
        so_far.of[l] = before.of[l] + (way1 - way2);
        take_last(so_far.of[l], way1 + way2);
      }
      before.to(start);
      so_far.to(now);
    }

    // The errors that the edges come to in this substep if they are alone.  Where the allowed
    // strain is far none hardens, and there is no equation to solve.

    template <bool START>
    SPHCLOTH_INLINE void errors(const Constraints<2> &c, int m, const Sweep &s, double *error) const
    {
      constexpr double SOFT = 0.2, TINY = 1e-300;
      const double *rest = &c.rest[m], *compliance = &c.compliance[m],
                   *max_lambda = &c.max_lambda[m], *per_size = &c.per_size[m];
      alignas(64) double unit[WIDE], kappa[WIDE], size[WIDE];
      double largest = 0.0;
#pragma omp simd reduction(max : largest)
      for (int l = 0; l < WIDE; l++) {
        const double x = START ? start.x[l] : now.x[l], y = START ? start.y[l] : now.y[l],
                     z = START ? start.z[l] : now.z[l];
        const double along = (now.x[l] * x + now.y[l] * y + now.z[l] * z) /
            (std::sqrt(x * x + y * y + z * z) + TINY);
        const double deviation = along - rest[l], w = now.w[l];
        error[l] = max_lambda[l] == 0.0 ? std::max(0.0, deviation) : deviation;
        const double rigid = s.softest * w * s.longest_sq;
        const double inv = 1.0 / (rigid + compliance[l] * s.inv_dt_sq + TINY);
        kappa[l] = w * inv;
        unit[l] = per_size[l] * s.per_allowed * rigid * inv;
        size[l] = std::fabs(error[l]) * unit[l];
        largest = std::max(largest, size[l]);
      }
      if (largest <= SOFT) {
#pragma omp simd
        for (int l = 0; l < WIDE; l++) error[l] *= 1.0 / (1.0 + kappa[l]);
        return;
      }
#pragma omp simd
      for (int l = 0; l < WIDE; l++) {
        const bool hardens = size[l] > SOFT;
        const double strain = hardened_strain(hardens ? size[l] : 1.0, hardens ? kappa[l] : 1.0);
        const double of_size = hardens ? strain / size[l] : 1.0 / (1.0 + kappa[l]);
        error[l] *= of_size;
      }
    }

    template <bool START> SPHCLOTH_INLINE void project(Constraints<2> &c, int m, const Sweep &s)
    {
      const double *rest = &c.rest[m], *k = &c.k[m], *compliance = &c.compliance[m],
                   *max_lambda = &c.max_lambda[m], *per_size = &c.per_size[m];
      double *lambda = &c.lambda[m];
      alignas(64) double error[WIDE], softness[WIDE], steeper[WIDE], target[WIDE], spring[WIDE];
      errors<START>(c, m, s, error);
#pragma omp simd
      for (int l = 0; l < WIDE; l++) {
        const SolverSoftness of =
            solver_softness(error[l], now.w[l], compliance[l] * s.inv_dt_sq, per_size[l],
                            s.longest_sq, s.per_allowed, s.without_size, s.softest);
        softness[l] = of.softness;
        steeper[l] = of.steeper;
      }
#pragma omp simd
      for (int l = 0; l < WIDE; l++) {
        const double material = compliance[l] * s.inv_dt_sq, taken = k[l] * s.inv_share - 1.0;
        const EdgeSpring hard =
            edge_spring(error[l], now.w[l], material, taken, {softness[l], steeper[l]});
        const double of_share = std::max(material, taken * s.longest_sq * now.w[l]);
        spring[l] = k[l] >= 1.0 ? hard.compliance : of_share;
        target[l] = rest[l] + (k[l] >= 1.0 ? hard.offset : 0.0);
      }
#pragma omp simd
      for (int l = 0; l < WIDE; l++) {
        const DistanceStep by = START
            ? distance_step_along(now.x[l], now.y[l], now.z[l], start.x[l], start.y[l], start.z[l],
                                  now.w[l], target[l], k[l], spring[l], lambda[l], max_lambda[l])
            : distance_step(now.x[l], now.y[l], now.z[l], now.w[l], target[l], k[l], spring[l],
                            lambda[l], max_lambda[l]);
        lambda[l] += by.lambda;
        now.put(l, by.x, by.y, by.z);
      }
    }

    SPHCLOTH_INLINE void move(const Constraints<2> &c, int m, const Vertex *displacement,
                              Vertex *moved) const
    {
      const int *one = &c.slot[0][m], *two = &c.slot[1][m];
      Rows by;
      by.from(now);
      for (int l = 0; l < WIDE; l++) {
        const double w1 = displacement[one[l]].w, w2 = displacement[two[l]].w;
        row(moved[one[l]]) += w1 * by.of[l];
        row(moved[two[l]]) -= w2 * by.of[l];
      }
    }
  };

  // A constraint is a long chain, one number waiting for the other.  In loops that only read, only
  // project or only move, a processor begins with the next group before it has ended the last.

  constexpr int BATCH = 2;

  template <bool START>
  SPHCLOTH_MULTIVERSION void project_distances(Constraints<2> &c, int color, const ClothState &s)
  {
    const Vertex *start = s.start, *displacement = s.displacement;
    Vertex *moved = s.change ? s.change : s.displacement;
    const Sweep sweep(s, s.max_edge_share, s.max_edge_error);
    const int end = c.begin[color + 1];
    for (int m = c.begin[color]; m < end; m += BATCH * WIDE) {
      EdgeGroup group[BATCH];
      const int n = std::min(BATCH, (end - m) / WIDE);
      for (int g = 0; g < n; g++) group[g].read(c, m + g * WIDE, start, displacement);
      for (int g = 0; g < n; g++) group[g].template project<START>(c, m + g * WIDE, sweep);
      for (int g = 0; g < n; g++) group[g].move(c, m + g * WIDE, displacement, moved);
    }
  }

  // A group of hinges in columns: wing a, edge 2 and wing b relative to edge 1, with the w of each;
  // once projected, what they are moved by

  struct HingeGroup {
    Column a, e2, b, e1;    // of edge 1 only w is of use

    SPHCLOTH_INLINE void read(const Constraints<4> &c, int m, const Vertex *start,
                              const Vertex *displacement)
    {
      Rows rows_a, rows_2, rows_b, rows_1;
      for (int l = 0; l < WIDE; l++) {
        const int edge = c.slot[1][m + l];
        const Row &start1 = row(start[edge]), &way1 = row(displacement[edge]);
        const auto relative = [&](int vertex, Row &r) {
          r = (row(start[vertex]) - start1) + (row(displacement[vertex]) - way1);
          take_last(r, row(displacement[vertex]));
        };
        relative(c.slot[0][m + l], rows_a.of[l]);
        relative(c.slot[2][m + l], rows_2.of[l]);
        relative(c.slot[3][m + l], rows_b.of[l]);
        rows_1.of[l] = way1;
      }
      rows_a.to(a);
      rows_2.to(e2);
      rows_b.to(b);
      rows_1.to(e1);
    }

    SPHCLOTH_INLINE void project(Constraints<4> &c, int m, const Sweep &s)
    {
      const double *rest = &c.rest[m], *k = &c.k[m], *compliance = &c.compliance[m],
                   *max_lambda = &c.max_lambda[m], *per_size = &c.per_size[m];
      double *lambda = &c.lambda[m];
#pragma omp simd
      for (int l = 0; l < WIDE; l++) {
        const HingeShape h =
            hinge_shape(a.x[l], a.y[l], a.z[l], e2.x[l], e2.y[l], e2.z[l], b.x[l], b.y[l], b.z[l]);
        const double x2 = -(h.a2 * h.ax + h.b2 * h.bx), y2 = -(h.a2 * h.ay + h.b2 * h.by),
                     z2 = -(h.a2 * h.az + h.b2 * h.bz);
        const double x1 = h.ax + h.bx + x2, y1 = h.ay + h.by + y2, z1 = h.az + h.bz + z2;
        const double ga = h.ax * h.ax + h.ay * h.ay + h.az * h.az,
                     gb = h.bx * h.bx + h.by * h.by + h.bz * h.bz, g1 = x1 * x1 + y1 * y1 + z1 * z1,
                     g2 = x2 * x2 + y2 * y2 + z2 * z2;
        const double weight = a.w[l] * ga + b.w[l] * gb + e1.w[l] * g1 + e2.w[l] * g2;
        const double w = a.w[l] + b.w[l] + e1.w[l] + e2.w[l];
        const double steepest = std::max(std::max(ga, gb), std::max(g1, g2));
        const double lever = weight - MIN_LEVER * w * steepest;
        const double step_ratio = std::min(h.valid, lever) > 0.0 ? k[l] : 0.0;
        const double error = angle_difference(h.angle, rest[l]);
        const double material = compliance[l] * s.inv_dt_sq;
        const SolverSoftness of_solver =
            solver_softness(error, weight, material, per_size[l], s.longest_sq, s.per_allowed,
                            s.without_size, s.softest);
        const bool hard = step_ratio >= 1.0;
        const double soft = hard ? of_solver.softness : s.longest_sq * weight;
        // what acts for several substeps is a force, and not softer for what the force will move
        const double spring = s.part_of_way < 1.0 ? material - weight : material;
        const double softness = std::max(spring, (k[l] * s.inv_share - 1.0) * soft);
        const double step =
            multiplier_step(error, weight, step_ratio, softness, lambda[l], max_lambda[l]);
        lambda[l] += step;
        const double way = s.part_of_way * step;
        a.put(l, way * h.ax, way * h.ay, way * h.az);
        e2.put(l, way * x2, way * y2, way * z2);
        b.put(l, way * h.bx, way * h.by, way * h.bz);
      }
    }

    SPHCLOTH_INLINE void move(const Constraints<4> &c, int m, const Vertex *displacement,
                              Vertex *moved) const
    {
      Rows by_a, by_2, by_b;
      by_a.from(a);
      by_2.from(e2);
      by_b.from(b);
      for (int l = 0; l < WIDE; l++) {
        const auto add = [&](int vertex, const Row &by) {
          const double w_of = displacement[vertex].w;
          row(moved[vertex]) += w_of * by;
        };
        add(c.slot[0][m + l], by_a.of[l]);
        add(c.slot[2][m + l], by_2.of[l]);
        add(c.slot[3][m + l], by_b.of[l]);
        // what the others get: the sum of the gradients is zero however short the edge is
        add(c.slot[1][m + l], -(by_a.of[l] + by_2.of[l] + by_b.of[l]));
      }
    }
  };

  SPHCLOTH_MULTIVERSION void project_hinges(Constraints<4> &c, int color, const ClothState &s)
  {
    const Vertex *start = s.start, *displacement = s.displacement;
    Vertex *moved = s.change ? s.change : s.displacement;
    const Sweep sweep(s, s.max_hinge_share, s.max_hinge_error);
    const int end = c.begin[color + 1];
    for (int m = c.begin[color]; m < end; m += BATCH * WIDE) {
      HingeGroup group[BATCH];
      const int n = std::min(BATCH, (end - m) / WIDE);
      for (int g = 0; g < n; g++) group[g].read(c, m + g * WIDE, start, displacement);
      for (int g = 0; g < n; g++) group[g].project(c, m + g * WIDE, sweep);
      for (int g = 0; g < n; g++) group[g].move(c, m + g * WIDE, displacement, moved);
    }
  }

}    // namespace

void project(Constraints<2> &c, int color, const ClothState &s)
{
  s.along_start ? project_distances<true>(c, color, s) : project_distances<false>(c, color, s);
}

void project(Constraints<4> &c, int color, const ClothState &s) { project_hinges(c, color, s); }

SPHCLOTH_MULTIVERSION void damp(const Constraints<2> &c, int color, const Vertex *p, Vertex *v,
                                double share)
{
  for (int m = c.begin[color]; m < c.begin[color + 1]; m += WIDE) {
    const int *one = &c.slot[0][m], *two = &c.slot[1][m];
    Rows apart, faster;
    for (int l = 0; l < WIDE; l++) {
      const Row &p1 = row(p[one[l]]), &p2 = row(p[two[l]]);
      apart.of[l] = p1 - p2;
      take_last(apart.of[l], p1 + p2);
      faster.of[l] = row(v[one[l]]) - row(v[two[l]]);
    }
    Column d, u, step;
    apart.to(d);
    faster.to(u);
#pragma omp simd
    for (int l = 0; l < WIDE; l++) {
      const DistanceStep by =
          damping_step(d.x[l], d.y[l], d.z[l], u.x[l], u.y[l], u.z[l], d.w[l], share);
      step.put(l, by.x, by.y, by.z);
    }
    Rows by;
    by.from(step);
    for (int l = 0; l < WIDE; l++) {
      const double w1 = p[one[l]].w, w2 = p[two[l]].w;
      row(v[one[l]]) += w1 * by.of[l];
      row(v[two[l]]) -= w2 * by.of[l];
    }
  }
}

}    // namespace sphcloth
