// SPDX-License-Identifier: GPL-2.0-or-later
// Makes atoms, bonds, angles and dihedrals of a sheet from a pattern of triangles.

#include "create_cloth.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "modify.h"
#include "region.h"

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace LAMMPS_NS;
using namespace sphcloth;

static const std::string STYLE = "create_cloth";

// periodic images are counted in 10 bits, from -512
static constexpr double MAX_IMAGES = 500.0;
// each has up to four edges, and these are counted by an int
static constexpr double MAX_CELLS = 1e8;

CreateCloth::CreateCloth(LAMMPS *lmp_) :
    Command(lmp_), itype(0), areal_mass(0.0), center(Vec3::Zero()), axis_u(Vec3::UnitX()),
    axis_v(Vec3::UnitY()), length(0.0), width(0.0), radius(0.0), spacing(0.0), bond_type(1),
    shear_type(0), triangle_type(1), hinge_type(1), groupbit(0), first_id(0)
{
}

/* ----------------------------------------------------------------------
   create_cloth type areal-mass keyword values ...
------------------------------------------------------------------------- */

void CreateCloth::command(int narg, char **arg)
{
  if (!domain->box_exist)
    error->all(FLERR, "{}: there is no box yet: use create_box or read_data before", STYLE);
  if (atom->molecular != Atom::MOLECULAR || !atom->num_dihedral || !atom->num_angle)
    error->all(FLERR,
               "{}: atom_style {} has no bonds, angles and dihedrals: use atom_style molecular, or "
               "hybrid sph molecular",
               STYLE, atom->atom_style);

  ArgReader args(lmp, STYLE, narg, arg);
  itype = args.integer("atom type", 1, atom->ntypes);
  areal_mass = args.positive("mass per area");
  read_options(args);

  sheet = radius > 0.0 ? make_disc(radius, spacing)
                       : make_sheet(pattern.value_or(Pattern::DIAGONAL), length, width, spacing);
  mesh = mesh_topology(sheet.triangles);
  check_types();
  check_box();
  check_capacity();

  create_vertices();
  create_topology();
  if (comm->me == 0)
    utils::logmesg(lmp, "Created cloth: {} vertices, {} bonds, {} triangles, {} hinges\n",
                   sheet.vertices.size(), mesh.edges.size(), sheet.triangles.size(),
                   hinge_type ? mesh.hinges.size() : 0);
}

void CreateCloth::read_options(ArgReader &args)
{
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "center")
      center = read_vector(args, keyword);
    else if (keyword == "size") {
      length = args.positive("size, first side");
      width = args.positive("size, second side");
    } else if (keyword == "disc")
      radius = args.positive("disc, radius");
    else if (keyword == "spacing")
      spacing = args.positive(keyword);
    else if (keyword == "axes") {
      axis_u = read_vector(args, "axes, first");
      axis_v = read_vector(args, "axes, second");
    } else if (keyword == "pattern")
      pattern = read_pattern(args);
    else if (keyword == "bond")
      bond_type = args.integer(keyword, 1, atom->nbondtypes);
    else if (keyword == "shear")
      shear_type = args.integer(keyword, 1, atom->nbondtypes);
    else if (keyword == "triangle")
      triangle_type = args.integer(keyword, 1, atom->nangletypes);
    else if (keyword == "hinge")
      hinge_type = args.integer(keyword, 0, atom->ndihedraltypes);
    else if (keyword == "group")
      groupbit |= read_group(args);
    else if (keyword == "pin") {
      const std::string name = args.word("pin region");
      Region *region = domain->get_region_by_id(name);
      if (!region) args.fail("pin region", name, "define it with the region command first");
      region->init();
      region->prematch();
      pins.emplace_back(region, read_group(args));
    } else
      args.unknown(
          keyword,
          "center, size, disc, spacing, axes, pattern, bond, shear, triangle, hinge, group, pin");
  }
  check_shape();
  if (axis_u.cross(axis_v).norm() < 1e-6 * axis_u.norm() * axis_v.norm() || axis_u.norm() == 0.0)
    error->all(FLERR, "{}: the two axes are parallel or zero: give two directions in the sheet",
               STYLE);
  axis_u.normalize();
  axis_v = (axis_v - axis_v.dot(axis_u) * axis_u).normalized();
  if (!shear_type) shear_type = bond_type;
}

void CreateCloth::check_shape() const
{
  const bool is_disc = radius > 0.0;
  if (length == 0.0 && !is_disc)
    error->all(FLERR, "{}: the size is missing: add 'size LX LY', or 'disc R' for a round sheet",
               STYLE);
  if (length > 0.0 && is_disc)
    error->all(FLERR, "{}: the sheet has both size {} {} and disc {}: remove one of them", STYLE,
               length, width, radius);
  if (is_disc && (pattern || shear_type))
    error->all(FLERR, "{}: {} is about the cells of a rectangle, and disc {} has none: remove {}",
               STYLE, pattern ? "pattern" : "shear", radius, pattern ? "pattern" : "shear");
  if (spacing == 0.0) error->all(FLERR, "{}: the spacing is missing: add 'spacing D'", STYLE);
  if (is_disc && spacing > radius)
    error->all(FLERR, "{}: spacing {} is larger than the radius {}: lower it", STYLE, spacing,
               radius);
  if (!is_disc && spacing > std::min(length, width))
    error->all(FLERR, "{}: spacing {} is larger than the sheet: lower it", STYLE, spacing);
  const double cells = is_disc ? 4.0 * (radius / spacing) * (radius / spacing)
                               : (length / spacing) * (width / spacing);
  if (cells > MAX_CELLS)
    error->all(FLERR, "{}: spacing {} cuts the sheet into {:.3g} cells, more than {:g}: raise it",
               STYLE, spacing, cells, MAX_CELLS);
}

Pattern CreateCloth::read_pattern(ArgReader &args) const
{
  const std::string name = args.word("pattern");
  if (name == "square") return Pattern::SQUARE;
  if (name == "diagonal") return Pattern::DIAGONAL;
  if (name == "equilateral") return Pattern::EQUILATERAL;
  args.fail("pattern", name, "use square, diagonal or equilateral");
}

CreateCloth::Vec3 CreateCloth::read_vector(ArgReader &args, const std::string &what) const
{
  const double x = args.number(what + " x");
  const double y = args.number(what + " y");
  return {x, y, args.number(what + " z")};
}

// a group that does not exist yet is made

int CreateCloth::read_group(ArgReader &args) const
{
  return group->bitmask[group->find_or_create(args.word("group").c_str())];
}

/* ----------------------------------------------------------------------
   everything that can be wrong is found before anything is created
------------------------------------------------------------------------- */

void CreateCloth::check_types() const
{
  const auto need = [&](const char *keyword, int type, int n, const char *what) {
    if (type > n)
      error->all(FLERR, "{}: {} type {} does not exist: add '{}/types {}' to create_box", STYLE,
                 keyword, type, what, type);
  };
  need("bond", std::max(bond_type, shear_type), atom->nbondtypes, "bond");
  need("triangle", triangle_type, atom->nangletypes, "angle");
  need("hinge", hinge_type, atom->ndihedraltypes, "dihedral");
}

void CreateCloth::check_box() const
{
  for (int k = 0; k < static_cast<int>(sheet.vertices.size()); k++) {
    Vec3 x = position(k);
    if (!domain->inside_nonperiodic(x.data()))
      error->all(
          FLERR,
          "{}: the sheet reaches out of the box at ({}, {}, {}): shrink it or move its center",
          STYLE, x[0], x[1], x[2]);
    for (int d = 0; d < 3; d++)
      if (std::fabs(x[d] - domain->boxlo[d]) > MAX_IMAGES * domain->prd[d])
        error->all(
            FLERR,
            "{}: the sheet reaches to ({}, {}, {}), more than {} periodic boxes away: move its "
            "center into the box",
            STYLE, x[0], x[1], x[2], MAX_IMAGES);
  }
}

// LAMMPS has room for so many bonds per atom, which only create_box can widen.

void CreateCloth::check_capacity() const
{
  const int n = static_cast<int>(sheet.vertices.size());
  const bool everywhere = !force->newton_bond;
  std::vector<int> bonds(n, 0), angles(n, 0), dihedrals(n, 0);
  for (const auto &e : mesh.edges)
    for (int k = 0; k < (everywhere ? 2 : 1); k++) bonds[e[k]]++;
  for (const auto &t : sheet.triangles)
    for (int k = 0; k < 3; k++)
      if (everywhere || k == 1) angles[t[k]]++;
  for (const auto &h : mesh.hinges)
    for (int k = 0; k < 4; k++)
      if (everywhere || k == 1) dihedrals[h[k]]++;
  const int b = *std::max_element(bonds.begin(), bonds.end());
  const int a = *std::max_element(angles.begin(), angles.end());
  const int d = hinge_type ? *std::max_element(dihedrals.begin(), dihedrals.end()) : 0;
  if (b > atom->bond_per_atom || a > atom->angle_per_atom || d > atom->dihedral_per_atom)
    error->all(
        FLERR,
        "{}: no room for {} bonds, {} angles and {} dihedrals per atom: add 'extra/bond/per/atom "
        "{} extra/angle/per/atom {} extra/dihedral/per/atom {}' to create_box",
        STYLE, b, a, d, b, a, d);
}

/* ---------------------------------------------------------------------- */

CreateCloth::Vec3 CreateCloth::position(int k) const
{
  return center + sheet.vertices[k][0] * axis_u + sheet.vertices[k][1] * axis_v;
}

void CreateCloth::create_vertices()
{
  first_id = first_free_id(lmp, STYLE, static_cast<bigint>(sheet.vertices.size()));

  const int before = atom->nlocal;
  for (int k = 0; k < static_cast<int>(sheet.vertices.size()); k++) {
    const Vec3 at = position(k);
    const int i = create_owned_atom(atom, domain, first_id + k, itype, at.data(), groupbit);
    if (i < 0) continue;
    for (const auto &[region, pin_bit] : pins)
      if (region->match(at[0], at[1], at[2])) atom->mask[i] |= pin_bit;
  }
  for (int i = before; i < atom->nlocal; i++) modify->create_attribute(i);
  set_masses(before);

  bigint made = atom->nlocal - before, all = 0;
  MPI_Allreduce(&made, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all != static_cast<bigint>(sheet.vertices.size()))
    error->all(FLERR,
               "{}: {} vertices were not created: the sheet touches the upper border of the box",
               STYLE, static_cast<bigint>(sheet.vertices.size()) - all);
  atom->natoms += all;
  refresh_map(atom);
}

// Each vertex gets the mass of its area; where masses belong to types, all get the mean.

void CreateCloth::set_masses(int before)
{
  const std::vector<double> area = vertex_areas(sheet);
  if (atom->rmass)
    for (int i = before; i < atom->nlocal; i++)
      atom->rmass[i] = areal_mass * area[atom->tag[i] - first_id];
  else {
    const double total = std::accumulate(area.begin(), area.end(), 0.0);
    atom->set_mass(FLERR, itype, areal_mass * total / static_cast<double>(area.size()));
  }
}

// Each element is stored with one of its atoms, or with all of them if newton_bond is off.

void CreateCloth::create_topology()
{
  const bool everywhere = !force->newton_bond;
  const auto owned = [&](int vertex) {
    const int i = atom->map(first_id + vertex);
    return i >= 0 && i < atom->nlocal ? i : -1;
  };
  for (const auto &e : mesh.edges)
    for (int k = 0; k < (everywhere ? 2 : 1); k++) {
      const int i = owned(e[k]);
      if (i < 0) continue;
      const int m = atom->num_bond[i]++;
      atom->bond_type[i][m] = is_diagonal_of_cell(sheet, e) ? shear_type : bond_type;
      atom->bond_atom[i][m] = first_id + e[1 - k];
    }
  for (const auto &t : sheet.triangles)
    for (int k = 0; k < 3; k++) {
      const int i = everywhere || k == 1 ? owned(t[k]) : -1;
      if (i < 0) continue;
      const int m = atom->num_angle[i]++;
      atom->angle_type[i][m] = triangle_type;
      atom->angle_atom1[i][m] = first_id + t[0];
      atom->angle_atom2[i][m] = first_id + t[1];
      atom->angle_atom3[i][m] = first_id + t[2];
    }
  if (hinge_type)
    for (const auto &h : mesh.hinges)
      for (int k = 0; k < 4; k++) {
        const int i = everywhere || k == 1 ? owned(h[k]) : -1;
        if (i < 0) continue;
        const int m = atom->num_dihedral[i]++;
        atom->dihedral_type[i][m] = hinge_type;
        atom->dihedral_atom1[i][m] = first_id + h[0];
        atom->dihedral_atom2[i][m] = first_id + h[1];
        atom->dihedral_atom3[i][m] = first_id + h[2];
        atom->dihedral_atom4[i][m] = first_id + h[3];
      }
  atom->nbonds += static_cast<bigint>(mesh.edges.size());
  atom->nangles += static_cast<bigint>(sheet.triangles.size());
  if (hinge_type) atom->ndihedrals += static_cast<bigint>(mesh.hinges.size());
}
