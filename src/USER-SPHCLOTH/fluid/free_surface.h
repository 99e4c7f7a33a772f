// SPDX-License-Identifier: GPL-2.0-or-later
// Density sums that are completed at free surfaces, 'pair_style sph/tait ... surface yes': see
// core/sph/surface.h.

#ifndef SPHCLOTH_FLUID_FREE_SURFACE_H
#define SPHCLOTH_FLUID_FREE_SURFACE_H

#include "pointers.h"

#include "core/sph/fluid.h"
#include "core/sph/surface.h"
#include "core/util/bytes.h"

#include <functional>
#include <optional>
#include <vector>

namespace LAMMPS_NS {

class FluidBoundary;
class SPHMaterials;

class FreeSurface : protected Pointers {
 public:
  FreeSurface(class LAMMPS *lmp_, const SPHMaterials &materials_) :
      Pointers(lmp_), materials(materials_)
  {
  }

  void begin_run();
  bool on() const { return table.has_value(); }
  void begin_lists();
  // Of the active particles, from sums to densities.  Where stability is to be found, bend: of the
  // lattice of a type and a mass, see LatticeModes; else empty.
  using Bend = std::function<double(int, double)>;
  void complete(sphcloth::Fluid &, const sphcloth::Particles &,
                const std::vector<FluidBoundary *> &, const Bend &bend_of_lattice);
  // by turns, of particles and boundaries
  void push(sphcloth::Fluid &, const sphcloth::Particles &, const std::vector<FluidBoundary *> &);
  // Of an owned particle, once its p/rho^2 is known: what acts along the line of two particles;
  // the rest is its turn.
  double along(int i) const { return alongs.empty() ? 1.0 : alongs[i]; }
  // Of an owned particle, its density over the sum; the rates of the two have the same ratio where
  // the distance to the surface stays
  double factor(int i) const { return factors.empty() ? 1.0 : factors[i]; }
  void set_pressure(int i, double p_over_rho2);
  // Of all: by how much more the density changes with positions than the sum does, at most
  double stiffening(int i) const { return stiffenings.empty() ? 1.0 : stiffenings[i]; }
  // of all
  const double *turns() const { return turn.data(); }

  double *pack(int i, double *buf) const;
  const double *unpack(int i, const double *buf);
  double bytes() const { return sphcloth::bytes_of(factors, alongs, stiffenings, turn); }

 private:
  const SPHMaterials &materials;
  std::optional<sphcloth::SurfaceTable> table;
  double bend = 0.0;    // of the kernel, see bend_over_slope()
  std::vector<double> factors;    // h
  std::vector<double> alongs;    // h - x h'
  std::vector<double> stiffenings;
  std::vector<double> turn;    // [n][3], h' H n, then T
};

}    // namespace LAMMPS_NS

#endif
