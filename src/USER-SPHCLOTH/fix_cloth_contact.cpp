// Contact of particles with moving triangles: inside the solver of each cloth, and behind it to the
// last digit.

#include "fix_cloth_contact.h"

#include "arg_reader.h"
#include "atom.h"
#include "atom_tools.h"
#include "comm.h"
#include "error.h"
#include "fix_pbd_cloth.h"
#include "group.h"
#include "memory.h"
#include "modify.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FixConst;

/* ----------------------------------------------------------------------
   fix ID group cloth/contact thickness keyword value ...
------------------------------------------------------------------------- */

FixClothContact::FixClothContact(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), label(fmt::format("fix {} cloth/contact", id)), places(nullptr),
    linking(nullptr), sight(0.0)
{
  vector_flag = 1;
  size_vector = 7;
  global_freq = 1;
  extvector = 0;
  comm_forward = VertexHalo::LINK;
  dynamic_group_allow = 1;
  create_attribute = 1;

  ArgReader args(lmp, label, narg, arg, 3);
  rules.thickness = args.positive("thickness");
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "friction")
      rules.friction = args.at_least("friction coefficient", 0.0);
    else if (keyword == "restitution")
      rules.restitution = args.fraction("restitution");
    else if (keyword == "sides")
      rules.sides = args.choice(keyword, {"no", "yes"});
    else
      args.unknown(keyword, "friction, restitution, sides");
  }
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
}

FixClothContact::~FixClothContact()
{
  atom->delete_callback(id, Atom::GROW);
  memory->destroy(places);
}

int FixClothContact::setmask() { return POST_NEIGHBOR | POST_INTEGRATE; }

void FixClothContact::init()
{
  surfaces.clear();
  bool behind = false;
  for (Fix *fix : modify->get_fix_list()) {
    behind = behind || fix == this;
    auto *cloth = dynamic_cast<FixPBDCloth *>(fix);
    if (!cloth) continue;
    if (behind)
      error->all(FLERR, "{}: fix {} pbd/cloth is defined behind: define it before", label, fix->id);
    if (share_atoms(atom, groupbit, fix->groupbit, world))
      error->all(FLERR,
                 "{}: group {} holds vertices of fix {}: give the group of the particles that meet "
                 "the cloth",
                 label, group->names[igroup], fix->id);
    surfaces.push_back(std::make_unique<ContactSurface>(lmp, cloth, this, &rules, &counts));
    cloth->invite(surfaces.back().get());
  }
  if (surfaces.empty())
    error->all(FLERR, "{}: there is no cloth: define 'fix ID group pbd/cloth' before", label);
}

// every cloth has gathered its mesh by now

void FixClothContact::setup_post_neighbor()
{
  if (std::none_of(surfaces.begin(), surfaces.end(),
                   [](const auto &surface) { return surface->has_triangles(); }))
    error->all(FLERR,
               "{}: the cloth has no triangles: they are LAMMPS angles, create_cloth makes them, a "
               "data file needs an Angles section",
               label);
  keep_places();
  if (rules.sides && surfaces.size() > sphcloth::MOST_SHEETS)
    error->all(FLERR, "{}: {} cloths have sides, the most are {}: give 'sides no'", label,
               surfaces.size(), sphcloth::MOST_SHEETS);
  if (rules.sides)
    for (auto &surface : surfaces) surface->check_winding();
  post_neighbor();
}

void FixClothContact::post_neighbor()
{
  for (auto &surface : surfaces) {
    linking = surface.get();
    surface->rebuild();
    surface->set_last_places(places);
  }
  if (rules.sides) find_sides();
}

// They hold until the next list build, since nobody passes.

void FixClothContact::find_sides()
{
  side.assign(atom->nmax, 0);
  if (sight == 0.0) return;
  for (std::size_t sheet = 0; sheet < surfaces.size(); sheet++)
    surfaces[sheet]->find_sides(sight, static_cast<int>(sheet), side);
  linking = nullptr;
  comm->forward_comm(this, 1);
}

// The cloths have been solved, with what they met: see ContactSurface.

void FixClothContact::post_integrate()
{
  for (auto &surface : surfaces) surface->settle();
  keep_places();
}

int FixClothContact::side_of(int i) const
{
  if (!rules.sides || static_cast<std::size_t>(i) >= side.size() || side[i] == 0) return 0;
  for (int sheet = 0; sheet < sphcloth::MOST_SHEETS; sheet++)
    for (int sign : {1, -1})
      if (side[i] & sphcloth::side_of_sheet(sheet, sign > 0)) return sign;
  return 0;
}

void FixClothContact::keep_places()
{
  if (atom->nlocal) std::copy_n(atom->x[0], 3 * atom->nlocal, places[0]);
}

/* ----------------------------------------------------------------------
   output: contacts, stops, frozen, deepest, impulse on held vertices (x, y, z)
------------------------------------------------------------------------- */

double FixClothContact::compute_vector(int n)
{
  const double mine[] = {counts.contacts,   counts.stops,      counts.frozen,    counts.deepest,
                         counts.impulse[0], counts.impulse[1], counts.impulse[2]};
  double all;
  MPI_Allreduce(&mine[n], &all, 1, MPI_DOUBLE, n == 3 ? MPI_MAX : MPI_SUM, world);
  return all;
}

/* ----------------------------------------------------------------------
   per atom
------------------------------------------------------------------------- */

int FixClothContact::pack_forward_comm(int n, int *sendlist, double *buf, int, int *)
{
  if (linking) return linking->pack_link(n, sendlist, buf);
  for (int k = 0; k < n; k++) buf[k] = side[sendlist[k]];
  return n;
}

void FixClothContact::unpack_forward_comm(int n, int first, double *buf)
{
  if (linking) return linking->unpack_link(n, first, buf);
  for (int k = 0; k < n; k++) side[first + k] = static_cast<sphcloth::Sides>(buf[k]);
}

void FixClothContact::grow_arrays(int nmax)
{
  memory->grow(places, nmax, 3, "cloth/contact:places");
  for (auto &surface : surfaces) surface->set_last_places(places);
}

void FixClothContact::copy_arrays(int i, int j, int)
{
  std::copy(places[i], places[i] + 3, places[j]);
}

void FixClothContact::set_arrays(int i) { std::copy(atom->x[i], atom->x[i] + 3, places[i]); }

int FixClothContact::pack_exchange(int i, double *buf)
{
  std::copy(places[i], places[i] + 3, buf);
  return 3;
}

int FixClothContact::unpack_exchange(int i, double *buf)
{
  std::copy(buf, buf + 3, places[i]);
  return 3;
}

double FixClothContact::memory_usage()
{
  double bytes = 3.0 * sizeof(double) * atom->nmax;
  for (const auto &surface : surfaces) bytes += surface->memory_usage();
  return bytes;
}
