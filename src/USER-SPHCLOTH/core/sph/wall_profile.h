// SPDX-License-Identifier: GPL-2.0-or-later
// What a wall adds to the density over rho0, a function of lambda.  The half-space adds lambda.
// Its force is the gradient of the energy of the particles alone, half of what two fluids have
// together, and so their pressure doubles at the wall.  This function has, at each layer of a
// lattice that begins half a spacing away, what the layer lacks of its density, and twice what it
// lacks of its gradient: the lattice is in equilibrium with one density and pressure.  Between the
// layers it is the cubic Hermite interpolation of log f over log lambda, outside a power of lambda.
// Nearer than NEAR_LAYER times the lambda of the first layer it is linear: a power would be stiffer
// than fluid where a particle hits the wall, and shorten the step.

#ifndef SPHCLOTH_CORE_SPH_WALL_PROFILE_H
#define SPHCLOTH_CORE_SPH_WALL_PROFILE_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/sph/calibration.h"
#include "core/sph/plane_wall.h"

namespace sphcloth {

class WallProfile {
 public:
  WallProfile() = default;
  // `reflection`: 1, or 2 where the wall has the pressure of the particle, too
  WallProfile(const WallTable &, const LatticeSums &, double support_over_spacing,
              double reflection);

  bool changes() const { return !knots.empty(); }
  WallTable::Value operator()(const WallTable::Value &of) const;

 private:
  struct Knot {    // log lambda, log f and its derivative; by falling lambda
    double at, value, slope;
  };
  std::vector<Knot> knots;
  static constexpr double NEAR_LAYER = 1.1;
};

inline WallProfile::WallProfile(const WallTable &table, const LatticeSums &lattice,
                                double support_over_spacing, double reflection)
{
  constexpr double SMALLEST = 1e-4;    // of the first layer
  for (const LatticeSums::Missing &missing : lattice.layers) {
    if (missing.sum < SMALLEST * lattice.layers.front().sum) break;
    const WallTable::Value wall =
        table((static_cast<double>(knots.size()) + 0.5) / support_over_spacing);
    const double fall = -wall.slope / (support_over_spacing * wall.lambda);
    knots.push_back({std::log(wall.lambda), std::log(missing.sum),
                     2.0 * missing.gradient / (reflection * missing.sum * fall)});
  }
}

inline WallTable::Value WallProfile::operator()(const WallTable::Value &of) const
{
  if (knots.empty() || !(of.lambda > 0.0)) return of;
  const double at = std::log(of.lambda);
  const Knot &nearest = knots.front(), &farthest = knots.back();
  if (at >= nearest.at) {
    const double first = std::exp(nearest.at), m = nearest.slope;
    const double power_to = std::min(of.lambda, NEAR_LAYER * first), beyond = of.lambda - power_to;
    const double f = std::exp(nearest.value) * std::pow(power_to / first, m);
    const double slope = m * f / power_to, bend = beyond > 0.0 ? 0.0 : (m - 1.0) * slope / power_to;
    return {f + slope * beyond, slope * of.slope,
            slope * of.curvature + bend * of.slope * of.slope};
  }
  double value = farthest.value + farthest.slope * (at - farthest.at), slope = farthest.slope,
         curvature = 0.0;
  if (at > farthest.at) {
    std::size_t k = 1;
    while (at < knots[k].at) k++;
    const Knot &a = knots[k - 1], &b = knots[k];
    const double length = a.at - b.at;
    const HermitePiece piece = hermite(b.value, a.value - b.value, b.slope * length,
                                       a.slope * length, (at - b.at) / length);
    value = piece.value;
    slope = piece.slope / length;
    curvature = piece.curvature / (length * length);
  }
  const double f = std::exp(value), fall = of.slope / of.lambda;
  return {
      f, f * slope * fall,
      f * ((slope * (slope - 1.0) + curvature) * fall * fall + slope * of.curvature / of.lambda)};
}

// A wall beside a particle: the half-space, and what it adds if it is the only one

struct NearWall {
  int wall;    // which one
  double delta;    // distance/H
  WallTable::Value half_space, alone;

  NearWall(int wall_, double delta_, const WallTable &table, const WallProfile &profile) :
      wall(wall_), delta(delta_), half_space(table(delta_)), alone(profile(half_space))
  {
  }
};

// What several walls, an array, add together; those out of reach add nothing.  Half-spaces add the
// part of the kernel that they miss together; with a profile, whose values may exceed 1, only a
// bounded part g = f/(1 + f^2) of each overlaps with that of the others, so that each keeps a share
// of its force above 0.

class JointWalls {
 public:
  JointWalls() = default;
  // with the profile of these
  JointWalls(const NearWall *walls_, std::size_t n_, const WallProfile &profile) :
      overlap(profile.changes()), walls(walls_), n(n_)
  {
  }

  std::size_t size() const { return n; }
  const NearWall &operator[](std::size_t k) const { return walls[k]; }
  // of the half-spaces together
  double half_spaces_lambda() const { return joint_lambda(half_spaces()); }
  double half_space_share(std::size_t k) const { return joint_share(half_spaces(), k); }

  double lambda() const;
  // its derivative with respect to that of wall k
  double share(std::size_t k) const;
  // its derivatives with respect to delta of wall k; the second without that of the share
  double slope(std::size_t k) const { return share(k) * walls[k].alone.slope; }
  double curvature(std::size_t k) const { return share(k) * walls[k].alone.curvature; }
  // the second derivative with respect to delta of walls k and l
  double curvature(std::size_t k, std::size_t l) const;

 private:
  struct Values {    // one of each wall
    const NearWall *of;
    std::size_t n;
    WallTable::Value NearWall::*value;
    std::size_t size() const { return n; }
    const WallTable::Value &operator[](std::size_t k) const { return of[k].*value; }
  };
  bool overlap = false;
  const NearWall *walls = nullptr;
  std::size_t n = 0;

  Values half_spaces() const { return {walls, n, &NearWall::half_space}; }
  Values alone() const { return {walls, n, &NearWall::alone}; }
  // g(f) and its derivatives
  static double common(double f) { return f / (1.0 + f * f); }
  static double common_slope(double f)
  {
    const double sq = f * f;
    return (1.0 - sq) / ((1.0 + sq) * (1.0 + sq));
  }
  static double common_curvature(double f)
  {
    const double sq = f * f;
    return 2.0 * f * (sq - 3.0) / std::pow(1.0 + sq, 3);
  }
  // what the other walls leave open
  double open_beside(std::size_t k, std::size_t l) const
  {
    double open = 1.0;
    for (std::size_t m = 0; m < n; m++) {
      const double f = walls[m].alone.lambda;
      if (m != k && m != l) open *= 1.0 - (overlap ? common(f) : f);
    }
    return open;
  }
};

inline double JointWalls::lambda() const
{
  if (!overlap) return joint_lambda(alone());
  double open = 1.0, sum = 0.0;
  for (std::size_t k = 0; k < n; k++) {
    const double f = walls[k].alone.lambda, g = common(f);
    open *= 1.0 - g;
    sum += f - g;
  }
  return 1.0 - open + sum;
}

inline double JointWalls::share(std::size_t k) const
{
  const double open = open_beside(k, k);
  return overlap ? 1.0 - common_slope(walls[k].alone.lambda) * (1.0 - open) : open;
}

inline double JointWalls::curvature(std::size_t k, std::size_t l) const
{
  const WallTable::Value &a = walls[k].alone, &b = walls[l].alone;
  if (k == l) {
    const double of_share = overlap ? -common_curvature(a.lambda) * (1.0 - open_beside(k, k)) : 0.0;
    return curvature(k) + of_share * a.slope * a.slope;
  }
  const double slopes = overlap ? common_slope(a.lambda) * common_slope(b.lambda) : 1.0;
  return -slopes * open_beside(k, l) * a.slope * b.slope;
}

}    // namespace sphcloth

#endif
