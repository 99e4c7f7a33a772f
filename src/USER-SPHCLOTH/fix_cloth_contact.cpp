// SPDX-License-Identifier: GPL-2.0-or-later
// Contact of particles with moving triangles: inside the solver of each cloth, and behind it to the
// last digit.

#include "fix_cloth_contact.h"

#include "atom.h"
#include "comm.h"
#include "contact/find_layers.h"
#include "contact/order_of_fixes.h"
#include "domain.h"
#include "error.h"
#include "fix_pbd_cloth.h"
#include "fix_sph_integrate.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "group.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FixConst;

// over all meshes behind the solver: what one of them puts back may penetrate another
static constexpr int MAX_ROUNDS = 10;

/* ----------------------------------------------------------------------
   fix ID group cloth/contact thickness keyword value ...
------------------------------------------------------------------------- */

FixClothContact::FixClothContact(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} cloth/contact", id)), options(lmp, label),
    rules(options.rules), ghosts(lmp, label), step_start(lmp), view_distance(0.0), vertex_bits(0),
    particle_bits(0)
{
  vector_flag = 1;
  size_vector = 15;
  global_freq = 1;
  extvector = 0;
  comm_forward = 4;
  dynamic_group_allow = 1;
  create_attribute = 1;

  ArgReader args(lmp, label, narg, arg, 3);
  options.read(args);
  counts.cloth_gap = options.cloth_rules.thickness;    // none is nearer before the first step
  if (options.walls) walls = std::make_unique<MeshBoundary>(lmp, label, groupbit);
  restart_peratom = !options.obstacle_groups.empty();
  step_start.positions.create(3, atom->nmax);
  if (!options.obstacle_groups.empty()) impulses.create(atom->nmax);
  for (int i = 0; i < atom->nlocal; i++) FixClothContact::set_arrays(i);
  atom->add_callback(Atom::GROW);
  if (restart_peratom) atom->add_callback(Atom::RESTART);
}

FixClothContact::~FixClothContact()
{
  atom->delete_callback(id, Atom::GROW);
  if (restart_peratom) atom->delete_callback(id, Atom::RESTART);
}

int FixClothContact::setmask()
{
  return PRE_EXCHANGE | MIN_PRE_EXCHANGE | POST_NEIGHBOR | MIN_POST_NEIGHBOR | POST_INTEGRATE |
      INITIAL_INTEGRATE | POST_FORCE | (impulses.empty() ? 0 : PRE_REVERSE) |
      (options.untangle ? PRE_NEIGHBOR : 0);
}

void FixClothContact::init()
{
  contacts.clear();
  separate.clear();
  joined.reset();
  surfaces.clear();
  obstacles.clear();
  obstacle_surfaces.clear();
  sheets.clear();
  vertex_bits = 0;
  cloths = cloths_before(lmp, this, label);
  for (const FixPBDCloth *cloth : cloths) vertex_bits |= cloth->groupbit;
  // a fix before its cloths is an error: all have the same
  together = {this};
  if (!cloths.empty()) {
    together.clear();
    for (Fix *fix : modify->get_fix_by_style("^cloth/contact$"))
      together.push_back(static_cast<FixClothContact *>(fix));
  }
  check_group();
  warn_of_reflection_after(lmp, this, label);
  for (FixPBDCloth *cloth : cloths) surfaces.push_back(make_surface(cloth));
  if (surfaces.empty() && options.obstacle_groups.empty())
    error->all(FLERR,
               "{}: there is no cloth: define 'fix ID group pbd/cloth' before, or name an obstacle",
               label);
  for (int obstacle : options.obstacle_groups) add_obstacle(obstacle);
  make_contacts();
  stepping = FixSPHIntegrate::find(modify);
  auto *fluid = FluidState::find(force);
  const bool follows = fluid && fluid->integrates_density();
  excess_velocities.create(follows ? 3 : 0, atom->nmax);
  step_start.wants_origins = follows;
  if (walls) {
    walls->init(fluid);
    for (std::size_t k = 0; k < surfaces.size(); k++)
      walls->add(cloths[k], &surfaces[k]->triangles, MeshBoundary::Mesh::CLOTH);
    for (std::size_t k = 0; k < obstacle_surfaces.size(); k++)
      walls->add(obstacles[k].get(), &obstacle_surfaces[k]->triangles,
                 MeshBoundary::Mesh::OBSTACLE);
  }
  pore_distance = 0.0;
  require_ghosts();
}

void FixClothContact::require_ghosts()
{
  if (!ghosts.matters()) return;
  const auto [needed, wanted] = ghosts_needed_and_wanted();
  ghosts.require(needed, wanted);
  if (!rules.sides || view_distance == 0.0) return;
  std::vector<const ClothTopology *> meshes;
  for (const ContactSurface *sheet : find_sheets())
    meshes.push_back(&sheet->triangles.mesh->topology());
  // with a particle in the middle
  in_layers = in_layers || have_layers(lmp, meshes, 2.0 * view_distance);
  ghosts.require(ghosts_of_sides(), 0.0);
}

// Without water the group is that of the cloth.  An empty one is that of water to come.

void FixClothContact::check_group()
{
  int mine[2] = {0, 0}, any[2];    // vertices, and other atoms
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) mine[atom->mask[i] & vertex_bits ? 0 : 1] = 1;
  MPI_Allreduce(mine, any, 2, MPI_INT, MPI_MAX, world);
  particle_bits = options.cloth_meets_cloth && any[0] && !any[1] ? 0 : groupbit;
  for (FixPBDCloth *cloth : cloths)
    if (particle_bits && share_atoms(atom, groupbit, cloth->groupbit, world))
      error->all(FLERR,
                 "{}: group {} holds vertices of fix {}: give the group of the particles that meet "
                 "the cloth",
                 label, group->names[igroup], cloth->id);
}

void FixClothContact::make_contacts()
{
  const std::size_t n = surfaces.size() + obstacle_surfaces.size();
  if (n > 1 && !cloths.empty() && (options.cloth_meets_cloth || !obstacles.empty())) {
    join();
    return;
  }
  for_all_surfaces([&](ContactSurface &surface) {
    separate.push_back(std::make_unique<MeshContact>(
        lmp, surface.triangles, !cloths.empty() && options.cloth_meets_cloth, 0, meeting_rules()));
    contacts.push_back(separate.back().get());
  });
  for (std::size_t k = 0; k < cloths.size(); k++)
    cloths[k]->register_coupling(&contacts[k]->rows());
}

void FixClothContact::join()
{
  JoinedContact::Meshes meshes{{cloths.begin(), cloths.end()}, {}, vertex_bits, 0};
  for (const auto &obstacle : obstacles) {
    meshes.obstacles.push_back(obstacle.get());
    meshes.obstacle_bits |= obstacle->groupbit;
  }
  joined = std::make_unique<JoinedContact>(lmp, meshes, label, particle_bits, meeting_rules(),
                                           counts, step_start);
  contacts.push_back(&joined->contact);
  FixPBDCloth::solve_together(cloths);
  for (std::size_t k = 0; k < cloths.size(); k++) cloths[k]->register_coupling(joined->parts[k]);
}

void FixClothContact::pre_exchange()
{
  for (auto &obstacle : obstacles) require_inside_box(lmp, label, obstacle->groupbit);
  if (!ghosts.matters()) return;
  const auto [needed, wanted] = ghosts_needed_and_wanted();
  ghosts.require_in_run(needed, wanted);
  ghosts.require_in_run(ghosts_of_sides(), 0.0);
}

// A particle must see whole triangles.  Wanted is room for displacements until the next list build:
// the skin, and steps at twice the present speeds, as long as these do not cross the box: both the
// speeds and the steps grow in between.

std::array<double, 2> FixClothContact::ghosts_needed_and_wanted()
{
  double longest = 0.0, mine = 0.0, speed_sq = 0.0;
  for (auto &obstacle : obstacles) obstacle->measure();
  for_all_surfaces([&](const ContactSurface &surface) {
    longest = std::max(longest, surface.triangles.mesh->topology().longest_edge());
    const int bits = surface.triangles.groupbits;
    for (int i = 0; i < atom->nlocal; i++) {
      if (!(atom->mask[i] & bits) && !surface.triangles.mesh->has_vertex(i)) continue;
      const double *v = atom->v[i];
      mine = std::max(mine, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    }
  });
  MPI_Allreduce(&mine, &speed_sq, 1, MPI_DOUBLE, MPI_MAX, world);
  const int steps = std::max({1, neighbor->every, neighbor->delay});
  const double displacement = std::min(4.0 * steps * update->dt * std::sqrt(speed_sq),
                                       std::max(2.0 * neighbor->skin, ghosts.size_of_box()));
  double needed = longest + reach_of_triangles(),
         wanted = longest + rules.thickness + neighbor->skin + displacement;
  if (meets_cloth()) {
    double of_cloth = 0.0, of_obstacles = 0.0;
    for (const auto &surface : surfaces)
      of_cloth = std::max(of_cloth, surface->triangles.mesh->topology().longest_edge());
    for (const auto &obstacle : obstacles)
      of_obstacles = std::max(of_obstacles, obstacle->topology().longest_edge());
    const double reach = ContactGuarantee::reach(
        of_cloth, of_obstacles, std::max(rules.thickness, options.cloth_rules.thickness));
    needed = std::max(needed, reach);
    wanted = std::max(wanted, reach + neighbor->skin + displacement);
  }
  return {needed, wanted};
}

void FixClothContact::add_obstacle(int obstacle_group)
{
  const int bit = group->bitmask[obstacle_group];
  const char *name = group->names[obstacle_group];
  refuse_dynamic_group(lmp, label, "obstacle", obstacle_group);
  for (const FixPBDCloth *cloth : cloths)
    if (share_atoms(atom, bit, cloth->groupbit, world))
      error->all(FLERR, "{}: obstacle group {} holds vertices of fix {}: an obstacle is no cloth",
                 label, name, cloth->id);
  if (share_atoms(atom, bit, groupbit, world))
    error->all(
        FLERR,
        "{}: obstacle group {} holds atoms of group {}: give the group of the particles that "
        "meet the obstacle",
        label, name, group->names[igroup]);
  obstacles.push_back(std::make_unique<Obstacle>(lmp, label, bit, impulses));
  Obstacle &obstacle = *obstacles.back();
  obstacle.gather();
  if (obstacle.topology().triangles.size() == 0)
    error->all(FLERR,
               "{}: obstacle group {} has no triangles: they are LAMMPS angles; 'sphcloth mesh' "
               "writes them",
               label, name);
  obstacle_surfaces.push_back(make_surface(&obstacle));
}

// every cloth has gathered its mesh by now

void FixClothContact::setup_post_neighbor()
{
  if (!surfaces.empty() && std::none_of(surfaces.begin(), surfaces.end(), [](const auto &surface) {
        return surface->triangles.has_triangles();
      }))
    error->all(FLERR,
               "{}: the cloth has no triangles: they are LAMMPS angles, create_cloth makes them, a "
               "data file needs an Angles section",
               label);
  step_start.atoms_moved();
  step_start.take_positions();
  sheets.clear();
  if (rules.sides) sheets = find_sheets();
  if (sheets.size() > sphcloth::MAX_SHEETS)
    error->all(FLERR,
               "{}: {} cloths and open obstacles have sides, the most are {}: give 'sides no'",
               label, sheets.size(), sphcloth::MAX_SHEETS);
  for (ContactSurface *sheet : sheets) sheet->triangles.check_winding();
  post_neighbor();
  if (update->whichflag == 2) return;    // minimize knows walls and sides, and no contact
  for (MeshContact *contact : contacts) contact->check_start(options.untangle);
}

void FixClothContact::post_neighbor()
{
  step_start.rebuild();
  const double distance = reach_of_triangles();
  for_all_surfaces([distance](ContactSurface &s) { s.triangles.rebuild(distance); });
  if (joined) joined->triangles.rebuild(std::max(distance, options.cloth_rules.thickness));
  for (MeshContact *contact : contacts) contact->rebuild();
  if (joined) joined->coupling.rebuild();
  if (walls) walls->update_candidates();
  if (rules.sides) find_sides();
}

// They hold until the next list build, since particles do not pass.

void FixClothContact::find_sides()
{
  side.assign(atom->nmax, 0);
  sheet_layers.start(atom->nmax, view_distance);
  if (view_distance == 0.0) return;
  for (std::size_t sheet = 0; sheet < sheets.size(); sheet++)
    sheets[sheet]->sides.find(view_distance, static_cast<int>(sheet), side, sheet_layers);
  comm->forward_comm(this);
  if (!in_layers && ghosts.matters()) {
    const int mine = std::any_of(side.begin(), side.end(),
                                 [](sphcloth::Sides of) { return of & sphcloth::LAYERED; });
    int any = 0;
    MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
    in_layers = any;
  }
  if (std::none_of(side.begin(), side.end(), [](sphcloth::Sides of) { return of != 0; })) return;
  for (const ContactSurface *sheet : sheets) sheet->sides.add_triangles(sheet_layers);
  sheet_layers.finish(atom->x[0], atom->nlocal + atom->nghost);
}

void FixClothContact::initial_integrate(int)
{
  step_start.moved.clear();
  impulses.begin_step(atom->nlocal, update->dt);
  counts.cloth_gap = options.cloth_rules.thickness;
  counts.passed_on = counts.missed = 0.0;
}

// of the momentum that stops particles, on all ranks

static double missed_share(const ContactCounts &counts, MPI_Comm world)
{
  const double mine[2] = {counts.missed, counts.passed_on};
  double all[2];
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, world);
  return all[0] > 0.0 ? all[0] / (all[0] + all[1]) : 0.0;
}

// The cloths have been solved, with their contacts: see ContactRows.

void FixClothContact::post_integrate()
{
  step_start.note_origins(update->dt);    // there may be no cloth
  if (together.back() != this) return;
  bool any = false;
  for (int round = 0; round < MAX_ROUNDS; round++) {
    bool again = false;
    std::size_t meshes = 0;
    for (const FixClothContact *fix : together) {
      for (MeshContact *contact : fix->contacts) again = contact->resolve() || again;
      meshes += fix->contacts.size();
    }
    any = any || again;
    if (!again || meshes == 1) break;
  }
  for (FixClothContact *fix : together) fix->end_step(any);
}

void FixClothContact::end_step(bool any_contact)
{
  if (any_contact)
    if (const double share = missed_share(counts, world); share > 0.0)
      for (FixPBDCloth *cloth : cloths) cloth->missed_in_contact(share);
  if (!excess_velocities.empty()) subtract_excess_velocities();
  if (stepping && stepping->lets_sleep())
    for (MeshContact *contact : contacts)
      contact->for_particles_at_moving_triangles(stepping->sleeping_speed() * update->dt,
                                                 [this](int i) { stepping->disturb(i); });
  if (any_contact) step_start.atoms_moved();
  step_start.take_positions();
}

// Vertices, and particles in contact, end a step with the velocity of its last substep, which is
// not the mean velocity of the step.  A density that is integrated must follow displacements:
// forces are evaluated with the mean velocity, and the difference comes back behind them.

void FixClothContact::subtract_excess_velocities()
{
  const auto subtract = [this](int i, const Eigen::Vector3d &mean) {
    double *v = atom->v[i];
    for (int d = 0; d < 3; d++) {
      const double excess = v[d] - mean[d];
      excess_velocities[d][i] += excess;
      v[d] -= excess;
    }
  };
  for (const int i : step_start.moved)
    subtract(i, (Eigen::Vector3d(atom->x[i]) - step_start.origin_of(i)) / update->dt);
  for (FixPBDCloth *cloth : cloths)
    for (int i = 0; i < atom->nlocal; i++)
      if (cloth->has_vertex(i)) subtract(i, cloth->mean_velocity(i));
}

void FixClothContact::post_force(int)
{
  if (excess_velocities.empty()) return;
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) {
      atom->v[i][d] += excess_velocities[d][i];
      excess_velocities[d][i] = 0.0;
    }
}

void FixClothContact::pre_reverse(int, int)
{
  for (const auto &obstacle : obstacles)
    for (int i = 0; i < atom->nlocal; i++)
      if (obstacle->has_vertex(i))
        for (int d = 0; d < 3; d++) atom->f[i][d] += impulses.force(d, i, force->ftm2v);
}

/* ----------------------------------------------------------------------
   output: contacts, stops, frozen, deepest, impulse on held vertices (x, y, z), force on obstacles
   (x, y, z), wall time; of cloth on cloth: contacts, stops, frozen, smallest distance
------------------------------------------------------------------------- */

double FixClothContact::compute_vector(int n)
{
  double mine[15] = {counts.contacts,   counts.stops,      counts.frozen,    counts.deepest,
                     counts.impulse[0], counts.impulse[1], counts.impulse[2]};
  double all;
  mine[10] = counts.seconds;
  mine[11] = counts.cloth_contacts;
  mine[12] = counts.cloth_stops;
  mine[13] = counts.cloth_frozen;
  mine[14] = counts.cloth_gap;
  if (n >= 7 && n < 10 && !impulses.empty())
    for (int i = 0; i < atom->nlocal; i++) mine[n] += impulses.force(n - 7, i, force->ftm2v);
  MPI_Op op = MPI_SUM;
  if (n == 3 || n == 10) op = MPI_MAX;
  if (n == 14) op = MPI_MIN;
  MPI_Allreduce(&mine[n], &all, 1, MPI_DOUBLE, op, world);
  return all;
}

int FixClothContact::pack_forward_comm(int n, int *sendlist, double *buf, int, int *)
{
  for (int k = 0; k < n; k++) {
    *buf++ = side[sendlist[k]];
    buf = std::copy_n(sheet_layers.nearest(sendlist[k]).data(), 3, buf);
  }
  return 4 * n;
}

void FixClothContact::unpack_forward_comm(int n, int first, double *buf)
{
  for (int k = first; k < first + n; k++, buf += 4) {
    side[k] = static_cast<sphcloth::Sides>(buf[0]);
    sheet_layers.set_nearest(k, Eigen::Map<const Eigen::Vector3d>(buf + 1));
  }
}

void FixClothContact::set_arrays(int i)
{
  for (ParticleColumns *each : columns()) each->clear(i);
  step_start.positions.unpack(i, atom->x[i]);
}

int FixClothContact::pack_exchange(int i, double *buf)
{
  double *end = buf;
  for (const ParticleColumns *each : columns()) end = each->pack(i, end);
  return static_cast<int>(end - buf);
}

int FixClothContact::unpack_exchange(int i, double *buf)
{
  const double *from = buf;
  for (ParticleColumns *each : columns()) {
    each->unpack(i, from);
    from += each->count();
  }
  return static_cast<int>(from - buf);
}

// only the impulses on obstacles; the first value of a restart record is its length

int FixClothContact::pack_restart(int i, double *buf)
{
  buf[0] = 1 + impulses.count();
  impulses.pack(i, buf + 1);
  return 1 + impulses.count();
}

void FixClothContact::unpack_restart(int i, int nth)
{
  const double *record = atom->extra[i];
  for (int k = 0; k < nth; k++) record += static_cast<int>(*record);
  if (static_cast<int>(*record) != 1 + impulses.count())
    error->one(FLERR,
               "{}: its record in the restart file is damaged, or of another release of sphcloth: "
               "take another file, or give the fix another ID to begin anew",
               label);
  impulses.unpack(i, record + 1);
}

double FixClothContact::memory_usage()
{
  double bytes = sheet_layers.bytes() + step_start.bytes();
  for (const ParticleColumns *each : columns()) bytes += each->bytes();
  for_all_surfaces([&bytes](const ContactSurface &surface) { bytes += surface.memory_usage(); });
  for (const MeshContact *contact : contacts) bytes += contact->memory_usage();
  if (joined) bytes += joined->triangles.memory_usage() + joined->coupling.memory_usage();
  return bytes;
}
