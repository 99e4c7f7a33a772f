// SPDX-License-Identifier: GPL-2.0-or-later
// The impulse between two bodies in contact: restitution along the normal, Coulomb friction across.

#ifndef SPHCLOTH_CORE_CONTACT_CONTACT_IMPULSE_H
#define SPHCLOTH_CORE_CONTACT_CONTACT_IMPULSE_H

#include <Eigen/Core>

#include <algorithm>

namespace sphcloth {

inline Eigen::Vector3d clamp_length(const Eigen::Vector3d &v, double max)
{
  const double length = v.norm();
  return length > max ? Eigen::Vector3d(max / length * v) : v;
}

struct ContactMotion {
  Eigen::Vector3d velocity, normal;    // of the first body relative to the second, and towards it
  double speed_before = 0.0;    // along the normal, before the contact
  double mass = 1.0;    // effective
};

// what has been exchanged so far, by projections of positions and passes over velocities

struct ExchangedImpulse {
  double normal = 0.0;
  Eigen::Vector3d friction = Eigen::Vector3d::Zero();
};

// On the first body, in addition to what was exchanged, and added to that: that changes the speed
// along the normal by what is due, and takes as much of the sliding as Coulomb's law allows.  The
// sum of normal impulses never pulls.

inline Eigen::Vector3d impulse_for(double due, const ContactMotion &m, ExchangedImpulse &so_far,
                                   double friction)
{
  const double normal = std::max(due * m.mass, -so_far.normal);
  Eigen::Vector3d impulse = normal * m.normal;
  so_far.normal += normal;
  if (friction > 0.0) {
    impulse -= so_far.friction;
    so_far.friction =
        clamp_length(so_far.friction - m.mass * (m.velocity - m.velocity.dot(m.normal) * m.normal),
                     friction * so_far.normal);
    impulse += so_far.friction;
  }
  return impulse;
}

// The same behind projected positions, which may leave a separating velocity, or not all of the
// approach gone: the bodies separate with the share of the approach that the restitution gives
// back, and no more.

inline Eigen::Vector3d contact_impulse(const ContactMotion &m, ExchangedImpulse &so_far,
                                       double restitution, double friction)
{
  const double target = restitution * std::max(0.0, -m.speed_before);
  return impulse_for(target - m.velocity.dot(m.normal), m, so_far, friction);
}

}    // namespace sphcloth

#endif
