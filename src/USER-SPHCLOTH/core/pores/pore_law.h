// SPDX-License-Identifier: GPL-2.0-or-later
// Pressure that a permeable sheet takes from the fluid that goes through it.
//
// Of the velocity u of the fluid relative to the sheet, along its normal,
//   p = a u + b |u| u,
// H. Darcy, Les fontaines publiques de la ville de Dijon, Dalmont 1856; P. Forchheimer, Z. Ver.
// Deutsch. Ing. 45 (1901) 1782.
//
// A net is a screen: its drag and lift coefficients as functions of the solidity S, the Reynolds
// number of its twines and the angle t between normal and flow are those of T. Kristiansen &
// O. M. Faltinsen, J. Fluids Struct. 34 (2012) 218, eqs. 3-13,
//   C_D = C_0 (0.9 cos t + 0.1 cos 3t),  C_0 = C S (2 - S) / (2 (1 - S)^2),
//   C_L = C_45 (sin 2t + 0.1 sin 4t),  C_45 = (C_0/2 - pi N / (8 + N)) / sqrt(2),
//   N = C S / (2 (1 - S)^2),
// with C that of a circular cylinder.  They refer to the velocity U far from the net.  Here the
// flow knows of the net, and the velocity in it is u = U / (1 + k/4), where k = 2 p / (rho u^2)
// follows from C_0 = k / (1 + k/4)^2 (G. I. Taylor, Aeronautical Research Council R&M 2236, 1944).

#ifndef SPHCLOTH_CORE_PORES_PORE_LAW_H
#define SPHCLOTH_CORE_PORES_PORE_LAW_H

#include <algorithm>
#include <cmath>

namespace sphcloth {

// pressure over velocity, across the sheet and along it

struct PoreDrag {
  double across = 0.0, along = 0.0;
};

class Screen {
 public:
  // of twines of a diameter; nu: viscosity over density
  Screen() = default;
  Screen(double solidity_, double twine_, double nu_) : solidity(solidity_), twine(twine_), nu(nu_)
  {
  }

  bool empty() const { return solidity == 0.0; }

  // Of a circular cylinder, with this base 10 logarithm of the Reynolds number, 1.5 to 4: a fit to
  // the measurements of S. Goldstein, Modern Developments in Fluid Dynamics, Oxford 1938, section
  // 195, by Kristiansen & Faltinsen
  static double of_cylinder(double log_re)
  {
    static constexpr double FIT[] = {-78.46675, 254.73873, -327.8864, 223.64577,
                                     -87.92234, 20.00769,  -2.44894,  0.12479};
    const double x = std::clamp(log_re, 1.5, 4.0);
    double sum = 0.0;
    for (int k = 7; k >= 0; k--) sum = sum * x + FIT[k];
    return sum;
  }

  // C_0 of the velocity far from the net
  double drag_coefficient(double free_speed) const
  {
    return of_cylinder(log_reynolds(free_speed)) * solidity * (2.0 - solidity) /
        (2.0 * open() * open());
  }

  // k of that coefficient, which must be below 1
  static double loss(double drag_coefficient)
  {
    const double c = std::min(drag_coefficient, MAX_DRAG);
    const double root = 2.0 * (1.0 - std::sqrt(1.0 - c)) / std::sqrt(c);
    return c > 0.0 ? root * root : 0.0;
  }

  // of the parts of the velocity in the net
  PoreDrag drag(double across, double along, double density) const
  {
    constexpr int ROUNDS = 4;    // k depends on U, but little
    const double speed = std::hypot(across, along);
    if (speed == 0.0) return {};
    double slow = 1.0;    // U / u
    for (int n = 0; n < ROUNDS; n++) slow = 1.0 + 0.25 * loss(drag_coefficient(slow * speed));
    const double free = slow * speed, c = of_cylinder(log_reynolds(free));
    const double c_0 = std::min(drag_coefficient(free), MAX_DRAG);
    const double n_45 = 0.5 * c * solidity / (open() * open());
    const double lift_45 = (0.5 * c_0 - PI * n_45 / (8.0 + n_45)) / std::sqrt(2.0);
    const double cosine = std::fabs(across) / speed, sine = std::fabs(along) / speed;
    const double cos_3 = cosine * (4.0 * cosine * cosine - 3.0), sin_2 = 2.0 * sine * cosine;
    const double sin_4 = 2.0 * sin_2 * (cosine * cosine - sine * sine);
    const double drag = c_0 * (0.9 * cosine + 0.1 * cos_3), lift = lift_45 * (sin_2 + 0.1 * sin_4);
    const double normal = drag * cosine + lift * sine, tangential = drag * sine - lift * cosine;
    const double by = 0.5 * density * free * free / speed;
    return {by * std::max(0.0, normal) / std::max(cosine, SMALL),
            by * std::max(0.0, tangential) / std::max(sine, SMALL)};
  }

 private:
  static constexpr double PI = 3.14159265358979323846, MAX_DRAG = 0.99, SMALL = 1e-3;
  double solidity = 0.0, twine = 0.0, nu = 0.0;

  double open() const { return 1.0 - solidity; }
  double log_reynolds(double free_speed) const
  {
    return nu > 0.0 ? std::log10(std::max(1e-30, twine * free_speed / (nu * open()))) : 4.0;
  }
};

struct PoreLaw {
  double darcy = 0.0, forchheimer = 0.0;    // a, b
  Screen screen;    // in addition, unless empty

  PoreDrag drag(double across, double along, double density) const
  {
    PoreDrag sum = screen.empty() ? PoreDrag{} : screen.drag(across, along, density);
    sum.across += darcy;
    return sum;
  }
};

// The pressure acts on the fluid in a layer beside the sheet.  A particle takes a share of it that
// grows and falls linearly through the layer: of particles in rows a whole number of which fit into
// half of the layer, the shares add up to one exactly.  Over the layer's width.

inline double share_in_layer(double distance, double width)
{
  if (distance <= 0.0 || distance >= width) return 0.0;
  return 2.0 * (1.0 - std::fabs(2.0 * distance / width - 1.0)) / width;
}

// Which layer: the one that water comes from, so that it leaves the sheet without pressure.  The
// flow is how far water went through the sheet upward, at most as far as counts, over that: -1 to
// 1.  In between both layers take a part, and water that goes to and fro a little keeps them.

inline double next_flow(double flow, double displacement, double layer_width)
{
  constexpr double COUNTS = 0.125;    // of the width
  return std::clamp(flow + displacement / (COUNTS * layer_width), -1.0, 1.0);
}

// The parts that both layers take of what the law gives them, by how full of water they are, 0 to
// 1: of two full ones that of the flow, and a single one all.

struct PartOfLayers {
  double above, below;
};

inline PartOfLayers part_of_layers(double flow, double full_above, double full_below)
{
  const double above = 1.0 - flow, below = 1.0 + flow;
  const double sum = above * full_above + below * full_below;
  if (!(sum > 0.0)) return {0.0, 0.0};
  const double by = std::max(full_above, full_below) / sum;
  return {std::min(1.0, by * above), std::min(1.0, by * below)};
}

// u of the end of a step: u + linear u + quadratic |u| u = before

inline double slowed(double before, double linear, double quadratic)
{
  const double sum = 1.0 + linear;
  return 2.0 * before / (sum + std::sqrt(sum * sum + 4.0 * quadratic * std::fabs(before)));
}

}    // namespace sphcloth

#endif
