// SPDX-License-Identifier: GPL-2.0-or-later
// Fixes and pair styles of LAMMPS that contradict the stepping scheme in force.

#include "stepping/styles_beside.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_deform.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "modify.h"

using namespace LAMMPS_NS;

static void check_steps(LAMMPS *lmp, const std::string &label)
{
  for (const Fix *fix : lmp->modify->get_fix_list())
    if (utils::strmatch(fix->style, "^dt/reset"))
      lmp->error->all(FLERR,
                      "{}: fix {} {} would change the steps, which this fix sets: remove it with "
                      "'unfix {}', and use the scheme global, whose longest step is 'max'",
                      label, fix->id, fix->style, fix->id);
}

// Impulses of unequal steps are found while LAMMPS still adds up the forces of other pair styles.

static void check_pair_style(LAMMPS *lmp, const std::string &label, SteppingScheme scheme,
                             const FluidState &fluid)
{
  if (scheme == SteppingScheme::BLOCK && !fluid.is_of(lmp->force->pair))
    lmp->error->all(FLERR,
                    "{}: with run_style sph/adaptive block pair_style {} would give other forces "
                    "in another order of its styles: use sph/tait alone, or another scheme",
                    label, lmp->force->pair_style);
}

static bool remaps_positions(const Fix *fix)
{
  if (!(fix->box_change & (Fix::BOX_CHANGE_ANY | Fix::BOX_CHANGE_SIZE))) return false;
  if (utils::strmatch(fix->style, "^append/atoms") || utils::strmatch(fix->style, "^box/relax"))
    return false;
  const auto *deform = dynamic_cast<const FixDeform *>(fix);
  return !deform || deform->remapflag == Domain::X_REMAP;
}

// Rates of density follow velocities; with block steps densities follow positions.

static void check_density(LAMMPS *lmp, const std::string &label)
{
  for (const Fix *fix : lmp->modify->get_fix_list())
    if (remaps_positions(fix))
      lmp->error->all(
          FLERR,
          "{}: fix {} {} moves particles with the box, without velocities, and 'density "
          "continuity' follows velocities: use 'density summation' or 'density "
          "calibrated', or 'run_style sph/adaptive block'{}",
          label, fix->id, fix->style,
          utils::strmatch(fix->style, "^deform") ? ", or 'remap v'" : "");
}

static void warn_of_rates(LAMMPS *lmp, const std::string &label)
{
  if (lmp->comm->me) return;
  for (const Fix *fix : lmp->modify->get_fix_by_style("^deform"))
    lmp->error->warning(FLERR,
                        "{}: fix {} {} takes all steps for as long as the first one, and steps "
                        "vary, so rates are wrong but by its style 'variable', from the time",
                        label, fix->id, fix->style);
}

void LAMMPS_NS::check_styles_beside(LAMMPS *lmp, const std::string &label, SteppingScheme scheme,
                                    const FluidState &fluid)
{
  check_steps(lmp, label);
  check_pair_style(lmp, label, scheme, fluid);
  if (fluid.integrates_density() && scheme != SteppingScheme::BLOCK) check_density(lmp, label);
  if (scheme != SteppingScheme::CONSTANT) warn_of_rates(lmp, label);
}
