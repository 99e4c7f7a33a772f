// SPDX-License-Identifier: GPL-2.0-or-later
// Density and stress of a square or cubic lattice by summation, and a density that is right there.
//
// A lattice of density rho has a density sum (1) of S rho0 (rho/rho0)^n near rest.  With rho of
//   rho_s = S rho0 (rho/rho0)^n
// in the energy e(rho) of the equation of state its density is rho, and its stress
//   rho^2 de/drho = p.
// The forces are the gradient of that energy: (2) with p/rho^2 drho/drho_s in the place of
// p/rho_s^2.
//
// Where the lattice ends at a plane half a spacing before its first layer, each layer lacks a part
// of its sum, and of its gradient, too.

#ifndef SPHCLOTH_CORE_SPH_CALIBRATION_H
#define SPHCLOTH_CORE_SPH_CALIBRATION_H

#include <cmath>
#include <vector>

#include "core/sph/kernel.h"
#include "core/sph/lattice_sites.h"

namespace sphcloth {

struct LatticeSums {
  // over rho0, and over rho0/spacing, from the first layer on
  struct Missing {
    double sum = 0.0, gradient = 0.0;
  };
  double sum = 1.0, exponent = 1.0;    // S and n
  std::vector<Missing> layers;
};

template <class Kernel> LatticeSums lattice_sums(double support_over_spacing, int dim)
{
  const double support = support_over_spacing;
  const KernelScale scale = kernel_scale<Kernel>(support, dim);
  LatticeSums of;
  of.sum = 0.0;
  of.layers.resize(static_cast<std::size_t>(support));
  double moment = 0.0;    // sum of r dW/dr
  for_lattice_sites(support, dim, [&](int i, int, int, double r_sq, double q) {
    const double w = scale.w * Kernel::shape(q), slope = scale.f * Kernel::slope_over_q(q);
    of.sum += w;
    moment += slope * r_sq;
    for (int layer = 0; layer < -i; layer++) {
      of.layers[layer].sum += w;
      of.layers[layer].gradient += slope * i;
    }
  });
  of.exponent = -moment / (dim * of.sum);
  return of;
}

struct Calibration {
  double rho0 = 0.0, sum = 1.0, exponent = 1.0;

  double density(double summed) const
  {
    return rho0 * std::pow(summed / (sum * rho0), 1.0 / exponent);
  }
  double summed(double rho) const { return sum * rho0 * std::pow(rho / rho0, exponent); }
  // d density / d summed
  double slope(double rho) const { return rho / (exponent * summed(rho)); }
};

}    // namespace sphcloth

#endif
