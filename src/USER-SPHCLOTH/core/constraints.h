// Position-based constraints: distance (4), hinge (5) to (6), projection (7) to (9).
//
// Pure functions: positions and inverse masses in, corrections out.  Equation (8) is used in its
// mass-weighted form, dp_i = -k' w_i C grad_i C / sum_j w_j |grad_j C|^2, which keeps linear and
// angular momentum and leaves a pinned vertex (w = 0) where it is.
// Mueller et al., J. Vis. Commun. Image R. 18 (2007) 109.

#ifndef SPHCLOTH_CORE_CONSTRAINTS_H
#define SPHCLOTH_CORE_CONSTRAINTS_H

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

#include "kernel.h"

namespace sphcloth {

using Vec3 = Eigen::Vector3d;

// (9): what one of n iterations must do so that all of them together do k.  k = 1 gives 1.

inline double stiffness_per_iteration(double k, int n) { return -std::expm1(std::log1p(-k) / n); }

// (4)

inline double distance_error(const Vec3 &p1, const Vec3 &p2, double rest)
{
  return (p1 - p2).norm() - rest;
}

// Moves both ends; returns C before the projection.  Coincident ends have no direction: they are
// left alone until another constraint or a force parts them.

inline double project_distance(Vec3 &p1, Vec3 &p2, double w1, double w2, double rest, double k)
{
  const Vec3 edge = p1 - p2;
  const double length = edge.norm();
  const double error = length - rest;
  const double w = w1 + w2;
  if (length == 0.0 || w == 0.0) return error;
  const Vec3 step = (k * error / (length * w)) * edge;
  p1 -= w1 * step;
  p2 += w2 * step;
  return error;
}

// Hinge: vertices in the order of a LAMMPS dihedral, wing a, edge 1, edge 2, wing b.  The angle is
// signed, 0 when flat, positive or negative for ridge and valley, in (-pi, pi].

struct Hinge {
  double angle = 0.0;
  std::array<Vec3, 4> grad;    // d angle / d position of wing a, edge 1, edge 2, wing b
  bool valid = false;          // false for a degenerate triangle, where no angle exists
};

// Angle by atan2 (arccos of (5) has no sign and no digits near flat), gradients as in
// Bridson, Marino & Fedkiw, SCA 2003, equation for the bending mode.

inline Hinge hinge(const Vec3 &a, const Vec3 &e1, const Vec3 &e2, const Vec3 &b)
{
  Hinge h;
  const Vec3 edge = e2 - e1;
  const Vec3 na = (e1 - a).cross(e2 - a);
  const Vec3 nb = (e2 - b).cross(e1 - b);
  const double length_sq = edge.squaredNorm();
  const double na_sq = na.squaredNorm();
  const double nb_sq = nb.squaredNorm();
  // a triangle thinner than 1e-7 of its edge carries no usable normal
  const double tiny = 1e-14 * length_sq;
  if (!(na_sq > tiny * (e1 - a).squaredNorm()) || !(nb_sq > tiny * (e1 - b).squaredNorm()))
    return h;

  const double length = std::sqrt(length_sq);
  h.angle = std::atan2(na.cross(nb).dot(edge) / length, na.dot(nb));
  const Vec3 ga = na / na_sq;
  const Vec3 gb = nb / nb_sq;
  h.grad[0] = -length * ga;
  h.grad[3] = -length * gb;
  h.grad[1] = ((e2 - a).dot(edge) / length) * ga + ((e2 - b).dot(edge) / length) * gb;
  h.grad[2] = ((a - e1).dot(edge) / length) * ga + ((b - e1).dot(edge) / length) * gb;
  h.valid = true;
  return h;
}

// (5) with the difference wrapped to (-pi, pi], so that a rest angle near 180 degrees holds

inline double angle_difference(double angle, double rest)
{
  return std::remainder(angle - rest, 2.0 * PI);
}

// If only vertices can move that hardly turn the hinge (an edge vertex below a right angle, the
// others pinned), a projection would throw them far away: below this share of the lever that a
// wing has, squared, the hinge is left to its neighbours.
inline constexpr double LEAST_LEVER = 1e-3;

// Moves the four vertices; returns C before the projection, 0 for a degenerate hinge.

inline double project_hinge(Vec3 &a, Vec3 &e1, Vec3 &e2, Vec3 &b, const std::array<double, 4> &w,
                            double rest, double k)
{
  const Hinge h = hinge(a, e1, e2, b);
  if (!h.valid) return 0.0;
  const double error = angle_difference(h.angle, rest);
  double denominator = 0.0, w_sum = 0.0, steepest = 0.0;
  for (int i = 0; i < 4; i++) {
    const double slope = h.grad[i].squaredNorm();
    denominator += w[i] * slope;
    w_sum += w[i];
    steepest = std::max(steepest, slope);
  }
  if (denominator <= LEAST_LEVER * w_sum * steepest) return error;
  const double step = -k * error / denominator;
  a += step * w[0] * h.grad[0];
  e1 += step * w[1] * h.grad[1];
  e2 += step * w[2] * h.grad[2];
  b += step * w[3] * h.grad[3];
  return error;
}

// Takes away the fraction `share` of the velocity with which two ends stretch or shorten their
// edge.  Rigid motion, and so free fall, is not damped; momentum is kept.

inline void damp_edge(const Vec3 &p1, const Vec3 &p2, Vec3 &v1, Vec3 &v2, double w1, double w2,
                      double share)
{
  const Vec3 edge = p1 - p2;
  const double length_sq = edge.squaredNorm();
  const double w = w1 + w2;
  if (length_sq == 0.0 || w == 0.0) return;
  const Vec3 impulse = (share * (v1 - v2).dot(edge) / (length_sq * w)) * edge;
  v1 -= w1 * impulse;
  v2 += w2 * impulse;
}

}    // namespace sphcloth

#endif
