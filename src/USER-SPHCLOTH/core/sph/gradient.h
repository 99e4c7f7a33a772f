// SPDX-License-Identifier: GPL-2.0-or-later
// Gradient of a field f at a particle from the differences to its neighbors, exact for a linear
// field wherever the neighbors are:
//   <grad f>_i = L_i sum_j V_j (f_j - f_i) grad_i W_ij
//   L_i = [sum_j V_j (x_j - x_i) grad_i W_ij]^-1
// Randles & Libersky, Comput. Methods Appl. Mech. Eng. 139 (1996) 375.

#ifndef SPHCLOTH_CORE_SPH_GRADIENT_H
#define SPHCLOTH_CORE_SPH_GRADIENT_H

#include <array>

namespace sphcloth {

// The determinant of the matrix over that of the isotropic one of the same trace is 1 inside the
// fluid, 0.6 in the corner of a square and 0.3 in that of a cube, and 0 if all neighbors lie in
// one plane (on one line).  Below this there is no gradient.
inline constexpr double MIN_SPREAD = 0.1;

struct Differences {
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0;    // inverse of L
  double x = 0.0, y = 0.0, z = 0.0;    // of the field

  std::array<double, 3> gradient(int dimension) const
  {
    // a third direction as good as the other two on average changes neither ratio nor result
    const double third = dimension == 3 ? zz : 0.5 * (xx + yy);
    const double mean = (xx + yy + third) / 3.0;
    const double cxx = yy * third - yz * yz, cxy = xz * yz - xy * third, cxz = xy * yz - yy * xz;
    const double cyy = xx * third - xz * xz, cyz = xy * xz - xx * yz, czz = xx * yy - xy * xy;
    const double det = xx * cxx + xy * cxy + xz * cxz;
    if (!(det > MIN_SPREAD * mean * mean * mean)) return {0.0, 0.0, 0.0};
    return {(cxx * x + cxy * y + cxz * z) / det, (cxy * x + cyy * y + cyz * z) / det,
            (cxz * x + cyz * y + czz * z) / det};
  }
};

}    // namespace sphcloth

#endif
