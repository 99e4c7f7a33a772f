// SPDX-License-Identifier: GPL-2.0-or-later
// How soft a solver is that goes once through the constraints in each substep.
//
// What a sweep leaves of the error of a constraint is as if it had a compliance of about W h^2, h
// the substep, W = sum_j w_j |grad_j C|^2 (Macklin et al., SCA 2019).  A softness that followed the
// substep would feed the motion: what is stretched would give back more than it took.  So the
// solver adds a compliance such that each constraint is a spring with a potential, whatever the
// substeps are: as soft as in the longest substep L while it is unloaded, and ever harder as the
// error x that the solver adds comes to the allowed one,
//   W L^2 g(x),  g = 1/(1 + 9 (x/allowed)^4)^2,  but no less than a tenth of its own compliance.
// The present substep h must be short enough for the hardest: h^2 <= L^2 g.

#ifndef SPHCLOTH_CORE_PBD_SOLVER_SOFTNESS_H
#define SPHCLOTH_CORE_PBD_SOLVER_SOFTNESS_H

#include <algorithm>
#include <cmath>

#include "core/util/simd.h"

namespace sphcloth {

// What one sweep leaves of constraints in a row that take all of their error is as if they had this
// share of W h^2 as compliance: the next one in the sweep stretches every second one by all of it.
inline constexpr double SINGLE_SWEEP_SOFTNESS = 0.5;

// A load that is 100 times that of the unloaded softness brings a constraint to the allowed error,
// and one of 1000 times to 1.3 of it.  From 1.6 on it hardens no further.
inline constexpr double HARDENING = 9.0, MAX_OF_ALLOWED = 1.6,
                        MAX_HARDENING = HARDENING * (MAX_OF_ALLOWED * MAX_OF_ALLOWED) *
    (MAX_OF_ALLOWED * MAX_OF_ALLOWED);

// of the own compliance of a constraint; of one without a size, times the strain that is asked for
inline constexpr double SHARE_OF_COMPLIANCE = 0.1, SHARE_WITHOUT_SIZE = 0.4;

struct SolverSoftness {
  double softness;    // W L^2 g/h^2, at least W
  double steeper;    // -d(log g)/d(log x), where the load sets g
};

// 1/sqrt(g) - 1, of an error over the allowed one

SPHCLOTH_INLINE double hardening(double y) { return HARDENING * (y * y) * (y * y); }

// g of a strain over the allowed one, and the strain with this g

inline double hardness_of(double y)
{
  const double root = 1.0 / (1.0 + std::min(hardening(y), MAX_HARDENING));
  return root * root;
}

inline double strain_with(double hardness)
{
  return std::pow(std::max(0.0, 1.0 / std::sqrt(hardness) - 1.0) / HARDENING, 0.25);
}

// x: error; w: W; material: compliance/h^2; longest_sq: L^2/h^2; per_allowed: 1/allowed, relative
// to the size, 0: no load hardens it; without_size: what it adds to a constraint without a size,
// over its compliance; softest: of a rigid constraint over W L^2

SPHCLOTH_INLINE SolverSoftness solver_softness(double x, double w, double material, double per_size,
                                               double longest_sq, double per_allowed,
                                               double without_size, double softest)
{
  constexpr double TINY = 1e-300;    // where nothing can move
  const double longest = w * longest_sq, rigid = softest * longest;
  SolverSoftness s;
  const double error = x * per_size * (rigid / (rigid + material + TINY));
  const double harder = hardening(error * per_allowed);
  const double root = 1.0 / (1.0 + std::min(harder, MAX_HARDENING));
  const bool hardens = per_allowed > 0.0, has_size = per_size > 0.0;
  const double share = (has_size ? SHARE_OF_COMPLIANCE : without_size) / SINGLE_SWEEP_SOFTNESS;
  const double by_load = hardens ? (has_size ? longest * root * root : 0.0) : longest;
  const double floor = std::min(longest, share * material);
  s.softness = std::max(w, std::max(by_load, floor));
  const bool by_law = harder < MAX_HARDENING && by_load > std::max(w, floor);
  s.steeper = by_law ? 8.0 * (1.0 - root) : 0.0;
  return s;
}

// The strain y that a constraint comes to in a substep, which would bring it to `size` if nothing
// pulled it back: y + kappa y (1 + 9 y^4)^2 = size, kappa = W over its unloaded softness.  A pull
// by the strain at the start of the substep would be that of a soft constraint while a slack one
// snaps taut, and of a hard one on the way back: energy from nothing, and a light sheet that never
// comes to rest.  By Newton's method from above, to some percent: the projection is another step.

SPHCLOTH_INLINE double hardened_strain(double size, double kappa)
{
  constexpr double PER_NINTH_POWER = 1.0 / (HARDENING * HARDENING);
  // v^(1/9) from z = v^(1/8), or a little more
  const double z = std::sqrt(std::sqrt(std::sqrt(PER_NINTH_POWER * size / kappa)));
  double y = std::min(size / (1.0 + kappa), (8.0 * z + 1.0) / 9.0);
  for (int n = 0; n < 2; n++) {
    const double q = hardening(y), pull = kappa * (1.0 + q);
    y -= (y + y * pull * (1.0 + q) - size) / (1.0 + pull * (1.0 + 9.0 * q));
  }
  return y;
}

// What the solver adds to the errors of constraints that have a size

struct SolverError {
  double hardest = 1.0;    // the least softness, over that in the longest substep
  double largest = 0.0;    // relative to the size of the constraint

  void join(const SolverError &other)
  {
    hardest = std::min(hardest, other.hardest);
    largest = std::max(largest, other.largest);
  }
};

// The same from the load of a constraint, whatever the substep was that found it.  inv_dt_sq: 1/h^2
// of that; longest_sq: L^2; allowed: 0: no load hardens it; softest: of a rigid constraint over
// W L^2.

struct LoadedSolver {
  double inv_dt_sq, longest_sq, allowed, softest;

  SolverError of(double load, double w, double compliance, double per_size) const
  {
    if (allowed == 0.0) return {1.0, unloaded_error(load, w, per_size)};
    constexpr double SHARE = SHARE_OF_COMPLIANCE / SINGLE_SWEEP_SOFTNESS;
    const double y = strain_of(unloaded_error(load, w, per_size) / allowed);
    const double floor = SHARE * compliance / (w * longest_sq);
    return {std::min(1.0, std::max(hardness_of(y), floor)), y * allowed};
  }

  // the error that the unloaded softness would leave
  double unloaded_error(double load, double w, double per_size) const
  {
    return softest * w * longest_sq * load * per_size;
  }

  // a constraint with no more unloaded error than this changes nothing in what was found
  double without_news(const SolverError &found) const
  {
    constexpr double ROOM = 0.99;    // strain_of() is not exact
    if (allowed == 0.0) return found.largest;
    const double y = std::min(found.largest / allowed, strain_with(found.hardest));
    return ROOM * allowed * y * (1.0 + hardening(y)) * (1.0 + hardening(y));
  }

 private:
  // y with y (1 + 9 y^4)^2 = unloaded, the strain of the unloaded softness
  static double strain_of(double unloaded)
  {
    const double end = MAX_OF_ALLOWED * (1.0 + MAX_HARDENING) * (1.0 + MAX_HARDENING);
    if (unloaded > end) return unloaded / end * MAX_OF_ALLOWED;
    double y = std::min(unloaded, MAX_OF_ALLOWED);
    for (int n = 0; n < 30; n++) {    // by Newton's method, from above
      const double q = hardening(y), off = y * (1.0 + q) * (1.0 + q) - unloaded;
      const double by = off / ((1.0 + q) * (1.0 + 9.0 * q));
      y -= by;
      if (by < 1e-3 * y) break;
    }
    return y;
  }
};

}    // namespace sphcloth

#endif
