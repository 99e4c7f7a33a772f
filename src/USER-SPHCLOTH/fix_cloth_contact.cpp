// Contact of particles with moving triangles: inside the solver of each cloth, and behind it to the
// last digit.

#include "fix_cloth_contact.h"

#include "arg_reader.h"
#include "atom.h"
#include "atom_tools.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_pbd_cloth.h"
#include "force.h"
#include "group.h"
#include "memory.h"
#include "modify.h"
#include "pair_sph_tait.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FixConst;

// columns of `places`: where an atom was at the end of the last step, and what contact has left it of
// velocity beyond the way that it went
static constexpr int BEYOND = 3, PLACES = 6;

/* ----------------------------------------------------------------------
   fix ID group cloth/contact thickness keyword value ...
------------------------------------------------------------------------- */

FixClothContact::FixClothContact(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), label(fmt::format("fix {} cloth/contact", id)), places(nullptr),
    linking(nullptr), sight(0.0), density_follows_velocity(false)
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
  for (int i = 0; i < atom->nlocal; i++) set_arrays(i);
  atom->add_callback(Atom::GROW);
}

FixClothContact::~FixClothContact()
{
  atom->delete_callback(id, Atom::GROW);
  memory->destroy(places);
}

int FixClothContact::setmask() { return POST_NEIGHBOR | POST_INTEGRATE | POST_FORCE; }

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
  const auto *fluid = dynamic_cast<PairSPHTait *>(force->pair_match("sph/tait", 1));
  density_follows_velocity = fluid && fluid->integrates_density();
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
  if (density_follows_velocity) show_way();
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

// A particle leaves its contacts with the velocity of the last substep, which is not that of its way in
// the step.  A density that is integrated must follow the way: forces are evaluated with the velocity
// of the way, and what is beyond comes back behind them.

void FixClothContact::show_way()
{
  const double inv_dt = 1.0 / update->dt;
  for (const auto &surface : surfaces)
    for (int i : surface->met()) {
      double *v = atom->v[i], *place = places[i], way[3];
      for (int d = 0; d < 3; d++) way[d] = atom->x[i][d] - place[d];
      domain->minimum_image(FLERR, way);
      for (int d = 0; d < 3; d++) {
        const double beyond = v[d] - inv_dt * way[d];
        place[BEYOND + d] += beyond;
        v[d] -= beyond;
      }
    }
}

void FixClothContact::post_force(int)
{
  if (!density_follows_velocity) return;
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) {
      atom->v[i][d] += places[i][BEYOND + d];
      places[i][BEYOND + d] = 0.0;
    }
}

void FixClothContact::keep_places()
{
  for (int i = 0; i < atom->nlocal; i++) std::copy_n(atom->x[i], 3, places[i]);
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
  memory->grow(places, nmax, PLACES, "cloth/contact:places");
  for (auto &surface : surfaces) surface->set_last_places(places);
}

void FixClothContact::copy_arrays(int i, int j, int)
{
  std::copy_n(places[i], PLACES, places[j]);
}

void FixClothContact::set_arrays(int i)
{
  std::copy_n(atom->x[i], 3, places[i]);
  std::fill_n(places[i] + BEYOND, 3, 0.0);
}

int FixClothContact::pack_exchange(int i, double *buf)
{
  std::copy_n(places[i], PLACES, buf);
  return PLACES;
}

int FixClothContact::unpack_exchange(int i, double *buf)
{
  std::copy_n(buf, PLACES, places[i]);
  return PLACES;
}

double FixClothContact::memory_usage()
{
  double bytes = PLACES * sizeof(double) * atom->nmax;
  for (const auto &surface : surfaces) bytes += surface->memory_usage();
  return bytes;
}
