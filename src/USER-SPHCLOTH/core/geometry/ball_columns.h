// SPDX-License-Identifier: GPL-2.0-or-later
// Balls in columns: which of a run of them are near a place?

#ifndef SPHCLOTH_CORE_GEOMETRY_BALL_COLUMNS_H
#define SPHCLOTH_CORE_GEOMETRY_BALL_COLUMNS_H

#include "core/util/bytes.h"
#include "core/util/simd.h"

#include <Eigen/Core>

#include <vector>

namespace sphcloth {

class BallColumns {
 public:
  void resize(std::size_t n)
  {
    for (std::vector<double> *column : {&x, &y, &z, &r}) column->resize(n);
    near.resize(n);
  }
  void set(int n, const Eigen::Vector3d &center, double radius)
  {
    x[n] = center[0];
    y[n] = center[1];
    z[n] = center[2];
    r[n] = radius;
  }
  Eigen::Vector3d center(int n) const { return {x[n], y[n], z[n]}; }
  double radius(int n) const { return r[n]; }

  // calls visit(n) for every ball from `begin` to `end`, without it, that is not farther from p
  // than `max_distance`
  template <class Visit>
  void within(int begin, int end, const Eigen::Vector3d &p, double max_distance, Visit visit)
  {
    test(begin, end, p, max_distance);
    for (int n = begin; n < end; n++)
      if (near[n]) visit(n);
  }

  double bytes() const { return bytes_of(x, y, z, r, near); }

 private:
  std::vector<double> x, y, z, r;
  std::vector<double> near;    // 0 or 1: of the same width, so that the loop is one of vectors

  SPHCLOTH_MULTIVERSION void test(int begin, int end, const Eigen::Vector3d &p, double max)
  {
    const double px = p[0], py = p[1], pz = p[2];
    const double *const cx = x.data(), *const cy = y.data(), *const cz = z.data(),
                        *const cr = r.data();
    double *const to = near.data();
#pragma omp simd
    for (int n = begin; n < end; n++) {
      const double dx = px - cx[n], dy = py - cy[n], dz = pz - cz[n], reach = max + cr[n];
      to[n] = dx * dx + dy * dy + dz * dz <= reach * reach ? 1.0 : 0.0;
    }
  }
};

}    // namespace sphcloth

#endif
