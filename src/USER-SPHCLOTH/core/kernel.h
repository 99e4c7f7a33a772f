// Smoothing kernels W(r, H) with compact support H, of equation (1).
//
// Every kernel is written in q = r/H, so that
//   W(r)           = norm(d) / H^d     * shape(q)
//   (1/r) dW/dr    = norm(d) / H^(d+2) * slope_over_q(q)      (<= 0, finite at q = 0 if C2)
// and grad W = (1/r) dW/dr * r_vec needs no division by r.  Integral of W over d dimensions is 1.
//
// Wendland, Adv. Comput. Math. 4 (1995) 389; Dehnen & Aly, MNRAS 425 (2012) 1068 (normalisation).
// Monaghan & Lattanzio, A&A 149 (1985) 135 (cubic spline).

#ifndef SPHCLOTH_CORE_KERNEL_H
#define SPHCLOTH_CORE_KERNEL_H

#include <cmath>

namespace sphcloth {

inline constexpr double PI = 3.14159265358979323846;

struct WendlandC2 {
  static constexpr const char *NAME = "wendland/c2";
  static constexpr double norm(int dim) { return dim == 3 ? 21.0 / (2.0 * PI) : 7.0 / PI; }
  static constexpr double shape(double q)
  {
    const double u = 1.0 - q;
    return u * u * u * u * (1.0 + 4.0 * q);
  }
  static constexpr double slope_over_q(double q)
  {
    const double u = 1.0 - q;
    return -20.0 * u * u * u;
  }
};

struct CubicSpline {
  static constexpr const char *NAME = "cubic";
  static constexpr double norm(int dim) { return dim == 3 ? 8.0 / PI : 40.0 / (7.0 * PI); }
  static constexpr double shape(double q)
  {
    const double u = 1.0 - q;
    return q < 0.5 ? 6.0 * q * q * (q - 1.0) + 1.0 : 2.0 * u * u * u;
  }
  static constexpr double slope_over_q(double q)
  {
    const double u = 1.0 - q;
    return q < 0.5 ? 18.0 * q - 12.0 : -6.0 * u * u / q;
  }
};

// what the pair loops carry for one pair of types: the support and the two prefactors

struct KernelScale {
  double support_sq = 0.0;     // H^2
  double inv_support = 0.0;    // 1/H
  double w = 0.0;              // norm / H^d
  double f = 0.0;              // norm / H^(d+2)
};

template <class Kernel> KernelScale kernel_scale(double support, int dim)
{
  KernelScale s;
  s.support_sq = support * support;
  s.inv_support = 1.0 / support;
  s.w = Kernel::norm(dim) * std::pow(s.inv_support, dim);
  s.f = s.w * s.inv_support * s.inv_support;
  return s;
}

}    // namespace sphcloth

#endif
