// SPDX-License-Identifier: GPL-2.0-or-later
// Impulse of the air on each triangle of a cloth in one step, a third of it on each vertex.
//
// A light sheet takes on the velocity of the wind within a small part of a step.  With the velocity
// V of a triangle, its gain D in the step by all else, the force F(V), its slope S = -dF/dV along a
// direction, the mass m and z = dt S/m the impulse is
//   J = dt (phi(z) F - psi(z) S D),
//   phi = (1 + z/2) / (1 + z + z^2/2),  psi = (1 - phi) / z,
// the exponential Rosenbrock-Euler method (Hochbruck & Ostermann, Acta Numerica 19 (2010) 209) with
// the exponential as 1 / (1 + z + z^2/2): second order, and for any step the relative velocity
// falls and keeps its sign.  Where all else balances the force, D = -J/m, J is dt F exactly.
//
// A vertex of k triangles is k vertices with a k-th of its mass, which end the step as one with
// their mean velocity: like each of them it cannot gain energy relative to the air.

#ifndef SPHCLOTH_CORE_AIR_AIR_LOADS_H
#define SPHCLOTH_CORE_AIR_AIR_LOADS_H

#include "core/air/drag_law.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace sphcloth {

// vertices by slot, triangles in rows

struct AirTriangles {
  std::array<std::vector<int>, 3> slot;
  // sum over its vertices of their number of triangles over their mass, over 9; 0 if all are held
  std::vector<double> inverse_mass;
  std::vector<double> open_share;    // of the force that is not kept off by water; empty: 1
  std::vector<double> lee_share;    // of the wind that is kept off by other cloth; empty: 0

  int size() const { return static_cast<int>(slot[0].size()); }
};

struct AirMotion {
  const Eigen::Vector3d *x = nullptr;    // where the vertices are
  const Eigen::Vector3d *v = nullptr;    // velocity minus that of the air
  const Eigen::Vector3d *gain = nullptr;    // of velocity in this step, by all but the air
  const Eigen::Vector3d *wind = nullptr;    // velocity of the air, where there is a lee
};

struct AirDrag {
  double density = 0.0;
  DragCoefficients coefficients;
  DragTable table;    // in place of them, unless empty
};

// adds to the impulses of the vertices, mass times velocity; returns the area that takes air
double add_air_impulses(const AirTriangles &, const AirMotion &, const AirDrag &, double dt,
                        Eigen::Vector3d *impulse);

}    // namespace sphcloth

#endif
