// SPDX-License-Identifier: GPL-2.0-or-later
// Edges and triangles in columns: which of a run of them may be near a place?  Two sides are apart
// by no less than along the line between their centers: those that pass this test are measured.

#ifndef SPHCLOTH_CORE_GEOMETRY_HULL_COLUMNS_H
#define SPHCLOTH_CORE_GEOMETRY_HULL_COLUMNS_H

#include "core/util/bytes.h"
#include "core/util/simd.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sphcloth {

// centers, and N vectors from there to corners

template <int N> class HullColumns {
 public:
  using Vec3 = Eigen::Vector3d;

  void resize(std::size_t n)
  {
    for (std::vector<double> &column : columns) column.resize(n);
    near.resize(n);
  }
  double bytes() const
  {
    double sum = bytes_of(near);
    for (const std::vector<double> &column : columns) sum += bytes_of(column);
    return sum;
  }

 protected:
  std::array<std::vector<double>, 3 + 3 * N> columns;
  std::vector<double> near;    // 0 or 1: of the same width, so that loops are of vectors

  void store(int n, int vector, const Vec3 &v)
  {
    for (int d = 0; d < 3; d++) columns[3 * vector + d][n] = v[d];
  }
  Vec3 load(int n, int vector) const
  {
    return {columns[3 * vector][n], columns[3 * vector + 1][n], columns[3 * vector + 2][n]};
  }
  template <class Visit> void visit_near(int begin, int end, Visit visit) const
  {
    for (int n = begin; n < end; n++)
      if (near[n]) visit(n);
  }
};

class TriangleColumns : public HullColumns<2> {
 public:
  void set(int n, const Vec3 &a, const Vec3 &b, const Vec3 &c)
  {
    const Vec3 center = (a + b + c) / 3.0;
    store(n, 0, center);
    store(n, 1, a - center);
    store(n, 2, b - center);
  }

  // calls visit(n) for every triangle from `begin` to `end`, without it, that may be within
  // `max_distance` of p
  template <class Visit>
  void within(int begin, int end, const Vec3 &p, double max_distance, Visit visit)
  {
    test(begin, end, p, max_distance * max_distance);
    visit_near(begin, end, visit);
  }

 private:
  SPHCLOTH_MULTIVERSION void test(int begin, int end, const Vec3 &p, double max_sq)
  {
    const double px = p[0], py = p[1], pz = p[2];
    const double *const cx = columns[0].data(), *const cy = columns[1].data(),
                        *const cz = columns[2].data(), *const ax = columns[3].data(),
                        *const ay = columns[4].data(), *const az = columns[5].data(),
                        *const bx = columns[6].data(), *const by = columns[7].data(),
                        *const bz = columns[8].data();
    double *const to = near.data();
#pragma omp simd
    for (int n = begin; n < end; n++) {
      const double dx = px - cx[n], dy = py - cy[n], dz = pz - cz[n];
      const double a = ax[n] * dx + ay[n] * dy + az[n] * dz,
                   b = bx[n] * dx + by[n] * dy + bz[n] * dz, c = -(a + b);
      const double ab = a > b ? a : b, extent = ab > c ? ab : c;
      const double sq = dx * dx + dy * dy + dz * dz, apart = sq - extent;
      to[n] = apart <= 0.0 || apart * apart <= max_sq * sq ? 1.0 : 0.0;
    }
  }
};

class EdgeColumns : public HullColumns<1> {
 public:
  void set(int n, const Vec3 &a, const Vec3 &b)
  {
    store(n, 0, 0.5 * (a + b));
    store(n, 1, 0.5 * (b - a));
  }
  Vec3 center(int n) const { return load(n, 0); }
  double radius(int n) const { return load(n, 1).norm(); }

  // the same of edges, and edge m
  template <class Visit> void within(int begin, int end, int m, double max_distance, Visit visit)
  {
    test(begin, end, m, max_distance * max_distance);
    visit_near(begin, end, visit);
  }

 private:
  SPHCLOTH_MULTIVERSION void test(int begin, int end, int m, double max_sq)
  {
    const double *const cx = columns[0].data(), *const cy = columns[1].data(),
                        *const cz = columns[2].data(), *const ax = columns[3].data(),
                        *const ay = columns[4].data(), *const az = columns[5].data();
    const double px = cx[m], py = cy[m], pz = cz[m], hx = ax[m], hy = ay[m], hz = az[m];
    double *const to = near.data();
#pragma omp simd
    for (int n = begin; n < end; n++) {
      const double dx = px - cx[n], dy = py - cy[n], dz = pz - cz[n];
      const double extent =
          std::fabs(hx * dx + hy * dy + hz * dz) + std::fabs(ax[n] * dx + ay[n] * dy + az[n] * dz);
      const double sq = dx * dx + dy * dy + dz * dz, apart = sq - extent;
      to[n] = apart <= 0.0 || apart * apart <= max_sq * sq ? 1.0 : 0.0;
    }
  }
};

}    // namespace sphcloth

#endif
