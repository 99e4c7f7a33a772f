// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pbd/constraint_errors.h"

#include <algorithm>

namespace sphcloth {

namespace {

  Vec3 position(const Vertex &v) { return {v.x, v.y, v.z}; }

  double error_of(const Constraints<2> &c, const Vertex *p, int m)
  {
    return (position(p[c.slot[0][m]]) - position(p[c.slot[1][m]])).norm() - c.rest[m];
  }

  double error_of(const Constraints<4> &c, const Vertex *p, int m)
  {
    const double angle = hinge_angle(position(p[c.slot[0][m]]), position(p[c.slot[1][m]]),
                                     position(p[c.slot[2][m]]), position(p[c.slot[3][m]]));
    return std::isnan(angle) ? 0.0 : angle_difference(angle, c.rest[m]);
  }

  // unit: of a constraint's error

  template <std::size_t N, class Unit>
  double largest_residual(const Constraints<N> &c, const Vertex *p, double inv_dt_sq, Unit unit)
  {
    double largest = 0.0;
    for (int m = 0; m < c.size(); m++) {
      if (!c.hard[m]) continue;
      bool any_moves = false;
      for (std::size_t q = 0; q < N; q++) any_moves = any_moves || p[c.slot[q][m]].w > 0.0;
      if (!any_moves) continue;
      const double left = error_of(c, p, m) + c.compliance[m] * inv_dt_sq * c.lambda[m];
      if (left < 0.0 && c.lambda[m] >= c.max_lambda[m]) continue;    // slack
      largest = std::max(largest, std::fabs(left) / unit(c.rest[m]));
    }
    return largest;
  }

  // with what it says others hardly say anything new; -1: there is none

  template <std::size_t N> int with_largest_load(const Constraints<N> &c)
  {
    int found = -1;
    double largest = -1.0;
    for (int m = 0; m < c.size(); m++) {
      const double load = std::fabs(c.lambda[m]) * c.weight[m] * c.per_size[m];
      if (c.hard[m] && c.weight[m] > 0.0 && c.per_size[m] > 0.0 && load > largest) {
        largest = load;
        found = m;
      }
    }
    return found;
  }

  template <std::size_t N>
  SolverError error_under_load(const Constraints<N> &c, const LoadedSolver &s)
  {
    const int first = with_largest_load(c);
    if (first < 0) return {};
    const auto load = [&](int m) { return std::fabs(c.lambda[m]) * s.inv_dt_sq; };
    const auto error = [&](int m) {
      return s.of(load(m), c.weight[m], c.compliance[m], c.per_size[m]);
    };
    SolverError found = error(first);
    double known = s.without_news(found);
    for (int m = 0; m < c.size(); m++) {
      if (!c.hard[m] || c.weight[m] == 0.0 || c.per_size[m] == 0.0) continue;
      if (s.unloaded_error(load(m), c.weight[m], c.per_size[m]) <= known) continue;
      found.join(error(m));
      known = s.without_news(found);
    }
    return found;
  }

  template <std::size_t N>
  double sum_of_energies(const Constraints<N> &c, const Vertex *p, int n_owned)
  {
    double sum = 0.0;
    for (int m = 0; m < c.size(); m++) {
      if (c.compliance[m] == 0.0 || c.slot[0][m] >= n_owned) continue;
      const double error = error_of(c, p, m);
      if (error < 0.0 && c.max_lambda[m] == 0.0) continue;
      sum += 0.5 * error * error / c.compliance[m];
    }
    return sum;
  }

}    // namespace

SolverError solver_error(const Constraints<2> &c, const LoadedSolver &s)
{
  return error_under_load(c, s);
}

SolverError solver_error(const Constraints<4> &c, const LoadedSolver &s)
{
  return error_under_load(c, s);
}

void for_each_held(const Constraints<2> &c, const Vertex *p, const Vertex *start, const OnHeld &on)
{
  for (int m = 0; m < c.size(); m++) {
    const int one = c.slot[0][m], two = c.slot[1][m];
    if (c.lambda[m] == 0.0 || (p[one].w > 0.0 && p[two].w > 0.0)) continue;
    Vec3 edge = position(p[one]) - position(p[two]);
    if (start) {
      const Vec3 before = position(start[one]) - position(start[two]);
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
    const Vec3 e1 = position(p[s[1]]);
    const std::array<Vec3, 4> gradient =
        hinge_gradients(position(p[s[0]]) - e1, position(p[s[2]]) - e1, position(p[s[3]]) - e1);
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

double largest_strain(const Constraints<2> &c, const Vertex *p)
{
  double largest = 0.0;
  for (int m = 0; m < c.size(); m++) {
    if (!c.hard[m] || c.weight[m] == 0.0 || c.compliance[m] > 0.0) continue;
    const double error = error_of(c, p, m);
    if (error < 0.0 && c.max_lambda[m] == 0.0) continue;
    largest = std::max(largest, std::fabs(error) * c.per_size[m]);
  }
  return largest;
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
