// SPDX-License-Identifier: GPL-2.0-or-later
// Keywords of fix sph/integrate.

#ifndef SPHCLOTH_STEPPING_STEP_OPTIONS_H
#define SPHCLOTH_STEPPING_STEP_OPTIONS_H

#include "core/timestep/step_limits.h"
#include "stepping/stepping_scheme.h"

#include <optional>
#include <string>

namespace LAMMPS_NS {

class ArgReader;
class Error;
class OutputTimes;
class SPHMaterials;

// of the scheme block

struct BlockOptions {
  int ratio = 2;         // largest ratio of a particle's step to a neighbor's, 2 or 4
  double gain = 2.0;     // how many times fewer updates unequal steps have to need
  bool waking = true;    // may the step of an inactive particle end early?
  double sleep = 0.0;    // speed below which water sleeps, 0: never

  int max_bin_difference() const { return ratio == 4 ? 2 : 1; }
};

struct StepOptions {
  static constexpr double DEFAULT_MIN = 1e-6;    // of the ceiling: what needs less has failed

  SteppingScheme scheme = SteppingScheme::CONSTANT;    // unless the run style has one
  sphcloth::StepCoefficients lambda;
  double eta = 0.0;    // compression at which the step is held, 0: the step does not depend on it
  double min = 0.0, ceiling = 0.0;    // of the step; 0: min is not given
  double growth = 2.0;    // largest ratio of a step to the one before
  bool ceiling_given = false;
  bool clamp_at_floor = false;    // go on with the floor where a limit is below it
  // of vertices beside fluid; not given: with the schemes global and block
  std::optional<bool> mass_scaling;
  bool overdue = false;    // individual steps: are particles updated when their step has passed?
  BlockOptions block;

  double floor() const { return min > 0.0 ? min : DEFAULT_MIN * ceiling; }

  // the keywords after the scheme, up to the end of the command
  void read(ArgReader &, OutputTimes &);
  // is the mass of vertices beside fluid scaled with this scheme?
  bool scales_mass(SteppingScheme) const;
  // an error, in the name of the fix, where they do not go with the scheme in force
  void check(SteppingScheme, const OutputTimes &, const SPHMaterials &, const std::string &label,
             Error *) const;
};

}    // namespace LAMMPS_NS

#endif
