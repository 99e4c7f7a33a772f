// SPDX-License-Identifier: GPL-2.0-or-later
// Which stepping scheme a name stands for.

#include "stepping/make_stepper.h"

#include "stepping/block_steps.h"
#include "stepping/individual_steps.h"
#include "stepping/uniform_steps.h"

using namespace LAMMPS_NS;

std::unique_ptr<Stepper> LAMMPS_NS::make_stepper(LAMMPS *lmp, SteppingScheme scheme,
                                                 const SteppingParts &parts,
                                                 const BlockClock &clock)
{
  switch (scheme) {
    case SteppingScheme::CONSTANT: return std::make_unique<UniformSteps>(lmp, parts, true);
    case SteppingScheme::GLOBAL: return std::make_unique<UniformSteps>(lmp, parts, false);
    case SteppingScheme::INDIVIDUAL: return std::make_unique<IndividualSteps>(lmp, parts);
    case SteppingScheme::BLOCK: return std::make_unique<BlockSteps>(lmp, parts, clock);
  }
  return nullptr;
}
