// SPDX-License-Identifier: GPL-2.0-or-later
// Sums over lattices of the kernel, support and spacing of a type.

#include "fluid/fluid_lattices.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fluid/sph_materials.h"
#include "lammps_util/particle_columns.h"

#include <cmath>
#include <string>

using namespace LAMMPS_NS;
using namespace sphcloth;

static const std::string COEFF = "pair_coeff (sph/tait)";

LatticeSums FluidLattices::sums(int type, double spacing) const
{
  return with_kernel(materials.options.kernel, [&](auto kernel) {
    return lattice_sums<decltype(kernel)>(materials.support(type) / spacing, domain->dimension);
  });
}

double FluidLattices::mass(int type, double spacing) const
{
  const double filled =
      materials.equation_of_state(type).rho0 * std::pow(spacing, domain->dimension);
  return materials.calibrates() ? filled : filled / sums(type, spacing).sum;
}

// Calibrated, the first layer at a wall must have neighbors behind it.

void FluidLattices::check(int type, double spacing) const
{
  constexpr double SMALLEST_CALIBRATED = 1.5, LARGEST = 50.0;
  const double support = materials.support(type);
  const double smallest = materials.calibrates() ? SMALLEST_CALIBRATED : 1.0;
  if (spacing * smallest > support || support > LARGEST * spacing)
    error->all(FLERR,
               "{}: spacing of type {} is '{:.8g}' with a support of {}: give the distance between "
               "neighbors on the lattice, from {:.8g} to {:.8g}",
               COEFF, type, spacing, support, support / LARGEST, support / smallest);
}

// A mass that was set here follows a new kernel, support or spacing; one of the user must agree.

void FluidLattices::set_masses()
{
  constexpr double TOLERANCE = 1e-3;
  for (int type = 1; type <= atom->ntypes; type++) {
    const SPHMaterials::TypeData &of = materials.type(type);
    if (of.spacing == 0.0) continue;
    check(type, of.spacing);
    const double mass_of_one = mass(type, of.spacing);
    if (atom->rmass && materials.calibrates()) continue;
    if (atom->rmass)
      error->all(FLERR,
                 "{}: spacing of type {} is '{}', but every particle has a mass of its own here: "
                 "leave out 'spacing' and use 'set type {} mass {:.16g}'",
                 COEFF, type, of.spacing, type, mass_of_one);
    const bool given = atom->mass_setflag[type] && atom->mass[type] != of.lattice_mass;
    if (given && std::fabs(atom->mass[type] / mass_of_one - 1.0) > TOLERANCE)
      error->all(FLERR,
                 "{}: spacing of type {} is '{}', which makes its mass {:.8g}, but 'mass {}' is "
                 "{:.8g}: leave out 'mass {}' or 'spacing'",
                 COEFF, type, of.spacing, mass_of_one, type, atom->mass[type], type);
    atom->set_mass(FLERR, type, mass_of_one);
    materials.set_lattice_mass(type, mass_of_one);
  }
}

double FluidLattices::spacing(int type) const
{
  const SPHMaterials::TypeData &of = materials.type(type);
  if (of.spacing > 0.0) return of.spacing;
  if (atom->rmass)
    error->all(FLERR,
               "pair_style sph/tait: density is 'calibrated', but type {} has no spacing, and "
               "every particle a mass of its own: add 'spacing DX' to pair_coeff {} {}",
               type, type, type);
  const double spacing = std::pow(atom->mass[type] / of.eos.rho0, 1.0 / domain->dimension);
  check(type, spacing);
  return spacing;
}

void FluidLattices::calibrate()
{
  calibrations.assign(atom->ntypes + 1, Calibration());
  for (int type = 1; type <= atom->ntypes; type++) {
    if (!materials.is_fluid(type) || !materials.calibrates()) continue;
    const LatticeSums lattice = sums(type, spacing(type));
    calibrations[type] = {materials.equation_of_state(type).rho0, lattice.sum, lattice.exponent};
  }
}

double FluidLattices::slope_at_rest() const
{
  for (int type = 1; type <= atom->ntypes; type++)
    if (materials.is_fluid(type)) return slope_of(type, materials.equation_of_state(type).rho0);
  return 1.0;
}

// A density that is integrated is what it is.

bool FluidLattices::adapts_density() const
{
  return materials.calibrates() || (expansion && !materials.integrates_density());
}

double FluidLattices::expanded(int i) const
{
  return expansion && !materials.integrates_density() ? 1.0 + (*expansion)[0][i] : 1.0;
}

double FluidLattices::density(int i, int type, double summed) const
{
  return expanded(i) * (materials.calibrates() ? calibrations[type].density(summed) : summed);
}

double FluidLattices::slope(int i, int type, double rho) const
{
  const double by = expanded(i);
  return by * (materials.calibrates() ? slope_of(type, rho / by) : 1.0);
}

std::vector<WallProfile> FluidLattices::wall_profiles(const WallTable &table,
                                                      double reflection) const
{
  std::vector<WallProfile> of(atom->ntypes + 1);
  for (int type = 1; type <= atom->ntypes; type++) {
    if (!materials.is_fluid(type) || !materials.calibrates()) continue;
    const double dx = spacing(type);
    of[type] = {table, sums(type, dx), materials.support(type) / dx, reflection};
  }
  return of;
}
