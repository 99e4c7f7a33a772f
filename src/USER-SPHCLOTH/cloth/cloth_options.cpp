// SPDX-License-Identifier: GPL-2.0-or-later
// Reads the arguments of fix pbd/cloth.

#include "cloth/cloth_options.h"

#include "atom.h"
#include "error.h"
#include "group.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"

using namespace LAMMPS_NS;

void ClothOptions::read(ArgReader &args)
{
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "iterations") {
      solving.iterations = args.integer("iterations", 1, 100000);
      iterations_given = true;
    } else if (keyword == "strain") {
      solving.strain = args.positive(keyword);
      strain_given = true;
    } else if (keyword == "solver") {
      solving.solver = static_cast<ClothSolver>(args.choice(keyword, {"gs", "jacobi", "substeps"}));
      solver_given = true;
    } else if (keyword == "order")
      solving.symmetric_sweeps = args.choice(keyword, {"forward", "symmetric"});
    else if (keyword == "direction")
      solving.from_start = args.choice(keyword, {"current", "start"});
    else if (keyword == "tolerance")
      solving.tolerance = args.positive(keyword);
    else if (keyword == "reference")
      reference = args.positive(keyword);
    else if (keyword == "pin")
      read_held(args, keyword, pin_group, pinbit);
    else if (keyword == "velocity")
      pin_motion.read(args);
    else if (keyword == "attach")
      read_held(args, keyword, attach_group, attachbit);
    else if (keyword == "damping")
      solving.damping = args.at_least("damping rate", 0.0);
    else if (keyword == "rest")
      rest_property = args.word("rest property");
    else
      args.unknown(
          keyword,
          "iterations, strain, solver, order, direction, tolerance, reference, pin, velocity, "
          "attach, damping, rest");
  }
  check(args);
}

void ClothOptions::check(ArgReader &args)
{
  if (pin_motion && !pinbit)
    error->all(FLERR, "{}: velocity is that of pins: name their group with 'pin'", owner);
  if (pinbit && attachbit && share_atoms(atom, pinbit, attachbit, world))
    error->all(FLERR, "{}: a vertex is in the group of pin and in that of attach: it can be in one",
               owner);
  if (!solver_given && (attachbit || solving.tolerance > 0.0))
    solving.solver = ClothSolver::GAUSS_SEIDEL;
  if (iterations_given && !strain_given) solving.strain = 0.0;
  if (attachbit && solving.solver == ClothSolver::SUBSTEPS)
    args.fail("solver", "substeps",
              "bodies feel attached cloth once a step: use 'solver gs' or 'solver jacobi'");
  if (strain_given && solving.solver != ClothSolver::SUBSTEPS)
    args.fail("strain", std::to_string(solving.strain),
              "it says how long substeps are: leave it out, or use 'solver substeps'");
  if (solving.symmetric_sweeps && solving.solver == ClothSolver::JACOBI)
    args.fail("order", "symmetric", "the sweeps of 'solver jacobi' have no order: leave it out");
  if (solving.tolerance > 0.0 && solving.solver == ClothSolver::SUBSTEPS)
    args.fail("tolerance", std::to_string(solving.tolerance),
              "substeps have one sweep each: use 'solver gs' or 'solver jacobi'");
}

void ClothOptions::check_groups() const
{
  if (pinbit) refuse_dynamic_group(lmp, owner, "pin", pin_group);
  if (attachbit) refuse_dynamic_group(lmp, owner, "attach", attach_group);
}

// group of the vertices that something else moves

void ClothOptions::read_held(ArgReader &args, const std::string &keyword, int &held, int &bit)
{
  const std::string name = args.word(keyword + " group");
  if (bit)
    args.fail(keyword + " group", name,
              fmt::format("{} is that group already: make one of both with 'group ID union {} {}'",
                          group->names[held], group->names[held], name));
  const int found = group->find(name);
  if (found < 0) args.fail(keyword + " group", name, "define it with the group command first");
  if (!share_atoms(atom, group->bitmask[igroup], group->bitmask[found], world))
    args.fail(
        keyword + " group", name,
        fmt::format("it has no vertex of group {}: choose among the cloth's vertices or leave "
                    "the keyword away",
                    group->names[igroup]));
  held = found;
  bit = group->bitmask[held];
}
