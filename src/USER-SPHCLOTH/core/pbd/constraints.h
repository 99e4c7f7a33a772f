// SPDX-License-Identifier: GPL-2.0-or-later
// Position-based constraints: distance (4), hinge (5) to (6), projection (7) to (9).
//
// One constraint C at a time, written without branches so that loops over many of them are vectors
// (core/pbd/cloth_solver.h).  Equation (8) is used in its mass-weighted form with a compliance,
//   d lambda = -k' (C + a lambda) / (sum_j w_j |grad_j C|^2 + a),   dp_i = w_i grad_i C d lambda,
// which keeps linear and angular momentum and leaves a pinned vertex (w = 0) where it is.
// a = 0: plain position-based dynamics with k' of (9).  k' = 1, a = compliance/dt^2, lambda kept
// over the sweeps of a step: Macklin, Mueller & Chentanez, MIG 2016.
// Mueller et al., J. Vis. Commun. Image R. 18 (2007) 109.

#ifndef SPHCLOTH_CORE_PBD_CONSTRAINTS_H
#define SPHCLOTH_CORE_PBD_CONSTRAINTS_H

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/sph/kernel.h"
#include "core/util/simd.h"

namespace sphcloth {

using Vec3 = Eigen::Vector3d;

// (9): what one of n iterations must do so that all of them together do k.  k = 1 gives 1.

inline double stiffness_per_iteration(double k, int n) { return -std::expm1(std::log1p(-k) / n); }

// A constraint with k < 1 is a spring: by (8) with a compliance, k = W/(W + a), a =
// compliance/dt^2, so that k/(1 - k) grows with the square of the step.  k of the same spring in
// another step; ratio: the square of the step for which k holds over the square of the other one.

SPHCLOTH_INLINE double rescaled_stiffness(double k, double ratio)
{
  return k / (k + (1.0 - k) * ratio);
}

// What one constraint of a mesh is made of.  The multiplier never exceeds `max_lambda`: infinity,
// or 0 for a constraint that only pulls.

struct Spring {
  double rest = 0.0;    // length or angle
  double k = 1.0;    // k' of (9)
  double compliance = 0.0;    // a dt^2
  double max_lambda = 0.0;
};

// d lambda; weight = sum_j w_j |grad_j C|^2.  A constraint that can move nothing is left alone.
// The division does not wait for the error: a projection takes as long as its longest chain.

SPHCLOTH_INLINE double multiplier_step(double error, double weight, double k, double a,
                                       double lambda, double max_lambda)
{
  const double denominator = weight + a;
  const double share = denominator > 0.0 ? k : 0.0;
  const double by = -share / (denominator > 0.0 ? denominator : 1.0);
  return std::min(by * (error + a * lambda), max_lambda - lambda);
}

// (4): dp_1 = w_1 d, dp_2 = -w_2 d.  Coincident ends have no direction: they are left alone until
// another constraint or a force parts them.

struct DistanceStep {
  double x, y, z;    // d
  double lambda;    // d lambda
};

// (dx, dy, dz) = p_1 - p_2

SPHCLOTH_INLINE DistanceStep distance_step(double dx, double dy, double dz, double w, double rest,
                                           double k, double a, double lambda, double max_lambda)
{
  const double length = std::sqrt(dx * dx + dy * dy + dz * dz);
  const bool apart = length > 0.0;
  const double per_length = 1.0 / (apart ? length : 1.0);
  const double step = multiplier_step(length - rest, w, apart ? k : 0.0, a, lambda, max_lambda);
  const double along = step * per_length;
  return {along * dx, along * dy, along * dz, step};
}

// The direction that an edge had at the start of the step is of no use if it has turned by more
// than 60 degrees since (cosine: of that angle, times the length `before` that it had), or if the
// step is long for its tension: a string of links of length l and masses m under a tension T swings
// ever higher if dt^2 T > m l, which is a pull of 2.  pull: what its ends are moved, over its
// length.

inline constexpr double MAX_PULL = 0.5;

SPHCLOTH_INLINE bool start_is_void(double cosine, double before, double pull)
{
  return !(cosine >= 0.5 * before && before > 0.0 && pull < MAX_PULL);
}

// The same along the direction (sx, sy, sz) that the edge had at the start of the step, as SHAKE
// does: second order in time.  The length changes with the cosine between the two; where the start
// is void the present direction is taken.

SPHCLOTH_INLINE DistanceStep distance_step_along(double dx, double dy, double dz, double sx,
                                                 double sy, double sz, double w, double rest,
                                                 double k, double a, double lambda,
                                                 double max_lambda)
{
  const double length = std::sqrt(dx * dx + dy * dy + dz * dz);
  const double before = std::sqrt(sx * sx + sy * sy + sz * sz);
  const bool apart = length > 0.0;
  const double per_length = 1.0 / (apart ? length : 1.0);
  const double cosine = (dx * sx + dy * sy + dz * sz) * per_length;
  const double error = length - rest;
  const double pull = (std::fabs(error) + w * std::fabs(lambda)) * per_length;
  const bool present = start_is_void(cosine, before, pull);
  const double inv = present ? per_length : 1.0 / (before > 0.0 ? before : 1.0);
  const double nx = inv * (present ? dx : sx), ny = inv * (present ? dy : sy),
               nz = inv * (present ? dz : sz);
  const double slope = present ? 1.0 : inv * cosine;
  const double step = multiplier_step(error, w * slope, apart ? k : 0.0, a, lambda, max_lambda);
  return {step * nx, step * ny, step * nz, step};
}

// Arc tangent of y/x in the right quadrant, for vectors: rational approximation of Moshier's
// Cephes library, to the last digit or two.

SPHCLOTH_INLINE double arc_tangent(double y, double x)
{
  const double ax = std::fabs(x), ay = std::fabs(y);
  const double low = std::min(ax, ay), high = std::max(ax, ay);
  const bool steep = low > 0.41421356237309503 * high;    // tan(pi/8)
  const double s = (steep ? low - high : low) / (steep ? low + high : (high > 0.0 ? high : 1.0));
  const double z = s * s;
  const double p = (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z -
                     7.500855792314704667340e1) *
                        z -
                    1.228866684490136173410e2) *
          z -
      6.485021904942025371773e1;
  const double q = ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z +
                     4.328810604912902668951e2) *
                        z +
                    4.853903996359136964868e2) *
          z +
      1.945506571482613964425e2;
  double angle = s + s * z * p / q + (steep ? 0.25 * PI : 0.0);
  angle = ay > ax ? 0.5 * PI - angle : angle;
  angle = x < 0.0 ? PI - angle : angle;
  return std::copysign(angle, y);
}

// Hinge: vertices in the order of a LAMMPS dihedral, wing a, edge 1, edge 2, wing b.  The angle is
// signed, 0 when flat, positive or negative for ridge and valley, in (-pi, pi]: by arc tangent,
// since arccos of (5) has no sign and no digits near flat.  Gradients as in Bridson, Marino &
// Fedkiw, SCA 2003, equation for the bending mode: each wing moves along its triangle's normal, the
// ends of the edge by shares of that.

struct HingeShape {
  double angle;
  double ax, ay, az, bx, by, bz;    // gradients of the wings a and b
  double a2, b2;    // gradient of edge 2: -(a2 grad_a + b2 grad_b); of edge 1: what makes the sum 0
  double valid;    // 1, or 0 for a degenerate triangle, where no angle exists
};

// positions relative to edge 1: (ux, ..) wing a, (ex, ..) edge 2, (vx, ..) wing b

SPHCLOTH_INLINE HingeShape hinge_shape(double ux, double uy, double uz, double ex, double ey,
                                       double ez, double vx, double vy, double vz)
{
  HingeShape h;
  // na = (e1 - a) x (e2 - a) = u x e turned, nb = (e2 - b) x (e1 - b)
  const double nax = ey * uz - ez * uy, nay = ez * ux - ex * uz, naz = ex * uy - ey * ux;
  const double nbx = vy * ez - vz * ey, nby = vz * ex - vx * ez, nbz = vx * ey - vy * ex;
  const double length_sq = ex * ex + ey * ey + ez * ez;
  const double na_sq = nax * nax + nay * nay + naz * naz;
  const double nb_sq = nbx * nbx + nby * nby + nbz * nbz;
  // a triangle thinner than 1e-7 of its edge carries no usable normal, nor does one so small that
  // one over its squares is infinite
  const double tiny = 1e-14 * length_sq, none = 1e-200;
  const double thin_a = na_sq - tiny * (ux * ux + uy * uy + uz * uz) - none,
               thin_b = nb_sq - tiny * (vx * vx + vy * vy + vz * vz) - none;
  // of what is not valid nothing is used; it must only be finite
  const bool valid = std::min(thin_a, thin_b) > 0.0;
  h.valid = valid ? 1.0 : 0.0;
  const double length = std::sqrt(valid ? length_sq : 1.0);
  const double cx = nay * nbz - naz * nby, cy = naz * nbx - nax * nbz, cz = nax * nby - nay * nbx;
  h.angle = arc_tangent(cx * ex + cy * ey + cz * ez, length * (nax * nbx + nay * nby + naz * nbz));
  const double ga = -length / (valid ? na_sq : 1.0), gb = -length / (valid ? nb_sq : 1.0);
  h.ax = ga * nax, h.ay = ga * nay, h.az = ga * naz;
  h.bx = gb * nbx, h.by = gb * nby, h.bz = gb * nbz;
  const double inv = 1.0 / (valid ? length_sq : 1.0);
  h.a2 = inv * (ux * ex + uy * ey + uz * ez);
  h.b2 = inv * (vx * ex + vy * ey + vz * ez);
  return h;
}

// (5) with the difference wrapped to (-pi, pi], so that a rest angle near 180 degrees holds

SPHCLOTH_INLINE double angle_difference(double angle, double rest)
{
  const double d = angle - rest;
  return d > PI ? d - 2.0 * PI : (d <= -PI ? d + 2.0 * PI : d);
}

// If only vertices can move that hardly turn the hinge (an edge vertex below a right angle, the
// others pinned), a projection would throw them far away: below this share of the lever that a
// wing has, squared, the hinge is left to its neighbors.
inline constexpr double MIN_LEVER = 1e-3;

// the share of the relative velocity (vx, vy, vz) of two ends along their edge, over the sum of the
// inverse masses: what is taken from the one times its w, and given to the other

SPHCLOTH_INLINE DistanceStep damping_step(double dx, double dy, double dz, double vx, double vy,
                                          double vz, double w, double share)
{
  const double length_sq = dx * dx + dy * dy + dz * dz;
  const double weight = length_sq * w;
  const bool can = weight > 0.0;
  const double along = -share * (vx * dx + vy * dy + vz * dz) / (can ? weight : 1.0);
  const double step = can ? along : 0.0;
  return {step * dx, step * dy, step * dz, step};
}

// gradients of the angle at wing a, edge 1, edge 2 and wing b, from positions relative to edge 1

inline std::array<Vec3, 4> hinge_gradients(const Vec3 &a, const Vec3 &e2, const Vec3 &b)
{
  const HingeShape h = hinge_shape(a[0], a[1], a[2], e2[0], e2[1], e2[2], b[0], b[1], b[2]);
  const Vec3 ga(h.ax, h.ay, h.az), gb(h.bx, h.by, h.bz);
  const Vec3 g2 = -h.a2 * ga - h.b2 * gb;
  return {ga, -ga - g2 - gb, g2, gb};
}

// angle of a hinge, for rest angles; NaN for a degenerate one

inline double hinge_angle(const Vec3 &a, const Vec3 &e1, const Vec3 &e2, const Vec3 &b)
{
  const Vec3 u = a - e1, e = e2 - e1, v = b - e1;
  const HingeShape h = hinge_shape(u[0], u[1], u[2], e[0], e[1], e[2], v[0], v[1], v[2]);
  return h.valid > 0.0 ? h.angle : std::nan("");
}

}    // namespace sphcloth

#endif
