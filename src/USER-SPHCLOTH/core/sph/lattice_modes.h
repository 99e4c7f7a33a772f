// SPDX-License-Identifier: GPL-2.0-or-later
// The fastest motion of a square or cubic lattice of fluid over what one of its particles sees
// alone.
//
// Sound: small displacements u of a lattice change the density of a particle by
// sum_j m grad W_j . (u_0 - u_j).  In a wave exp(i q x) its square is
//   (m |sum_j grad W_j sin(q r_j)|)^2,   of one particle alone   m^2 sum_j |grad W_j|^2,
// and the largest ratio over all q is the factor between the two.  The gradient of the density
// changes by sum_j m grad grad W_j (u_0 - u_j), in a wave by m sum_j grad grad W_j (1 - cos q r_j):
// its largest eigenvalue times H, over the largest of the density.  Friction between particles is a
// sum of w_j (v_0 - v_j), w_j = |1/r dW/dr|: its factor is the largest sum_j w_j (1 - cos q r_j)
// over sum_j w_j.

#ifndef SPHCLOTH_CORE_SPH_LATTICE_MODES_H
#define SPHCLOTH_CORE_SPH_LATTICE_MODES_H

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

#include "core/sph/kernel.h"
#include "core/sph/lattice_sites.h"

namespace sphcloth {

struct LatticeModes {
  double sound = 1.0, friction = 1.0;
  double bend = 0.0;    // of the gradient over the density
};

template <class Kernel> LatticeModes lattice_modes(double support_over_spacing, int dim)
{
  // a wave of half the length of the support has been resolved long before
  const double support = std::min(support_over_spacing, 8.0);
  constexpr int WAVES = 12;    // from 0 to the shortest wave, in each direction
  struct Neighbor {
    std::array<int, 3> at;
    double slope, bend;
  };
  std::vector<Neighbor> half;    // one of each pair r, -r
  double alone = 0.0, weights = 0.0;
  for_lattice_sites(support, dim, [&](int i, int j, int k, double r_sq, double q) {
    if (!(std::array{i, j, k} > std::array{0, 0, 0})) return;
    const double slope = Kernel::slope_over_q(q);
    half.push_back({{i, j, k}, slope, Kernel::bend_over_q(q) / (support * support)});
    alone += 2.0 * slope * slope * r_sq;
    weights -= 2.0 * slope;
  });
  LatticeModes largest;
  double densest = 0.0, largest_bend = 0.0;
  if (half.empty()) return largest;
  // by symmetry one of the 8 or 48 equal parts of all waves
  for (int a = 0; a <= WAVES; a++)
    for (int b = 0; b <= a; b++)
      for (int c = 0; c <= (dim == 3 ? b : 0); c++) {
        Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
        Eigen::Matrix3d bent = Eigen::Matrix3d::Zero();
        double friction = 0.0;
        for (const Neighbor &n : half) {
          const double phase = PI / WAVES * (a * n.at[0] + b * n.at[1] + c * n.at[2]);
          const Eigen::Vector3d at(n.at[0], n.at[1], n.at[2]);
          gradient += 2.0 * n.slope * std::sin(phase) * at;
          const double apart = 2.0 * (1.0 - std::cos(phase));
          bent.topLeftCorner(dim, dim).diagonal().array() += apart * n.slope;
          bent += apart * n.bend * at * at.transpose();
          friction -= apart * n.slope;
        }
        const double together =
            gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2];
        densest = std::max(densest, std::sqrt(together) / support);
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(bent, Eigen::EigenvaluesOnly);
        largest_bend = std::max(largest_bend, modes.eigenvalues().cwiseAbs().maxCoeff());
        largest.sound = std::max(largest.sound, together / alone);
        largest.friction = std::max(largest.friction, friction / weights);
      }
  if (densest > 0.0) largest.bend = largest_bend / densest;
  return largest;
}

}    // namespace sphcloth

#endif
