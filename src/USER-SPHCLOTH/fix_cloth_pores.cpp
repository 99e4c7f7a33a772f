// SPDX-License-Identifier: GPL-2.0-or-later
// Drag in pores: particles have moved in a step when it slows them, before the cloth follows.

#include "fix_cloth_pores.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix_cloth_contact.h"
#include "fix_pbd_cloth.h"
#include "force.h"
#include "group.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/restart_record.h"
#include "modify.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FixConst;

/* ----------------------------------------------------------------------
   fix ID group cloth/pores types keyword value ...
------------------------------------------------------------------------- */

FixClothPores::FixClothPores(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} cloth/pores", id)), options(lmp, label)
{
  vector_flag = 1;
  size_vector = 7;
  global_freq = 1;
  extvector = 1;
  restart_peratom = restart_global = 1;
  create_attribute = 1;
  dynamic_group_allow = 1;

  ArgReader args(lmp, label, narg, arg, 3);
  options.read(args);
  state.create(N_COLUMNS, atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
}

FixClothPores::~FixClothPores()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
}

int FixClothPores::setmask() { return INITIAL_INTEGRATE | POST_INTEGRATE | POST_NEIGHBOR; }

void FixClothPores::init()
{
  const FluidState *found = FluidState::find(force);
  if (!found)
    error->all(FLERR, "{}: pores let fluid through, and there is none: use 'pair_style sph/tait'",
               label);
  fluid = options.of(found, groupbit);
  check_integrators();
  find_meshes();
}

// Several fixes may guard a mesh, each with an obstacle of its own.

bool FixClothPores::is_known(const ClothTopology &mesh) const
{
  return std::any_of(meshes.begin(), meshes.end(), [&](const auto &known) {
    const ClothTopology &of = known->pores.set->mesh->topology();
    return of.ids == mesh.ids && of.triangles.vertices == mesh.triangles.vertices;
  });
}

void FixClothPores::find_meshes()
{
  double widest = 0.0;
  for (int t = 1; t <= atom->ntypes; t++)
    if (fluid.state->is_fluid(t)) widest = std::max(widest, fluid.width(t));
  meshes.clear();
  bool any_contact = false;
  for (Fix *each : modify->get_fix_list()) {
    if (each == this) break;
    auto *contact = dynamic_cast<FixClothContact *>(each);
    if (!contact) continue;
    any_contact = true;
    for (MovingTriangles *set :
         contact->let_through(fluid.first_type, fluid.last_type, groupbit, widest)) {
      if (is_known(set->mesh->topology())) continue;
      meshes.push_back(std::make_unique<Mesh>(Mesh{PoreMesh(lmp, set, fluid), nullptr}));
      auto *cloth = dynamic_cast<FixPBDCloth *>(set->mesh);
      if (!cloth) continue;
      meshes.back()->rows = std::make_unique<PoreRows>(lmp, meshes.back()->pores);
      cloth->register_first_coupling(meshes.back()->rows.get());
    }
  }
  if (!any_contact)
    error->all(FLERR,
               "{}: there is no fix cloth/contact before it, and all of a sheet lets fluid "
               "through: define 'fix ID group cloth/contact' before",
               label);
  if (meshes.empty())
    error->all(
        FLERR,
        "{}: no triangle of a mesh that a fix cloth/contact guards has the type {}: triangles "
        "are LAMMPS angles; give 'triangle' in create_cloth, or 'set group ID angle TYPE'",
        label, options.types());
}

// Particles must have moved when the drag slows them.

void FixClothPores::check_integrators()
{
  bool behind = false;
  for (Fix *each : modify->get_fix_list()) {
    behind = behind || each == this;
    if (behind && each->time_integrate && share_atoms(atom, groupbit, each->groupbit, world))
      error->all(FLERR,
                 "{}: fix {} {} moves its particles and is defined after it: define it before",
                 label, each->id, each->style);
  }
}

void FixClothPores::post_neighbor()
{
  for (auto &mesh : meshes) {
    mesh->pores.rebuild();
    if (mesh->rows) mesh->rows->rebuild();
  }
}

/* ----------------------------------------------------------------------
   one step
------------------------------------------------------------------------- */

void FixClothPores::initial_integrate(int)
{
  impulse.setZero();
  for (auto &mesh : meshes) mesh->pores.find(state[FLOW]);
  count_passages();
  for (auto &mesh : meshes)
    if (!mesh->rows) impulse += mesh->pores.slow_down(counts.lost);
}

// The cloths have been solved.

void FixClothPores::post_integrate()
{
  for (auto &mesh : meshes)
    if (mesh->rows) mesh->rows->take(impulse, counts.lost);
  last_dt = update->dt;
}

// Where several meshes are near, the last one counts.

void FixClothPores::count_passages()
{
  double *const now = state[SIDE];
  side_before.assign(now, now + atom->nlocal);
  std::fill(now, now + atom->nlocal, 0.0);
  for (const auto &mesh : meshes) mesh->pores.for_sides([&](int i, int on) { now[i] = on; });
  for (int i = 0; i < atom->nlocal; i++) {
    if (now[i] * side_before[i] >= 0.0) continue;
    (now[i] > 0.0 ? counts.up : counts.down) += 1.0;
    counts.volume += now[i] * atom_mass(atom, i) / fluid.density(atom->type[i]);
  }
}

/* ----------------------------------------------------------------------
   output: force of the fluid on the meshes (x, y, z); particles that went through upward and
   downward, volume of these, energy lost
------------------------------------------------------------------------- */

double FixClothPores::compute_vector(int n)
{
  const double per_time = last_dt > 0.0 ? 1.0 / last_dt : 0.0;
  const double of_counts[] = {counts.up, counts.down, counts.volume, counts.lost * force->mvv2e};
  double mine = n < 3 ? impulse[n] * per_time / force->ftm2v : of_counts[n - 3], all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

/* ----------------------------------------------------------------------
   what is kept
------------------------------------------------------------------------- */

int FixClothPores::pack_exchange(int i, double *buf)
{
  return static_cast<int>(state.pack(i, buf) - buf);
}

int FixClothPores::unpack_exchange(int i, double *buf)
{
  state.unpack(i, buf);
  return N_COLUMNS;
}

// the first value of a restart record is its length

int FixClothPores::pack_restart(int i, double *buf)
{
  buf[0] = 1 + N_COLUMNS;
  state.pack(i, buf + 1);
  return 1 + N_COLUMNS;
}

void FixClothPores::unpack_restart(int i, int nth)
{
  const double *record = atom->extra[i];
  for (int k = 0; k < nth; k++) record += static_cast<int>(*record);
  state.unpack(i, record + 1);
}

struct FixClothPores::Record {
  double last_dt;
  Counts counts;
};

void FixClothPores::write_restart(FILE *fp)
{
  const double mine[] = {counts.up, counts.down, counts.volume, counts.lost};
  double all[4];
  MPI_Allreduce(mine, all, 4, MPI_DOUBLE, MPI_SUM, world);
  if (comm->me == 0) write_record(fp, Record{last_dt, {all[0], all[1], all[2], all[3]}});
}

void FixClothPores::restart(char *buf)
{
  const auto record = read_record<Record>(buf, label, error);
  last_dt = record.last_dt;
  if (comm->me == 0) counts = record.counts;
  keep_restored_time(update);
}

double FixClothPores::memory_usage()
{
  double bytes = state.bytes() + sphcloth::bytes_of(side_before);
  for (const auto &mesh : meshes)
    bytes += mesh->pores.bytes() + (mesh->rows ? mesh->rows->bytes() : 0.0);
  return bytes;
}
