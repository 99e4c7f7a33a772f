// SPDX-License-Identifier: GPL-2.0-or-later
// Reads the arguments of fix cloth/pores.

#include "pores/pore_options.h"

#include "atom.h"
#include "error.h"
#include "force.h"
#include "lammps_util/arg_reader.h"

#include <cmath>

using namespace LAMMPS_NS;

// above it the model of a screen has a drag coefficient of more than 1 at some Reynolds number
static constexpr double MAX_SOLIDITY = 0.4;

void PoreOptions::read(ArgReader &args)
{
  const auto [first, last] = args.range("angle type of porous triangles", atom->nangletypes);
  first_type = first;
  last_type = last;
  bool any = false;
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    any = true;
    if (keyword == "darcy")
      darcy = args.at_least(keyword, 0.0);
    else if (keyword == "forchheimer")
      forchheimer = args.at_least(keyword, 0.0);
    else if (keyword == "medium") {
      permeability = args.positive("permeability of 'medium'");
      thickness = args.positive("thickness of 'medium'");
      inertia = args.at_least("inertial coefficient of 'medium'", 0.0);
    } else if (keyword == "screen") {
      solidity = args.positive("solidity of 'screen'");
      if (solidity > MAX_SOLIDITY)
        args.fail("solidity of 'screen'", fmt::format("{:g}", solidity),
                  fmt::format("the model of nets holds up to {}: give 'medium', or 'darcy' and "
                              "'forchheimer'",
                              MAX_SOLIDITY));
      twine = args.positive("twine diameter of 'screen'");
    } else
      args.unknown(keyword, "darcy, forchheimer, medium, screen");
  }
  if (!any)
    error->all(FLERR,
               "{}: the resistance is missing: give 'darcy', 'forchheimer', 'medium' or 'screen'; "
               "'darcy 0' lets all through",
               owner);
}

// J. C. Ward, J. Hydraul. Div. ASCE 90 (1964) 1: dp/dx = mu/K u + C rho/sqrt(K) u^2

PoreFluid PoreOptions::of(const FluidState *fluid, int groupbit) const
{
  PoreFluid found{fluid, std::vector<sphcloth::PoreLaw>(atom->ntypes + 1), groupbit, first_type,
                  last_type};
  for (int t = 1; t <= atom->ntypes; t++) {
    if (!fluid->is_fluid(t)) continue;
    const double rho0 = found.density(t), nu = fluid->type(t).nu;
    sphcloth::PoreLaw &law = found.laws[t];
    law.darcy = darcy * force->ftm2v / force->nktv2p;
    law.forchheimer = forchheimer;
    if (permeability > 0.0) {
      if (nu <= 0.0 && inertia == 0.0)
        error->all(FLERR,
                   "{}: 'medium' takes the viscosity of the fluid, and type {} has none: give it "
                   "'nu' in pair_coeff, or give 'darcy' here",
                   owner, t);
      law.darcy += rho0 * nu * thickness / permeability;
      law.forchheimer += inertia * rho0 * thickness / std::sqrt(permeability);
    }
    if (solidity > 0.0) law.screen = sphcloth::Screen(solidity, twine, nu);
  }
  return found;
}

std::string PoreOptions::types() const
{
  return first_type == last_type ? std::to_string(first_type)
                                 : fmt::format("{}*{}", first_type, last_type);
}
