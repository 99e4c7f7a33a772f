// SPDX-License-Identifier: GPL-2.0-or-later
// Draws the modes of a gust, and adds them up.

#include "core/air/gust_field.h"

#include "core/util/simd.h"

#include <Eigen/Geometry>

#include <cmath>

using namespace sphcloth;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double PI = 3.14159265358979323846;
constexpr int WAVE_NUMBERS = 16;
// where there is little of the energy below and above, times the length
constexpr double LOWEST = 0.03, HIGHEST = 300.0;

// splitmix64

class Random {
 public:
  explicit Random(std::uint64_t seed) : state(seed) {}
  // from 0 to 1
  double uniform()
  {
    state += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    z ^= z >> 31U;
    return std::ldexp(static_cast<double>(z >> 11U), -53);
  }
  // all alike likely (K. Shoemake, Graphics Gems III, 1992)
  Matrix3d rotation()
  {
    const double u = uniform(), a = 2.0 * PI * uniform(), b = 2.0 * PI * uniform();
    const double p = std::sqrt(1.0 - u), q = std::sqrt(u);
    return Eigen::Quaterniond(q * std::cos(b), p * std::sin(a), p * std::cos(a), q * std::sin(b))
        .toRotationMatrix();
  }

 private:
  std::uint64_t state;
};

double spectrum(double k_times_length)
{
  const double q = 1.339 * k_times_length;
  return std::pow(q, 4) / std::pow(1.0 + q * q, 17.0 / 6.0);
}

// cos(2 pi turns): the sine of a quarter turn less, by its series
SPHCLOTH_INLINE double cosine(double turns)
{
  constexpr double ROUND = 6755399441055744.0;    // 1.5 * 2^52: the sum has no fraction
  const double part = turns - ((turns + ROUND) - ROUND);
  const double angle = 2.0 * PI * (0.25 - std::fabs(part)), sq = angle * angle;
  double sum = -1.0 / 1307674368000.0;
  sum = sum * sq + 1.0 / 6227020800.0;
  sum = sum * sq - 1.0 / 39916800.0;
  sum = sum * sq + 1.0 / 362880.0;
  sum = sum * sq - 1.0 / 5040.0;
  sum = sum * sq + 1.0 / 120.0;
  sum = sum * sq - 1.0 / 6.0;
  return angle + angle * sq * sum;
}

SPHCLOTH_MULTIVERSION void add_mode(const GustField::Mode &m, int n, const double *x,
                                    const double *y, const double *z, double *vx, double *vy,
                                    double *vz)
{
  const double kx = m.wave[0], ky = m.wave[1], kz = m.wave[2], phase = m.phase;
  const double ax = m.velocity[0], ay = m.velocity[1], az = m.velocity[2];
#pragma omp simd
  for (int i = 0; i < n; i++) {
    const double c = cosine(kx * x[i] + ky * y[i] + kz * z[i] + phase);
    vx[i] += ax * c;
    vy[i] += ay * c;
    vz[i] += az * c;
  }
}

}    // namespace

GustField::GustField(double sigma, double length, std::uint64_t seed)
{
  Random random(seed);
  const double ratio = std::pow(HIGHEST / LOWEST, 1.0 / WAVE_NUMBERS);
  std::vector<double> k, energy;
  double sum = 0.0;
  for (int n = 0; n < WAVE_NUMBERS; n++) {
    k.push_back(LOWEST * std::pow(ratio, n + 0.5));
    energy.push_back(spectrum(k.back()) * k.back());    // all ranges are as wide in the logarithm
    sum += energy.back();
  }
  for (int n = 0; n < WAVE_NUMBERS; n++) {
    const Matrix3d axes = random.rotation();
    const double amplitude = sigma * std::sqrt(2.0 * energy[n] / sum);
    for (int d = 0; d < 3; d++)
      modes.push_back({k[n] / (2.0 * PI * length) * axes.col(d), amplitude * axes.col((d + 1) % 3),
                       random.uniform()});
  }
}

void GustField::add(int n, const double *const x[3], double *const v[3]) const
{
  for (const Mode &mode : modes) add_mode(mode, n, x[0], x[1], x[2], v[0], v[1], v[2]);
}
