// SPDX-License-Identifier: GPL-2.0-or-later
// Reads rest positions, and checks what a cloth is made of.

#include "cloth/cloth_input.h"

#include "atom.h"
#include "bond.h"
#include "cloth/pbd_material.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "lammps_util/atom_tools.h"
#include "modify.h"

using namespace LAMMPS_NS;

void ClothInput::read_rest_positions(const std::string &property, ParticleColumns &rest_x) const
{
  int flag, cols;
  const std::string name = utils::strmatch(property, "^d2_") ? property.substr(3) : property;
  const int index = atom->find_custom(name.c_str(), flag, cols);
  if (index < 0 || flag != 1 || cols != 3)
    error->all(FLERR,
               "{}: rest property '{}' does not exist: define it with 'fix ID all property/atom "
               "d2_{} 3' and read it from the data file",
               label, property, name);
  int mine = 0, any = 0;
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) {
      rest_x[d][i] = atom->darray[index][i][d];
      if (atom->mask[i] & fix->groupbit && rest_x[d][i] != 0.0) mine = 1;
    }
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (!any)
    error->all(FLERR,
               "{}: rest property '{}' is 0 everywhere: fill it with 'set', from the data file, or "
               "from the restart file by the fix ID that it was written with",
               label, property);
}

void ClothInput::check_vertices() const
{
  for (Fix *other : modify->get_fix_by_style("^pbd/cloth$")) {
    if (other == fix) continue;
    if (share_atoms(atom, fix->groupbit, other->groupbit, world))
      error->all(FLERR,
                 "{}: shares vertices with fix {}: give the two fixes groups without common atoms",
                 label, other->id);
  }
  for (const Fix *other : modify->get_fix_by_style("^bond/")) {
    const auto is = [other](const char *style) { return utils::strmatch(other->style, style); };
    // fix bond/react has groups of its own in place of the one of the fix
    if (is("^bond/react") ||
        ((is("^bond/break") || is("^bond/create") || is("^bond/swap")) &&
         share_atoms(atom, fix->groupbit, other->groupbit, world)))
      error->all(FLERR,
                 "{}: fix {} {} would change bonds of the cloth within a run, which are read where "
                 "a run begins: remove it with 'unfix {}' or give it a group without vertices; "
                 "tear cloth with delete_bonds between runs",
                 label, other->id, other->style, other->id);
  }
  tagint mine = 0, massless;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & fix->groupbit && !(atom_mass(atom, i) > 0.0)) mine = atom->tag[i];
  MPI_Allreduce(&mine, &massless, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  if (massless)
    error->all(FLERR, "{}: vertex {} has no mass: give it one with 'set group {} mass'", label,
               massless, group->names[fix->igroup]);
}

void ClothInput::check_styles() const
{
  if (!force->bond || !dynamic_cast<HasPBDMaterials *>(force->bond_match("pbd")))
    error->all(FLERR, "{}: bond_style {} holds no stiffness: use 'bond_style pbd'", label,
               force->bond_style ? force->bond_style : "none");
}
