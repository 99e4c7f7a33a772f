// SPDX-License-Identifier: GPL-2.0-or-later
// The Tait equation of state, equation (3): p = k rho0/gamma ((rho/rho0)^gamma - 1).
//
// k is the square of the sound speed at rest: dp/drho = k (rho/rho0)^(gamma-1).

#ifndef SPHCLOTH_CORE_SPH_TAIT_H
#define SPHCLOTH_CORE_SPH_TAIT_H

#include <cmath>

namespace sphcloth {

struct Tait {
  double rho0 = 0.0;     // rest density
  double k = 0.0;        // stiffness = c0^2
  double gamma = 7.0;    // exponent

  double sound_speed() const { return std::sqrt(k); }

  double pressure(double rho) const
  {
    if (gamma == 7.0) {    // water: (1 + e)^7 - 1 expanded
      const double e = (rho - rho0) / rho0;
      return k * rho0 *
          (e * (1.0 + e * (3.0 + e * (5.0 + e * (5.0 + e * (3.0 + e * (1.0 + e / 7.0)))))));
    }
    const double ratio = rho / rho0;
    // gamma ln(ratio) keeps the digits of a small fluctuation that pow() - 1 would lose
    return k * rho0 / gamma * std::expm1(gamma * std::log(ratio));
  }

  // internal energy per mass, the integral of p/rho^2 from rho0 (gamma > 1)
  double energy(double rho) const
  {
    const double ratio = rho / rho0;
    return k / gamma *
        (std::pow(ratio, gamma - 1.0) / (gamma - 1.0) + 1.0 / ratio - gamma / (gamma - 1.0));
  }

  double sound_speed(double rho) const { return sound_speed() * stiffening(rho); }

  // sound speed over that at rest
  double stiffening(double rho) const
  {
    const double ratio = rho / rho0;
    // water's exponent needs no pow()
    return gamma == 7.0 ? ratio * ratio * ratio : std::pow(ratio, 0.5 * (gamma - 1.0));
  }

  // A relative fluctuation eta needs c0 = v_ref / sqrt(eta), v_ref the larger of the expected
  // speed and sqrt(g H).  Monaghan, J. Comput. Phys. 110 (1994) 399.
  static double stiffness_from_fluctuation(double eta, double v_ref) { return v_ref * v_ref / eta; }
};

}    // namespace sphcloth

#endif
