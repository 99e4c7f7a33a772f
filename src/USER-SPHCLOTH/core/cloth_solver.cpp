#include "cloth_solver.h"

#include <algorithm>

namespace sphcloth {

namespace {

  constexpr int WIDE = GROUP<double>;

  // one vertex of each constraint of a group

  struct Column {
    alignas(64) double x[WIDE], y[WIDE], z[WIDE], w[WIDE];

    SPHCLOTH_INLINE void read(const Vertex *v, const int *slot)
    {
      columns(&v[0].x, slot, x, y, z, w);
    }
    SPHCLOTH_INLINE void write(Vertex *v, const int *slot) const
    {
      records(x, y, z, w, slot, &v[0].x);
    }
    SPHCLOTH_INLINE void move(int l, double by, double dx, double dy, double dz)
    {
      x[l] += by * dx;
      y[l] += by * dy;
      z[l] += by * dz;
    }
  };

  // the ways go back changed, or what they would change by is added to the change

  template <bool JACOBI>
  SPHCLOTH_INLINE void give(const ClothState &s, const Column &before, Column &after,
                            const int *slot)
  {
    if (!JACOBI) return after.write(s.way, slot);
    Column sum;
    sum.read(s.change, slot);
#pragma omp simd
    for (int l = 0; l < WIDE; l++) {
      sum.x[l] += after.x[l] - before.x[l];
      sum.y[l] += after.y[l] - before.y[l];
      sum.z[l] += after.z[l] - before.z[l];
    }
    sum.write(s.change, slot);
  }

  template <bool START, bool JACOBI>
  SPHCLOTH_MULTIVERSION void project_distances(Constraints<2> &c, int colour, const ClothState &s)
  {
    for (int m = c.begin[colour]; m < c.begin[colour + 1]; m += WIDE) {
      const int *one = &c.slot[0][m], *two = &c.slot[1][m];
      Column s1, s2, u1, u2;
      s1.read(s.start, one);
      s2.read(s.start, two);
      u1.read(s.way, one);
      u2.read(s.way, two);
      const Column before1 = u1, before2 = u2;
      const double *rest = &c.rest[m], *k = &c.k[m], *compliance = &c.compliance[m],
                   *most = &c.most[m];
      double *lambda = &c.lambda[m];
#pragma omp simd
      for (int l = 0; l < WIDE; l++) {
        const double sx = s1.x[l] - s2.x[l], sy = s1.y[l] - s2.y[l], sz = s1.z[l] - s2.z[l];
        const double dx = sx + (u1.x[l] - u2.x[l]), dy = sy + (u1.y[l] - u2.y[l]),
                     dz = sz + (u1.z[l] - u2.z[l]);
        const double w = u1.w[l] + u2.w[l], a = compliance[l] * s.inv_dt_sq;
        const DistanceStep d = START
            ? distance_step_along(dx, dy, dz, sx, sy, sz, w, rest[l], k[l], a, lambda[l], most[l])
            : distance_step(dx, dy, dz, w, rest[l], k[l], a, lambda[l], most[l]);
        lambda[l] += d.lambda;
        u1.move(l, u1.w[l], d.x, d.y, d.z);
        u2.move(l, -u2.w[l], d.x, d.y, d.z);
      }
      give<JACOBI>(s, before1, u1, one);
      give<JACOBI>(s, before2, u2, two);
    }
  }

  // of column p from column q

  struct Apart {
    double x, y, z;
    SPHCLOTH_INLINE Apart(const Column &p_start, const Column &p, const Column &q_start,
                          const Column &q, int l) :
        x((p_start.x[l] - q_start.x[l]) + (p.x[l] - q.x[l])),
        y((p_start.y[l] - q_start.y[l]) + (p.y[l] - q.y[l])),
        z((p_start.z[l] - q_start.z[l]) + (p.z[l] - q.z[l]))
    {
    }
  };

  template <bool JACOBI>
  SPHCLOTH_MULTIVERSION void project_hinges(Constraints<4> &c, int colour, const ClothState &s)
  {
    for (int m = c.begin[colour]; m < c.begin[colour + 1]; m += WIDE) {
      Column start_a, start_e1, start_e2, start_b, a, e1, e2, b;
      start_a.read(s.start, &c.slot[0][m]);
      start_e1.read(s.start, &c.slot[1][m]);
      start_e2.read(s.start, &c.slot[2][m]);
      start_b.read(s.start, &c.slot[3][m]);
      a.read(s.way, &c.slot[0][m]);
      e1.read(s.way, &c.slot[1][m]);
      e2.read(s.way, &c.slot[2][m]);
      b.read(s.way, &c.slot[3][m]);
      const Column before_a = a, before_e1 = e1, before_e2 = e2, before_b = b;
      const double *rest = &c.rest[m], *k = &c.k[m], *compliance = &c.compliance[m],
                   *most = &c.most[m];
      double *lambda = &c.lambda[m];
#pragma omp simd
      for (int l = 0; l < WIDE; l++) {
        const Apart u(start_a, a, start_e1, e1, l), e(start_e2, e2, start_e1, e1, l),
            v(start_b, b, start_e1, e1, l);
        const HingeShape h = hinge_shape(u.x, u.y, u.z, e.x, e.y, e.z, v.x, v.y, v.z);
        const double x2 = -(h.a2 * h.ax + h.b2 * h.bx), y2 = -(h.a2 * h.ay + h.b2 * h.by),
                     z2 = -(h.a2 * h.az + h.b2 * h.bz);
        // by difference: the sum of the gradients is zero however short the edge is
        const double x1 = -(h.ax + h.bx + x2), y1 = -(h.ay + h.by + y2), z1 = -(h.az + h.bz + z2);
        const double ga = h.ax * h.ax + h.ay * h.ay + h.az * h.az,
                     gb = h.bx * h.bx + h.by * h.by + h.bz * h.bz, g1 = x1 * x1 + y1 * y1 + z1 * z1,
                     g2 = x2 * x2 + y2 * y2 + z2 * z2;
        const double weight = a.w[l] * ga + b.w[l] * gb + e1.w[l] * g1 + e2.w[l] * g2;
        const double w = a.w[l] + b.w[l] + e1.w[l] + e2.w[l];
        const double steepest = std::max(std::max(ga, gb), std::max(g1, g2));
        const double lever = weight - LEAST_LEVER * w * steepest;
        const double acting = std::min(h.valid, lever) > 0.0 ? k[l] : 0.0;
        const double step = multiplier_step(angle_difference(h.angle, rest[l]), weight, acting,
                                            compliance[l] * s.inv_dt_sq, lambda[l], most[l]);
        lambda[l] += step;
        a.move(l, step * a.w[l], h.ax, h.ay, h.az);
        b.move(l, step * b.w[l], h.bx, h.by, h.bz);
        e1.move(l, step * e1.w[l], x1, y1, z1);
        e2.move(l, step * e2.w[l], x2, y2, z2);
      }
      give<JACOBI>(s, before_a, a, &c.slot[0][m]);
      give<JACOBI>(s, before_e1, e1, &c.slot[1][m]);
      give<JACOBI>(s, before_e2, e2, &c.slot[2][m]);
      give<JACOBI>(s, before_b, b, &c.slot[3][m]);
    }
  }

}    // namespace

void project(Constraints<2> &c, int colour, const ClothState &s)
{
  if (s.change)
    s.along_start ? project_distances<true, true>(c, colour, s)
                  : project_distances<false, true>(c, colour, s);
  else
    s.along_start ? project_distances<true, false>(c, colour, s)
                  : project_distances<false, false>(c, colour, s);
}

void project(Constraints<4> &c, int colour, const ClothState &s)
{
  s.change ? project_hinges<true>(c, colour, s) : project_hinges<false>(c, colour, s);
}

SPHCLOTH_MULTIVERSION void damp(const Constraints<2> &c, int colour, const Vertex *p, Vertex *v,
                                double share)
{
  for (int m = c.begin[colour]; m < c.begin[colour + 1]; m += WIDE) {
    const int *one = &c.slot[0][m], *two = &c.slot[1][m];
    Column p1, p2, v1, v2;
    p1.read(p, one);
    p2.read(p, two);
    v1.read(v, one);
    v2.read(v, two);
#pragma omp simd
    for (int l = 0; l < WIDE; l++) {
      const DistanceStep d =
          damping_step(p1.x[l] - p2.x[l], p1.y[l] - p2.y[l], p1.z[l] - p2.z[l], v1.x[l] - v2.x[l],
                       v1.y[l] - v2.y[l], v1.z[l] - v2.z[l], p1.w[l] + p2.w[l], share);
      v1.move(l, p1.w[l], d.x, d.y, d.z);
      v2.move(l, -p2.w[l], d.x, d.y, d.z);
    }
    v1.write(v, one);
    v2.write(v, two);
  }
}

/* ----------------------------------------------------------------------
   what is asked for now and then
------------------------------------------------------------------------- */

namespace {

  Vec3 place(const Vertex &v) { return {v.x, v.y, v.z}; }

  double error_of(const Constraints<2> &c, const Vertex *p, int m)
  {
    return (place(p[c.slot[0][m]]) - place(p[c.slot[1][m]])).norm() - c.rest[m];
  }

  double error_of(const Constraints<4> &c, const Vertex *p, int m)
  {
    const double angle = hinge_angle(place(p[c.slot[0][m]]), place(p[c.slot[1][m]]),
                                     place(p[c.slot[2][m]]), place(p[c.slot[3][m]]));
    return std::isnan(angle) ? 0.0 : angle_difference(angle, c.rest[m]);
  }

  // unit: of a constraint's error

  template <std::size_t N, class Unit>
  double largest_residual(const Constraints<N> &c, const Vertex *p, double inv_dt_sq, Unit unit)
  {
    double largest = 0.0;
    for (int m = 0; m < c.size(); m++) {
      if (!c.in_full[m]) continue;
      bool any_moves = false;
      for (std::size_t q = 0; q < N; q++) any_moves = any_moves || p[c.slot[q][m]].w > 0.0;
      if (!any_moves) continue;
      const double left = error_of(c, p, m) + c.compliance[m] * inv_dt_sq * c.lambda[m];
      if (left < 0.0 && c.lambda[m] >= c.most[m]) continue;    // slack
      largest = std::max(largest, std::fabs(left) / unit(c.rest[m]));
    }
    return largest;
  }

  template <std::size_t N>
  double sum_of_energies(const Constraints<N> &c, const Vertex *p, int n_owned)
  {
    double sum = 0.0;
    for (int m = 0; m < c.size(); m++) {
      if (c.compliance[m] == 0.0 || c.slot[0][m] >= n_owned) continue;
      const double error = error_of(c, p, m);
      if (error < 0.0 && c.most[m] == 0.0) continue;
      sum += 0.5 * error * error / c.compliance[m];
    }
    return sum;
  }

}    // namespace

void for_each_held(const Constraints<2> &c, const Vertex *p, const Vertex *start, const OnHeld &on)
{
  for (int m = 0; m < c.size(); m++) {
    const int one = c.slot[0][m], two = c.slot[1][m];
    if (c.lambda[m] == 0.0 || (p[one].w > 0.0 && p[two].w > 0.0)) continue;
    Vec3 edge = place(p[one]) - place(p[two]);
    if (start) {
      const Vec3 before = place(start[one]) - place(start[two]);
      const double pull = std::fabs(c.lambda[m]) * (p[one].w + p[two].w) / edge.norm();
      if (!start_is_void(edge.normalized().dot(before), before.norm(), pull)) edge = before;
    }
    const Vec3 pull = c.lambda[m] * edge.normalized();
    if (p[one].w == 0.0) on(one, pull);
    if (p[two].w == 0.0) on(two, -pull);
  }
}

void for_each_held(const Constraints<4> &c, const Vertex *p, const Vertex *, const OnHeld &on)
{
  for (int m = 0; m < c.size(); m++) {
    const std::array<int, 4> s{c.slot[0][m], c.slot[1][m], c.slot[2][m], c.slot[3][m]};
    if (c.lambda[m] == 0.0 || std::all_of(s.begin(), s.end(), [&](int q) { return p[q].w > 0.0; }))
      continue;
    const Vec3 e1 = place(p[s[1]]), a = place(p[s[0]]) - e1, e = place(p[s[2]]) - e1,
               b = place(p[s[3]]) - e1;
    const HingeShape h = hinge_shape(a[0], a[1], a[2], e[0], e[1], e[2], b[0], b[1], b[2]);
    const Vec3 ga(h.ax, h.ay, h.az), gb(h.bx, h.by, h.bz);
    const Vec3 g2 = -h.a2 * ga - h.b2 * gb;
    const std::array<Vec3, 4> gradient{ga, -ga - g2 - gb, g2, gb};
    for (int q = 0; q < 4; q++)
      if (p[s[q]].w == 0.0) on(s[q], c.lambda[m] * gradient[q]);
  }
}

double residual(const Constraints<2> &c, const Vertex *p, double inv_dt_sq, double length)
{
  return largest_residual(c, p, inv_dt_sq, [&](double rest) { return rest > 0.0 ? rest : length; });
}

double residual(const Constraints<4> &c, const Vertex *p, double inv_dt_sq)
{
  return largest_residual(c, p, inv_dt_sq, [](double) { return 1.0; });
}

double elastic_energy(const Constraints<2> &c, const Vertex *p, int n_owned)
{
  return sum_of_energies(c, p, n_owned);
}

double elastic_energy(const Constraints<4> &c, const Vertex *p, int n_owned)
{
  return sum_of_energies(c, p, n_owned);
}

}    // namespace sphcloth
