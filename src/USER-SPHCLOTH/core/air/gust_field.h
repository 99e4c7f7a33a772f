// SPDX-License-Identifier: GPL-2.0-or-later
// A gust as a sum of Fourier modes, each across its wave vector: a field without divergence
// (R. H. Kraichnan, Phys. Fluids 13 (1970) 22), with von Karman's spectrum of isotropic turbulence
// (T. von Karman, Proc. Natl. Acad. Sci. 34 (1948) 530),
//   E(k) ~ (a L k)^4 / (1 + (a L k)^2)^(17/6),  a = 1.339,
// L the longitudinal integral length.  The field does not change; the mean wind carries it along
// (Taylor's frozen turbulence).
//
// Modes come in threes of one wave number, with wave vectors at right angles and directions along
// the next of these, so that all three components have the same variance, exactly.

#ifndef SPHCLOTH_CORE_AIR_GUST_FIELD_H
#define SPHCLOTH_CORE_AIR_GUST_FIELD_H

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace sphcloth {

class GustField {
 public:
  struct Mode {
    Eigen::Vector3d wave;    // vector, in turns per length
    Eigen::Vector3d velocity;    // amplitude
    double phase;    // in turns
  };

  GustField() = default;
  // rms of each component, integral length
  GustField(double sigma, double length, std::uint64_t seed);

  bool empty() const { return modes.empty(); }
  const std::vector<Mode> &all() const { return modes; }

  // adds to the velocities of n points, columns x, y and z
  void add(int n, const double *const x[3], double *const v[3]) const;

 private:
  std::vector<Mode> modes;
};

}    // namespace sphcloth

#endif
