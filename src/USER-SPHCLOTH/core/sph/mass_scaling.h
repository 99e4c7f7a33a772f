// SPDX-License-Identifier: GPL-2.0-or-later
// Selective mass scaling of light vertices beside fluid (after Olovsson, Simonsson and Unosson,
// Int. J. Numer. Methods Eng. 63, 1436, 2005).
//
// Small motions obey M x'' = -K x (core/sph/stiffness.h).  Their part in the vertices alone is
// bounded, with Cauchy's inequality over the vertices l beside a fluid particle k, by springs of
// vertex and fluid along the line between them:
//   d_kj = s_k^2 |g_kj| sum_l |g_kl|,    K_vv <= D,    D_j = sum_k d_kj e_kj e_kj^T.
// In a step of dt each spring is a mass a dt^2 d_kj that resists the *difference* of what vertex
// and fluid are accelerated by: A_j = a dt^2 D_j joins the mass of the vertex, and the fluid gets
// the opposite impulse, pair by pair, so that momentum and angular momentum are kept:
//   (m_j + A_j) dv_j = dt f_j + sum_k a dt^2 d_kj e e^T dv_k,    dv_k = dt f_k/m_k,
//   dv_k += sum_j a dt^2 d_kj e e^T (dv_j - dv_k)/m_k.
// The response of velocities to forces is symmetric, and positive as long as
// a dt^2 sum_j d_kj <= m_k: leapfrog with it is stable up to a step that follows from the fluid
// alone, whatever the mass of the vertices, and takes no energy out of any motion; with a = 1/2
// twice the stiffness of the fluid bounds it (the square of a sum is at most twice the squares).
// Motions much slower than the step do not change, those as fast as the step are slower.
//
// A mass that is there only now must not bring in energy: where the springs of a fluid particle
// become stiffer, or the step longer, the masses that are new meet their pair in its motion
// w across the surface of the vertices, without elasticity.  With phi_k the new part of what is
// there, the impulse a dt^2 d_kj phi_k e w on the vertex joins that of dv_k, and the fluid gets the
// opposite.  With n_k along sum_j |g_kj| e_kj, w is the part that e.u and (e.n_k)(n_k.u) have in
// common, u = v_k - v_j: what flows along the surface is not held, and as a share of e.u the
// impulse of a pair never adds energy.

#ifndef SPHCLOTH_CORE_SPH_MASS_SCALING_H
#define SPHCLOTH_CORE_SPH_MASS_SCALING_H

#include "core/sph/stiffness.h"
#include "core/sph/vertex_pairs.h"

#include <Eigen/Dense>

#include <algorithm>

namespace sphcloth {

inline double largest_eigenvalue(const DirectionSums &of)
{
  Eigen::Matrix3d m;
  m << of.xx, of.xy, of.xz, of.xy, of.yy, of.yz, of.xz, of.yz, of.zz;
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

class MassScaling {
 public:
  using Vec3 = Eigen::Vector3d;
  using Mat3 = Eigen::Matrix3d;

  static constexpr double SHARE = 0.5;    // a
  // Square of the frequency of fluid beside vertices, over that of it alone.  For the worst of all
  // motions 2 would be needed; in order and disorder, on both sides of a sheet, 1.2 is enough.
  static constexpr double OF_FLUID = 1.2;
  // of the mass of a fluid particle: what may be added to vertices around it
  static constexpr double MAX_ADDED = 0.9;

  // Square of the frequency that bounds the step of a fluid particle beside vertices, from that of
  // it alone, its strength s^2 sum |g_l|, and the sum of |g_l| e e^T
  static double frequency_sq(double alone_sq, double strength, const DirectionSums &gradients,
                             double mass)
  {
    const double added = SHARE * strength * largest_eigenvalue(gradients);    // over dt^2
    return std::max(OF_FLUID * alone_sq, 4.0 * added / (MAX_ADDED * mass));
  }

  // A vertex of this inverse mass, and stiffness D_j, in a step of dt
  MassScaling(const Mat3 &stiffness, double inverse_mass_, double dt) :
      inverse_mass(inverse_mass_),
      kept((Mat3::Identity() + inverse_mass_ * SHARE * dt * dt * stiffness).inverse())
  {
  }

  // What is left of a change of velocity that the vertex alone would have
  Vec3 scaled(const Vec3 &change) const { return kept * change; }
  // the same with the fluid, whose changes are `carried`: sum of a dt^2 d_kj e e^T dv_k
  Vec3 scaled(const Vec3 &change, const Vec3 &carried) const
  {
    return kept * (change + inverse_mass * carried);
  }

 private:
  double inverse_mass;
  Mat3 kept;
};

inline Eigen::Vector3d direction(const VertexPairs::Pair &pair) { return {pair.x, pair.y, pair.z}; }

// D_j of the n-th vertex

inline Eigen::Matrix3d stiffness_of(const VertexPairs &pairs, int n)
{
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const VertexPairs::Pair &pair : pairs.of(n)) {
    const Eigen::Vector3d e = direction(pair);
    sum += pair.stiffness * e * e.transpose();
  }
  return sum;
}

// Of a fluid particle in a step: the change of velocity by its forces, dv_k, and phi_k

struct FluidKick {
  Eigen::Vector3d change = Eigen::Vector3d::Zero();
  double new_part = 0.0;

  // what a spring along e takes up of it
  double along(const Eigen::Vector3d &e, double motion) const
  {
    return e.dot(change) + new_part * motion;
  }
  // phi_k, from dt^2 sum_j d_kj in the last step and in this one
  static double new_part_of(double before, double now)
  {
    return now > before ? 1.0 - before / now : 0.0;
  }
};

// Its sum of a dt^2 d_kj e (e.dv_k + phi_k w); kick(k) is that of the fluid

template <class Kick>
Eigen::Vector3d carried_by_fluid(const VertexPairs &pairs, int n, double dt, Kick kick)
{
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const VertexPairs::Pair &pair : pairs.of(n)) {
    const Eigen::Vector3d e = direction(pair);
    sum += pair.stiffness * kick(pair.fluid).along(e, pair.motion) * e;
  }
  return MassScaling::SHARE * dt * dt * sum;
}

// give(k, impulse) to the fluid, where the vertex changes its velocity by that, and the kicks act
// for a part of the step

template <class Kick, class Give>
void give_to_fluid(const VertexPairs &pairs, int n, double dt, const Eigen::Vector3d &change,
                   double part_of_step, Kick kick, Give give)
{
  for (const VertexPairs::Pair &pair : pairs.of(n)) {
    const Eigen::Vector3d e = direction(pair);
    const double mass = MassScaling::SHARE * dt * dt * pair.stiffness;
    const double taken_up = part_of_step * kick(pair.fluid).along(e, pair.motion);
    give(pair.fluid, mass * (e.dot(change) - taken_up) * e);
  }
}

}    // namespace sphcloth

#endif
