// SPDX-License-Identifier: GPL-2.0-or-later
// Reads the arguments of fix cloth/contact.

#include "contact/contact_options.h"

#include "error.h"
#include "group.h"
#include "lammps_util/arg_reader.h"

using namespace LAMMPS_NS;

static constexpr double NOT_GIVEN = -1.0;

void ContactOptions::read(ArgReader &args)
{
  rules.thickness = args.positive("thickness");
  cloth_rules.thickness = cloth_rules.friction = NOT_GIVEN;
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "friction")
      rules.friction = args.at_least("friction coefficient", 0.0);
    else if (keyword == "restitution")
      rules.restitution = args.fraction("restitution");
    else if (keyword == "obstacle")
      read_obstacle(args);
    else if (keyword == "sides")
      rules.sides = args.choice(keyword, {"no", "yes"});
    else if (keyword == "wall")
      walls = args.choice(keyword, {"no", "yes"});
    else if (!read_of_cloth(args, keyword))
      args.unknown(keyword,
                   "friction, restitution, sides, wall, obstacle, cloth, cloth/thickness, "
                   "cloth/friction, untangle");
  }
  complete_rules();
}

bool ContactOptions::read_of_cloth(ArgReader &args, const std::string &keyword)
{
  if (keyword == "cloth")
    cloth_meets_cloth = args.choice(keyword, {"no", "yes"});
  else if (keyword == "cloth/thickness")
    cloth_rules.thickness = args.positive(keyword);
  else if (keyword == "cloth/friction")
    cloth_rules.friction = args.at_least(keyword, 0.0);
  else if (keyword == "untangle")
    untangle = args.choice(keyword, {"no", "yes"});
  else
    return false;
  return true;
}

void ContactOptions::read_obstacle(ArgReader &args)
{
  const std::string name = args.word("obstacle group");
  const int found = group->find(name);
  if (found < 0) args.fail("obstacle group", name, "define it with the group command first");
  if (group->count(found) == 0)
    args.fail("obstacle group", name, "it has no atoms: read or create the obstacle before");
  obstacle_groups.push_back(found);
}

void ContactOptions::complete_rules()
{
  const bool given = cloth_rules.thickness != NOT_GIVEN || cloth_rules.friction != NOT_GIVEN;
  if (given && !cloth_meets_cloth)
    error->all(FLERR,
               "{}: cloth/thickness and cloth/friction have no effect without 'cloth yes': add it",
               owner);
  if (untangle && !cloth_meets_cloth && obstacle_groups.empty())
    error->all(FLERR,
               "{}: 'untangle yes' has no effect without 'cloth yes' or an obstacle: add one",
               owner);
  if (cloth_rules.thickness == NOT_GIVEN) cloth_rules.thickness = rules.thickness;
  if (cloth_rules.friction == NOT_GIVEN) cloth_rules.friction = rules.friction;
  cloth_rules.restitution = rules.restitution;
}
