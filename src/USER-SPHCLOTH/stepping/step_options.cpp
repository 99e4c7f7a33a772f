// SPDX-License-Identifier: GPL-2.0-or-later
// Keywords of fix sph/integrate.

#include "stepping/step_options.h"

#include "error.h"
#include "fluid/sph_materials.h"
#include "lammps_util/arg_reader.h"
#include "stepping/output_times.h"

#include <optional>

using namespace LAMMPS_NS;
using namespace sphcloth;

// Limits of sound and viscosity take the place of the limit of stability where any is given; steps
// have a margin then that they have nowhere else.

static void choose_stability(ArgReader &args, std::optional<double> stability,
                             std::optional<double> acoustic, std::optional<double> viscous,
                             std::optional<double> velocity, std::optional<double> force,
                             StepCoefficients &lambda)
{
  lambda.velocity = velocity.value_or(lambda.velocity);
  lambda.force = force.value_or(lambda.force);
  if (!acoustic && !viscous && !lambda.wetted) {
    lambda.stability = stability.value_or(lambda.stability);
    return;
  }
  if (stability.value_or(0.0) > 0.0)
    args.fail("stability", fmt::format("{}", *stability),
              "it takes the place of acoustic, viscous and wetted: leave these out");
  lambda.stability = 0.0;
  lambda.velocity = velocity.value_or(StepCoefficients::VELOCITY);
  lambda.force = force.value_or(StepCoefficients::FORCE);
  lambda.acoustic = acoustic.value_or(StepCoefficients::ACOUSTIC);
  lambda.viscous = viscous.value_or(StepCoefficients::VISCOUS);
}

void StepOptions::read(ArgReader &args, OutputTimes &times)
{
  std::optional<double> accuracy, stability, acoustic, viscous, velocity, force, density;
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "accuracy") {
      accuracy = args.positive(keyword);
      if (*accuracy > 1.0)
        args.fail(keyword, fmt::format("{}", *accuracy), "give a share up to 1, as 0.01");
    } else if (keyword == "velocity")
      velocity = args.at_least(keyword, 0.0);
    else if (keyword == "force")
      force = args.at_least(keyword, 0.0);
    else if (keyword == "stability")
      stability = args.fraction(keyword);
    else if (keyword == "acoustic")
      acoustic = args.at_least(keyword, 0.0);
    else if (keyword == "wetted")
      lambda.wetted = args.at_least(keyword, 0.0);
    else if (keyword == "viscous")
      viscous = args.at_least(keyword, 0.0);
    else if (keyword == "density")
      density = args.at_least(keyword, 0.0);
    else if (keyword == "relative")
      lambda.relative = args.at_least(keyword, 0.0);
    else if (keyword == "cloth")
      lambda.cloth = args.at_least(keyword, 0.0);
    else if (keyword == "fluctuation")
      eta = args.at_least(keyword, 0.0);
    else if (keyword == "output")
      times.interval = args.at_least(keyword, 0.0);
    else if (keyword == "until")
      times.until = args.positive(keyword);
    else if (keyword == "ratio") {
      block.ratio = args.integer(keyword, 2, 4);
      if (block.ratio == 3) args.fail(keyword, "3", "steps differ by 2 or 4");
    } else if (keyword == "gain")
      block.gain = args.at_least(keyword, 1.0);
    else if (keyword == "waking")
      block.waking = args.choice(keyword, {"no", "yes"});
    else if (keyword == "mass_scaling")
      mass_scaling = args.choice(keyword, {"no", "yes"});
    else if (keyword == "overdue")
      overdue = args.choice(keyword, {"no", "yes"});
    else if (keyword == "sleep")
      block.sleep = args.at_least(keyword, 0.0);
    else if (keyword == "min")
      min = args.positive(keyword);
    else if (keyword == "max") {
      ceiling = args.positive(keyword);
      ceiling_given = true;
    } else if (keyword == "growth") {
      growth = args.number(keyword);
      if (growth <= 1.0 || growth > 2.0)
        args.fail(keyword, std::to_string(growth), "give a factor above 1, at most 2");
    } else if (keyword == "below")
      clamp_at_floor = args.choice(keyword, {"stop", "clamp"}) == 1;
    else
      args.unknown(
          keyword,
          "accuracy, velocity, force, stability, acoustic, wetted, viscous, density, relative, "
          "cloth, fluctuation, output, until, ratio, gain, waking, sleep, overdue, mass_scaling, "
          "min, max, growth, below");
  }
  if (accuracy) {
    if (velocity || force || density || stability || acoustic || viscous || lambda.wetted)
      args.fail("accuracy", fmt::format("{}", *accuracy),
                "it takes the place of velocity, force, density, stability, acoustic, viscous and "
                "wetted: leave these out");
    lambda.set_accuracy(*accuracy);
    return;
  }
  lambda.density = density.value_or(lambda.density);
  choose_stability(args, stability, acoustic, viscous, velocity, force, lambda);
}

bool StepOptions::scales_mass(SteppingScheme scheme_in_force) const
{
  const bool adaptive = scheme_in_force == SteppingScheme::GLOBAL ||
      scheme_in_force == SteppingScheme::BLOCK;
  return mass_scaling.value_or(adaptive && lambda.stability > 0.0);
}

void StepOptions::check(SteppingScheme scheme_in_force, const OutputTimes &times,
                        const SPHMaterials &fluid, const std::string &label, Error *error) const
{
  if (times.interval > 0.0 && scheme_in_force == SteppingScheme::CONSTANT)
    error->all(FLERR,
               "{}: output {} would shorten steps that are constant: use the scheme global, or a "
               "timestep that divides {}",
               label, times.interval, times.interval);
  const bool individual = scheme_in_force == SteppingScheme::INDIVIDUAL;
  const bool unequal = individual || scheme_in_force == SteppingScheme::BLOCK;
  if (mass_scaling.value_or(false) && (individual || lambda.stability == 0.0))
    error->all(FLERR,
               "{}: mass_scaling yes is for steps that follow from stability, and not for "
               "individual: leave it out, or use the scheme constant, global or block without "
               "acoustic, viscous and wetted",
               label);
  if (!unequal) return;
  if (fluid.sound_follows() && (individual || block.sleep > 0.0))
    error->all(FLERR,
               "{}: a speed of sound that follows the flow changes where all particles are updated "
               "together, with {} they never are: use another scheme, or a constant 'c0 C'",
               label, individual ? "individual" : "sleep");
  if (fluid.completes_surfaces())
    error->all(FLERR,
               "{}: surface of pair_style sph/tait is 'yes', which turns forces off the lines of "
               "two particles and needs steps of one length: use the scheme constant or global, or "
               "'surface no'",
               label);
  if (fluid.switches_viscosity() && individual)
    error->all(FLERR,
               "{}: individual steps leave some of the partners of a particle without a share in "
               "the artificial viscosity: leave 'switch' of pair_coeff out, or use another scheme "
               "than individual",
               label);
  if (fluid.integrates_density() && individual)
    error->all(
        FLERR,
        "{}: individual steps need densities by summation, 'density continuity' integrates them: "
        "use 'density summation', or another scheme than individual",
        label);
}
