// SPDX-License-Identifier: GPL-2.0-or-later
// Smoothing kernels W(r, H) with compact support H, of equation (1).
//
// Every kernel is written in q = r/H, so that
//   W(r)           = norm(d) / H^d     * shape(q)
//   (1/r) dW/dr    = norm(d) / H^(d+2) * slope_over_q(q)      (<= 0)
//   (1/r) d/dr (1/r dW/dr) = norm(d) / H^(d+4) * bend_over_q(q)
// and grad W = (1/r) dW/dr * r_vec needs no division by r.  Integral of W over d dimensions is 1;
// outside the support, q >= 1, both are 0.
//
// A kernel is added here: its struct, its name in KernelName and its line in with_kernel().
//
// Wendland, Adv. Comput. Math. 4 (1995) 389; Dehnen & Aly, MNRAS 425 (2012) 1068 (normalization).
// Monaghan & Lattanzio, A&A 149 (1985) 135 (cubic spline); Morris, Fox & Zhu, J. Comput. Phys. 136
// (1997) 214 (quintic spline).

#ifndef SPHCLOTH_CORE_SPH_KERNEL_H
#define SPHCLOTH_CORE_SPH_KERNEL_H

#include <algorithm>
#include <cmath>
#include <string>

namespace sphcloth {

inline constexpr double PI = 3.14159265358979323846;

// bend_over_q() grows as 1/q with some kernels; it is multiplied by q^2
template <class Real> inline constexpr Real NEAREST = Real(1e-6);

struct WendlandC2 {
  static constexpr const char *NAME = "wendland/c2";
  static constexpr double norm(int dim) { return dim == 3 ? 21.0 / (2.0 * PI) : 7.0 / PI; }
  template <class Real> static Real shape(Real q)
  {
    const Real u = std::max(Real(1) - q, Real(0)), u2 = u * u;
    return u2 * u2 * (Real(1) + Real(4) * q);
  }
  template <class Real> static Real slope_over_q(Real q)
  {
    const Real u = std::max(Real(1) - q, Real(0));
    return Real(-20) * u * u * u;
  }
  template <class Real> static Real bend_over_q(Real q)
  {
    const Real u = std::max(Real(1) - q, Real(0));
    return Real(60) * u * u / std::max(q, NEAREST<Real>);
  }
};

struct WendlandC4 {
  static constexpr const char *NAME = "wendland/c4";
  static constexpr double norm(int dim) { return dim == 3 ? 495.0 / (32.0 * PI) : 9.0 / PI; }
  template <class Real> static Real shape(Real q)
  {
    const Real u = std::max(Real(1) - q, Real(0)), u2 = u * u;
    return u2 * u2 * u2 * (Real(1) + q * (Real(6) + Real(35.0 / 3.0) * q));
  }
  template <class Real> static Real slope_over_q(Real q)
  {
    const Real u = std::max(Real(1) - q, Real(0)), u2 = u * u;
    return Real(-56.0 / 3.0) * u2 * u2 * u * (Real(1) + Real(5) * q);
  }
  template <class Real> static Real bend_over_q(Real q)
  {
    const Real u = std::max(Real(1) - q, Real(0)), u2 = u * u;
    return Real(560) * u2 * u2;
  }
};

struct CubicSpline {
  static constexpr const char *NAME = "cubic";
  static constexpr double norm(int dim) { return dim == 3 ? 8.0 / PI : 40.0 / (7.0 * PI); }
  template <class Real> static Real shape(Real q)
  {
    const Real u = std::max(Real(1) - q, Real(0));
    return q < Real(0.5) ? Real(6) * q * q * (q - Real(1)) + Real(1) : Real(2) * u * u * u;
  }
  template <class Real> static Real slope_over_q(Real q)
  {
    const Real u = std::max(Real(1) - q, Real(0));
    return q < Real(0.5) ? Real(18) * q - Real(12) : Real(-6) * u * u / q;
  }
  template <class Real> static Real bend_over_q(Real q)
  {
    const Real u = std::max(Real(1) - q, Real(0));
    const Real outer = std::max(q, Real(0.5));
    return q < Real(0.5) ? Real(18) / std::max(q, NEAREST<Real>)
                         : Real(6) * u * (Real(1) + q) / (outer * outer * outer);
  }
};

// (1-q)^5 - 6 (2/3-q)^5 + 15 (1/3-q)^5, each term only where its bracket is positive

struct QuinticSpline {
  static constexpr const char *NAME = "quintic";
  static constexpr double norm(int dim)
  {
    return dim == 3 ? 2187.0 / (40.0 * PI) : 15309.0 / (478.0 * PI);
  }
  template <class Real> static Real shape(Real q)
  {
    return power5(Real(1) - q) - Real(6) * power5(Real(2.0 / 3.0) - q) +
        Real(15) * power5(Real(1.0 / 3.0) - q);
  }
  template <class Real> static Real slope_over_q(Real q)
  {
    const Real u = std::max(Real(1) - q, Real(0)), b = std::max(Real(2.0 / 3.0) - q, Real(0));
    // the three terms expanded: their constants cancel, and with them the division by q = 0
    const Real inner = Real(-5) * (q * q * (Real(10) * q - Real(8)) + Real(8.0 / 9.0));
    const Real outer =
        Real(-5) * (u * u * u * u - Real(6) * b * b * b * b) / std::max(q, Real(1.0 / 3.0));
    return q < Real(1.0 / 3.0) ? inner : outer;
  }
  template <class Real> static Real bend_over_q(Real q)
  {
    const Real u = std::max(Real(1) - q, Real(0)), b = std::max(Real(2.0 / 3.0) - q, Real(0));
    const Real clamped = std::max(q, Real(1.0 / 3.0)), u3 = u * u * u, b3 = b * b * b;
    const Real inner = Real(80) - Real(150) * q;
    const Real outer =
        Real(5) * (Real(4) * (u3 - Real(6) * b3) * clamped + u3 * u - Real(6) * b3 * b) /
        (clamped * clamped * clamped);
    return q < Real(1.0 / 3.0) ? inner : outer;
  }

 private:
  template <class Real> static Real power5(Real bracket)
  {
    const Real u = std::max(bracket, Real(0)), u2 = u * u;
    return u2 * u2 * u;
  }
};

enum class KernelName : int { WENDLAND_C2, WENDLAND_C4, CUBIC, QUINTIC };

inline constexpr KernelName ALL_KERNELS[] = {KernelName::WENDLAND_C2, KernelName::WENDLAND_C4,
                                             KernelName::CUBIC, KernelName::QUINTIC};

// calls f(Kernel()) with the struct that the name stands for

template <class F> decltype(auto) with_kernel(KernelName name, F &&f)
{
  switch (name) {
    case KernelName::WENDLAND_C4: return f(WendlandC4());
    case KernelName::CUBIC: return f(CubicSpline());
    case KernelName::QUINTIC: return f(QuinticSpline());
    case KernelName::WENDLAND_C2: break;
  }
  return f(WendlandC2());
}

inline std::string kernel_word(KernelName name)
{
  return with_kernel(name, [](auto kernel) { return std::string(decltype(kernel)::NAME); });
}

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
