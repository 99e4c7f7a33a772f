// Contact of particles with moving triangles: inside the solver of each cloth, and behind it to the
// last digit.

#include "fix_cloth_contact.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_pbd_cloth.h"
#include "force.h"
#include "group.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "memory.h"
#include "modify.h"
#include "pair_sph_tait.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FixConst;

// of the looks at all surfaces behind the solver: what one of them puts back another may mind
static constexpr int MOST_ROUNDS = 10;

/* ----------------------------------------------------------------------
   fix ID group cloth/contact thickness keyword value ...
------------------------------------------------------------------------- */

FixClothContact::FixClothContact(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} cloth/contact", id)), places(nullptr),
    pushes(nullptr), beyond(nullptr), linking(nullptr), sight(0.0), vertex_bits(0)
{
  vector_flag = 1;
  size_vector = 11;
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
    else if (keyword == "obstacle")
      read_obstacle(args);
    else if (keyword == "sides")
      rules.sides = args.choice(keyword, {"no", "yes"});
    else if (keyword == "wall") {
      const bool yes = args.choice(keyword, {"no", "yes"});
      walls.reset(yes ? new MeshBoundary(lmp, label, groupbit) : nullptr);
    } else
      args.unknown(keyword, "friction, restitution, sides, wall, obstacle");
  }
  restart_peratom = !obstacle_groups.empty();
  FixClothContact::grow_arrays(atom->nmax);
  for (int i = 0; i < atom->nlocal; i++) FixClothContact::set_arrays(i);
  atom->add_callback(Atom::GROW);
  if (restart_peratom) atom->add_callback(Atom::RESTART);
  if (pushes) std::fill_n(pushes[0], 3 * atom->nmax, 0.0);
}

void FixClothContact::read_obstacle(ArgReader &args)
{
  const std::string name = args.word("obstacle group");
  const int found = group->find(name);
  if (found < 0) args.fail("obstacle group", name, "define it with the group command first");
  if (group->count(found) == 0)
    args.fail("obstacle group", name, "it has no atoms: read or create the obstacle before");
  obstacle_groups.push_back(found);
}

FixClothContact::~FixClothContact()
{
  atom->delete_callback(id, Atom::GROW);
  if (restart_peratom) atom->delete_callback(id, Atom::RESTART);
  memory->destroy(places);
  memory->destroy(pushes);
  memory->destroy(beyond);
}

int FixClothContact::setmask()
{
  return POST_NEIGHBOR | POST_INTEGRATE | INITIAL_INTEGRATE | POST_FORCE |
      (pushes ? PRE_REVERSE : 0);
}

void FixClothContact::init()
{
  surfaces.clear();
  obstacles.clear();
  hard.clear();
  couplings.clear();
  vertex_bits = 0;
  std::vector<FixPBDCloth *> cloths;
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
    surfaces.push_back(
        std::make_unique<ContactSurface>(lmp, cloth, this, groupbit, &rules, &counts));
    cloth->register_coupling(surfaces.back().get());
    cloths.push_back(cloth);
    vertex_bits |= cloth->groupbit;
  }
  if (surfaces.empty() && obstacle_groups.empty())
    error->all(FLERR,
               "{}: there is no cloth: define 'fix ID group pbd/cloth' before, or name an obstacle",
               label);
  for (int obstacle : obstacle_groups) add_obstacle(obstacle, cloths);
  auto *fluid = dynamic_cast<PairSPHTait *>(force->pair_match("sph/tait", 1));
  memory->destroy(beyond);
  if (fluid && fluid->integrates_density()) {
    memory->create(beyond, atom->nmax, 3, "cloth/contact:beyond");
    std::fill_n(beyond[0], 3 * atom->nmax, 0.0);
  }
  if (!walls) return;
  walls->init(fluid);
  for (std::size_t k = 0; k < surfaces.size(); k++) walls->add(cloths[k], surfaces[k].get());
  for (std::size_t k = 0; k < hard.size(); k++) walls->add(obstacles[k].get(), hard[k].get());
}

// Meets the group of this fix and the vertices of all cloths.

void FixClothContact::add_obstacle(int obstacle_group, const std::vector<FixPBDCloth *> &cloths)
{
  const int bit = group->bitmask[obstacle_group];
  const char *name = group->names[obstacle_group];
  int meets = groupbit;
  for (FixPBDCloth *cloth : cloths) {
    if (share_atoms(atom, bit, cloth->groupbit, world))
      error->all(FLERR, "{}: obstacle group {} holds vertices of fix {}: an obstacle is no cloth",
                 label, name, cloth->id);
    meets |= cloth->groupbit;
  }
  if (share_atoms(atom, bit, groupbit, world))
    error->all(
        FLERR,
        "{}: obstacle group {} holds atoms of group {}: give the group of the particles that "
        "meet the obstacle",
        label, name, group->names[igroup]);
  obstacles.push_back(std::make_unique<Obstacle>(lmp, label, bit));
  Obstacle &obstacle = *obstacles.back();
  obstacle.gather();
  if (obstacle.topology().triangles.size() == 0)
    error->all(FLERR,
               "{}: obstacle group {} has no triangles: they are LAMMPS angles; 'sphcloth mesh' "
               "writes them",
               label, name);
  obstacle.set_pushes(pushes);
  hard.push_back(std::make_unique<ContactSurface>(lmp, &obstacle, this, meets, &rules, &counts));
  for (FixPBDCloth *cloth : cloths) {
    couplings.push_back(std::make_unique<ObstacleCoupling>(lmp, cloth, hard.back().get(), &rules));
    cloth->register_coupling(couplings.back().get());
    hard.back()->meet_vertices_of(cloth);
  }
}

template <class Do> void FixClothContact::for_all_surfaces(Do something)
{
  for (auto &surface : surfaces) something(*surface);
  for (auto &surface : hard) something(*surface);
}

// every cloth has gathered its mesh by now

void FixClothContact::setup_post_neighbor()
{
  if (!surfaces.empty() && std::none_of(surfaces.begin(), surfaces.end(), [](const auto &surface) {
        return surface->has_triangles();
      }))
    error->all(FLERR,
               "{}: the cloth has no triangles: they are LAMMPS angles, create_cloth makes them, a "
               "data file needs an Angles section",
               label);
  keep_places();
  if (rules.sides && surfaces.size() > sphcloth::MAX_SHEETS)
    error->all(FLERR, "{}: {} cloths have sides, the most are {}: give 'sides no'", label,
               surfaces.size(), sphcloth::MAX_SHEETS);
  if (rules.sides)
    for (auto &surface : surfaces) surface->check_winding();
  post_neighbor();
  warn_of_too_near();
}

void FixClothContact::warn_of_too_near()
{
  for_all_surfaces([this](ContactSurface &surface) {
    tagint one;
    const bigint n = surface.count_too_near(one);
    if (n > 0 && comm->me == 0)
      error->warning(
          FLERR,
          "{}: {} particles start nearer to the triangles than the thickness {}, atom {} "
          "for example: they get their gap by a tenth of it per step; place them farther "
          "away, or lower the thickness",
          label, n, rules.thickness, one);
  });
}

void FixClothContact::post_neighbor()
{
  follow_into_box();
  const double far = std::max(rules.thickness, walls ? walls->reach() : 0.0);
  for_all_surfaces([this, far](ContactSurface &surface) {
    linking = &surface;
    surface.rebuild(far);
    surface.set_last_places(places);
  });
  if (walls) walls->look();
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

void FixClothContact::initial_integrate(int)
{
  for_all_surfaces([](ContactSurface &surface) { surface.begin(); });
  if (pushes) std::fill_n(pushes[0], 3 * atom->nmax, 0.0);
}

// The cloths have been solved, with what they met: see ContactSurface.

void FixClothContact::post_integrate()
{
  for (int round = 0; round < MOST_ROUNDS; round++) {
    bool any = false;
    for_all_surfaces([&any](ContactSurface &surface) { any = surface.settle() || any; });
    if (!any || surfaces.size() + hard.size() == 1) break;
  }
  if (beyond) show_way();
  keep_places();
}

// Vertices, and particles in contact, leave a step with the velocity of its last substep, which is not
// that of their way.  A density that is integrated must follow the way: forces are evaluated with the
// velocity of the way, and what is beyond comes back behind them.

void FixClothContact::show_way()
{
  for_all_surfaces([&](const ContactSurface &surface) {
    for (int i : surface.met()) show_way_of(i);
  });
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & vertex_bits) show_way_of(i);
}

void FixClothContact::show_way_of(int i)
{
  double *v = atom->v[i];
  for (int d = 0; d < 3; d++) {
    const double more = v[d] - (atom->x[i][d] - places[i][d]) / update->dt;
    beyond[i][d] += more;
    v[d] -= more;
  }
}

void FixClothContact::post_force(int)
{
  if (!beyond) return;
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) {
      atom->v[i][d] += beyond[i][d];
      beyond[i][d] = 0.0;
    }
}

void FixClothContact::pre_reverse(int, int)
{
  const double by = 1.0 / (update->dt * force->ftm2v);
  for (const auto &obstacle : obstacles)
    for (int i = 0; i < atom->nlocal; i++)
      if (obstacle->has_vertex(i))
        for (int d = 0; d < 3; d++) atom->f[i][d] += by * pushes[i][d];
}

int FixClothContact::side_of(int i) const
{
  if (!rules.sides || static_cast<std::size_t>(i) >= side.size() || side[i] == 0) return 0;
  for (int sheet = 0; sheet < sphcloth::MAX_SHEETS; sheet++)
    for (int sign : {1, -1})
      if (side[i] & sphcloth::side_of_sheet(sheet, sign > 0)) return sign;
  return 0;
}

// LAMMPS has put atoms back into the box.  It may be another box by the end of the next step.

void FixClothContact::follow_into_box()
{
  for (int i = 0; i < atom->nlocal; i++) {
    double displacement[3];
    for (int d = 0; d < 3; d++) displacement[d] = atom->x[i][d] - places[i][d];
    domain->minimum_image(FLERR, displacement);
    for (int d = 0; d < 3; d++) places[i][d] = atom->x[i][d] - displacement[d];
  }
}

void FixClothContact::keep_places()
{
  if (atom->nlocal > 0) std::copy_n(atom->x[0], 3 * atom->nlocal, places[0]);
}

/* ----------------------------------------------------------------------
   output: contacts, stops, frozen, deepest, impulse on held vertices (x, y, z), force on obstacles
   (x, y, z), wall time
------------------------------------------------------------------------- */

double FixClothContact::compute_vector(int n)
{
  double mine[11] = {counts.contacts,   counts.stops,      counts.frozen,    counts.deepest,
                     counts.impulse[0], counts.impulse[1], counts.impulse[2]};
  double all;
  mine[10] = counts.seconds;
  if (n >= 7 && n < 10 && pushes)
    for (int i = 0; i < atom->nlocal; i++)
      mine[n] += pushes[i][n - 7] / (update->dt * force->ftm2v);
  MPI_Allreduce(&mine[n], &all, 1, MPI_DOUBLE, n == 3 || n == 10 ? MPI_MAX : MPI_SUM, world);
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
  if (beyond) memory->grow(beyond, nmax, 3, "cloth/contact:beyond");
  if (!obstacle_groups.empty()) memory->grow(pushes, nmax, 3, "cloth/contact:pushes");
  for (auto &obstacle : obstacles) obstacle->set_pushes(pushes);
  for_all_surfaces([this](ContactSurface &surface) { surface.set_last_places(places); });
}

void FixClothContact::copy_arrays(int i, int j, int)
{
  for (double **each : {places, pushes, beyond})
    if (each) std::copy_n(each[i], 3, each[j]);
}

void FixClothContact::set_arrays(int i)
{
  std::copy_n(atom->x[i], 3, places[i]);
  for (double **each : {pushes, beyond})
    if (each) std::fill_n(each[i], 3, 0.0);
}

int FixClothContact::pack_exchange(int i, double *buf)
{
  double *end = buf;
  for (double **each : {places, pushes, beyond})
    if (each) end = std::copy_n(each[i], 3, end);
  return static_cast<int>(end - buf);
}

int FixClothContact::unpack_exchange(int i, double *buf)
{
  const double *from = buf;
  for (double **each : {places, pushes, beyond})
    if (each) {
      std::copy_n(from, 3, each[i]);
      from += 3;
    }
  return static_cast<int>(from - buf);
}

// only what obstacles feel; the first value of a restart record is its length

int FixClothContact::pack_restart(int i, double *buf)
{
  buf[0] = 4;
  std::copy(pushes[i], pushes[i] + 3, buf + 1);
  return 4;
}

void FixClothContact::unpack_restart(int i, int nth)
{
  const double *record = atom->extra[i];
  for (int k = 0; k < nth; k++) record += static_cast<int>(*record);
  std::copy(record + 1, record + 4, pushes[i]);
}

int FixClothContact::size_restart(int) { return 4; }
int FixClothContact::maxsize_restart() { return 4; }

double FixClothContact::memory_usage()
{
  double bytes = 0.0;
  for (double **each : {places, pushes, beyond})
    if (each) bytes += 3.0 * sizeof(double) * atom->nmax;
  for_all_surfaces([&bytes](const ContactSurface &surface) { bytes += surface.memory_usage(); });
  return bytes;
}
