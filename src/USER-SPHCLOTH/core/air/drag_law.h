// SPDX-License-Identifier: GPL-2.0-or-later
// Force of air on a flat piece of cloth, from the velocity u of the air relative to it.
//
// With the angle a between u and the sheet, 0 along it and 90 degrees across,
//   F = rho/2 A |u|^2 (N(a) n + T(a) t),
// n is the normal on the lee side and t the direction of the tangential part of u.  Either the
// cross-flow principle (S. F. Hoerner, Fluid-Dynamic Drag, 1965, chapter 3),
//   N = C_n sin^2 a,  T = C_t cos a,
// or a table of drag along u and lift across it, in the plane of u and n and towards n,
//   N = C_D sin a + C_L cos a,  T = C_D cos a - C_L sin a.

#ifndef SPHCLOTH_CORE_AIR_DRAG_LAW_H
#define SPHCLOTH_CORE_AIR_DRAG_LAW_H

#include <algorithm>
#include <cmath>
#include <vector>

namespace sphcloth {

// F over rho/2 A, along n and t, and minus its derivative by the velocity of the sheet along these

struct DragTerms {
  double normal, tangential, normal_slope, tangential_slope;
};

// across, along: parts of u, both >= 0

struct DragCoefficients {
  double normal = 1.17, tangential = 0.0;    // Hoerner: a square plate

  DragTerms terms(double across, double along) const
  {
    const double speed = std::sqrt(across * across + along * along + 1e-300);
    return {normal * across * across, tangential * speed * along, 2.0 * normal * across,
            tangential * (speed + along * along / speed)};
  }
};

// Straight lines between the rows.  Slopes are at least the force over the velocity, so that a step
// never turns the relative velocity around, and at least 0.

class DragTable {
 public:
  struct Row {
    double angle, drag, lift;    // radians
  };

  DragTable() = default;
  // from 0 to 90 degrees, ascending, at least two
  explicit DragTable(std::vector<Row> rows_) : rows(std::move(rows_)) {}

  bool empty() const { return rows.empty(); }
  const std::vector<Row> &all() const { return rows; }

  DragTerms terms(double across, double along) const
  {
    const double speed_sq = across * across + along * along;
    if (!(speed_sq > 0.0)) return {0.0, 0.0, 0.0, 0.0};
    const double speed = std::sqrt(speed_sq), sine = across / speed, cosine = along / speed;
    const double angle = std::atan2(across, along);
    auto above = std::upper_bound(rows.begin() + 1, rows.end() - 1, angle,
                                  [](double a, const Row &row) { return a < row.angle; });
    const Row &lo = *(above - 1), &hi = *above;
    const double per_angle = 1.0 / (hi.angle - lo.angle);
    const double share = std::min(1.0, std::max(0.0, (angle - lo.angle) * per_angle));
    const double drag = lo.drag + share * (hi.drag - lo.drag);
    const double lift = lo.lift + share * (hi.lift - lo.lift);
    const double drag_rate = (hi.drag - lo.drag) * per_angle;
    const double lift_rate = (hi.lift - lo.lift) * per_angle;
    const double n = drag * sine + lift * cosine, t = drag * cosine - lift * sine;
    const double n_rate = drag_rate * sine + lift_rate * cosine + t;
    const double t_rate = drag_rate * cosine - lift_rate * sine - n;
    // d|u|/d across = sin a, d a/d across = cos a / |u|; d|u|/d along = cos a, d a = -sin a / |u|
    const double normal_slope = speed * (2.0 * sine * n + cosine * n_rate);
    const double tangential_slope = speed * (2.0 * cosine * t - sine * t_rate);
    const double normal = speed_sq * n, tangential = speed_sq * t;
    return {normal, tangential, std::max({0.0, normal_slope, across > 0.0 ? normal / across : 0.0}),
            std::max({0.0, tangential_slope, along > 0.0 ? tangential / along : 0.0})};
  }

 private:
  std::vector<Row> rows;
};

}    // namespace sphcloth

#endif
