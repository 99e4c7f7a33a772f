// SPDX-License-Identifier: GPL-2.0-or-later
// Triangles in groups: scattered vertices become columns, columns impulses, and these are added up.

#include "core/air/air_loads.h"

#include "core/util/simd.h"

#include <algorithm>
#include <cmath>

using namespace sphcloth;
using Eigen::Vector3d;

namespace {

constexpr int BATCH = 64;

struct Column {
  alignas(64) double of[BATCH];
  double &operator[](int k) { return of[k]; }
  const double &operator[](int k) const { return of[k]; }
};
using Columns3 = std::array<Column, 3>;

struct Batch {
  std::array<Columns3, 2> edge;    // from the first vertex
  Columns3 u;    // of the air, relative
  Columns3 gain;
  Columns3 n;    // of unit length
  Columns3 along;    // tangential part of u
  Column area, dry, inverse_mass;
  Column across, speed_along;
  Column normal, tangential, normal_slope, tangential_slope;    // see DragTerms
  Columns3 impulse;    // a third of it
};

void load(Batch &b, const AirTriangles &t, const AirMotion &motion, int begin, int n)
{
  for (int k = 0; k < BATCH; k++) {
    const int m = begin + std::min(k, n - 1);
    const int s0 = t.slot[0][m], s1 = t.slot[1][m], s2 = t.slot[2][m];
    for (int d = 0; d < 3; d++) {
      b.edge[0][d][k] = motion.x[s1][d] - motion.x[s0][d];
      b.edge[1][d][k] = motion.x[s2][d] - motion.x[s0][d];
      b.u[d][k] = (motion.v[s0][d] + motion.v[s1][d] + motion.v[s2][d]) * (-1.0 / 3.0);
      b.gain[d][k] = (motion.gain[s0][d] + motion.gain[s1][d] + motion.gain[s2][d]) * (1.0 / 3.0);
    }
    if (!t.lee_share.empty()) {
      const double kept_off = t.lee_share[m] * (1.0 / 3.0);
      for (int d = 0; d < 3; d++)
        b.u[d][k] -= kept_off * (motion.wind[s0][d] + motion.wind[s1][d] + motion.wind[s2][d]);
    }
    b.dry[k] = t.open_share.empty() ? 1.0 : t.open_share[m];
    b.inverse_mass[k] = t.inverse_mass[m];
  }
}

// A triangle without an area takes no air.

SPHCLOTH_MULTIVERSION void find_angles(Batch &b)
{
  const Columns3 &e = b.edge[0], &g = b.edge[1];
#pragma omp simd
  for (int k = 0; k < BATCH; k++) {
    const double x = e[1][k] * g[2][k] - e[2][k] * g[1][k];
    const double y = e[2][k] * g[0][k] - e[0][k] * g[2][k];
    const double z = e[0][k] * g[1][k] - e[1][k] * g[0][k];
    const double length = std::sqrt(x * x + y * y + z * z);
    const double by = 1.0 / (length + 1e-300);
    const double nx = by * x, ny = by * y, nz = by * z;
    const double across = nx * b.u[0][k] + ny * b.u[1][k] + nz * b.u[2][k];
    const double tx = b.u[0][k] - across * nx, ty = b.u[1][k] - across * ny,
                 tz = b.u[2][k] - across * nz;
    const double sign = across < 0.0 ? -1.0 : 1.0;
    b.area[k] = 0.5 * length;
    b.n[0][k] = sign * nx;    // towards the lee side
    b.n[1][k] = sign * ny;
    b.n[2][k] = sign * nz;
    b.across[k] = sign * across;
    b.along[0][k] = tx;
    b.along[1][k] = ty;
    b.along[2][k] = tz;
    b.speed_along[k] = std::sqrt(tx * tx + ty * ty + tz * tz);
  }
}

SPHCLOTH_MULTIVERSION void find_terms(Batch &b, const DragCoefficients &by)
{
#pragma omp simd
  for (int k = 0; k < BATCH; k++) {
    const DragTerms terms = by.terms(b.across[k], b.speed_along[k]);
    b.normal[k] = terms.normal;
    b.tangential[k] = terms.tangential;
    b.normal_slope[k] = terms.normal_slope;
    b.tangential_slope[k] = terms.tangential_slope;
  }
}

void find_terms(Batch &b, const DragTable &by, int n)
{
  for (int k = 0; k < BATCH; k++) {
    const int m = std::min(k, n - 1);
    const DragTerms terms = by.terms(b.across[m], b.speed_along[m]);
    b.normal[k] = terms.normal;
    b.tangential[k] = terms.tangential;
    b.normal_slope[k] = terms.normal_slope;
    b.tangential_slope[k] = terms.tangential_slope;
  }
}

SPHCLOTH_MULTIVERSION void find_impulses(Batch &b, double half_density, double dt)
{
#pragma omp simd
  for (int k = 0; k < BATCH; k++) {
    const double by = dt * half_density * b.area[k] * b.dry[k];
    const double gain_across =
        b.n[0][k] * b.gain[0][k] + b.n[1][k] * b.gain[1][k] + b.n[2][k] * b.gain[2][k];
    const double slope_n = by * b.normal_slope[k], slope_t = by * b.tangential_slope[k];
    const double z_n = slope_n * b.inverse_mass[k], z_t = slope_t * b.inverse_mass[k];
    const double inv_n = 1.0 / (1.0 + z_n + 0.5 * z_n * z_n);
    const double inv_t = 1.0 / (1.0 + z_t + 0.5 * z_t * z_t);
    const double phi_n = (1.0 + 0.5 * z_n) * inv_n, psi_n = 0.5 * (1.0 + z_n) * inv_n;
    const double phi_t = (1.0 + 0.5 * z_t) * inv_t, psi_t = 0.5 * (1.0 + z_t) * inv_t;
    const double force_t = by * b.tangential[k] / (b.speed_along[k] + 1e-300);
    const double j_n = phi_n * by * b.normal[k] - psi_n * slope_n * gain_across;
    for (int d = 0; d < 3; d++) {
      const double gain_along = b.gain[d][k] - gain_across * b.n[d][k];
      b.impulse[d][k] = (1.0 / 3.0) *
          (j_n * b.n[d][k] + phi_t * force_t * b.along[d][k] - psi_t * slope_t * gain_along);
    }
  }
}

}    // namespace

double sphcloth::add_air_impulses(const AirTriangles &triangles, const AirMotion &motion,
                                  const AirDrag &drag, double dt, Vector3d *impulse)
{
  Batch b;
  double area = 0.0;
  for (int begin = 0; begin < triangles.size(); begin += BATCH) {
    const int n = std::min(BATCH, triangles.size() - begin);
    load(b, triangles, motion, begin, n);
    find_angles(b);
    if (drag.table.empty())
      find_terms(b, drag.coefficients);
    else
      find_terms(b, drag.table, n);
    find_impulses(b, 0.5 * drag.density, dt);
    for (int k = 0; k < n; k++) {
      const Vector3d third(b.impulse[0][k], b.impulse[1][k], b.impulse[2][k]);
      for (const std::vector<int> &slot : triangles.slot) impulse[slot[begin + k]] += third;
      area += b.area[k] * b.dry[k];
    }
  }
  return area;
}
