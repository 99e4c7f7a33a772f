// SPDX-License-Identifier: GPL-2.0-or-later
// Forces of the air on cloth: they are added to the others at the start of a step, whose length is
// known then, before fix pbd/cloth takes them up.

#include "fix_cloth_air.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix_pbd_cloth.h"
#include "force.h"
#include "group.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/restart_record.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;

/* ----------------------------------------------------------------------
   fix ID group cloth/air keyword value ...
------------------------------------------------------------------------- */

FixClothAir::FixClothAir(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} cloth/air", id)), options(lmp, label),
    water(lmp), shade(lmp, motion, SEEN)
{
  vector_flag = 1;
  size_vector = 6;
  global_freq = 1;
  extvector = 1;
  restart_peratom = restart_global = 1;
  create_attribute = 1;

  ArgReader args(lmp, label, narg, arg, 3);
  options.read(args);
  velocities.create(atom->nmax);
  motion.create(options.shaded ? N_COLUMNS : SEEN, atom->nmax);
  for (int i = 0; i < atom->nlocal; i++) FixClothAir::set_arrays(i);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
}

FixClothAir::~FixClothAir()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
}

int FixClothAir::setmask()
{
  return INITIAL_INTEGRATE | POST_INTEGRATE | POST_NEIGHBOR | POST_FORCE | POST_RUN;
}

void FixClothAir::init()
{
  velocities.begin_run(atom, [this](int i) { forget_motion(i); });
  options.wind.check();
  water.init();
  cloths.clear();
  std::vector<tagint> mine;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) mine.push_back(atom->tag[i]);
  std::vector<tagint> in_group = allgather(mine, comm->nprocs, world);
  std::sort(in_group.begin(), in_group.end());
  for (FixPBDCloth *cloth : cloths_before(lmp, this, label)) {
    auto mesh = std::make_unique<AirMesh>(lmp, cloth, in_group);
    if (!mesh->empty()) cloths.push_back({cloth, std::move(mesh), nullptr, {}});
  }
  refuse_vertices_of_others();
  if (cloths.empty())
    error->all(
        FLERR,
        "{}: group {} holds no triangle of a cloth: give the group of a fix pbd/cloth that is "
        "defined before, whose cloth has triangles (create_cloth makes them)",
        label, group->names[igroup]);
  if (options.added_thickness == 0.0) return;
  for (Cloth &cloth : cloths) {
    cloth.added = std::make_unique<AddedMass>(lmp, cloth.mesh.get(),
                                              options.drag.density * options.added_thickness);
    cloth.fix->register_first_coupling(cloth.added.get());
  }
}

// Each would take the push of the other for something that goes on in the next step.

void FixClothAir::refuse_vertices_of_others()
{
  for (Fix *fix : modify->get_fix_list()) {
    if (fix == this || !dynamic_cast<FixClothAir *>(fix)) continue;
    int mine = 0, any = 0;
    for (const Cloth &cloth : cloths)
      for (int i = 0; i < atom->nlocal; i++)
        if (cloth.fix->has_vertex(i) && atom->mask[i] & groupbit && atom->mask[i] & fix->groupbit)
          mine = 1;
    MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
    if (any)
      error->all(FLERR,
                 "{}: group {} has vertices of fix {} cloth/air, too: give each vertex one fix "
                 "cloth/air",
                 label, group->names[igroup], fix->id);
  }
}

void FixClothAir::post_neighbor()
{
  for (Cloth &cloth : cloths) {
    cloth.mesh->rebuild();
    if (cloth.added) cloth.added->rebuild();
  }
  shade.lists_have_changed();
}

// Wind and water of the time of the positions: at the start of the next step some have moved.

void FixClothAir::post_force(int)
{
  options.wind.find(igroup);
  for (Cloth &cloth : cloths) water.find(*cloth.mesh);
}

/* ----------------------------------------------------------------------
   one step
------------------------------------------------------------------------- */

void FixClothAir::initial_integrate(int)
{
  impulse.setZero();
  area = 0.0;
  for (Cloth &cloth : cloths) load(cloth);
  if (options.shaded) find_shade();
  for (Cloth &cloth : cloths) {
    area += cloth.mesh->add_loads(options.drag, update->dt);
    if (cloth.added) cloth.added->find_shares();
    apply(cloth);
  }
  last_dt = update->dt;
  velocities.begin_step();
  options.wind.carry(update->dt);
}

// Velocities are means over the last step, which is what moves the vertices: those of atoms are of
// its last substep, with impulses that forces gave ahead.  The first step begins with these; a held
// vertex, which other fixes move at any time in a step, has no other.  The first step may be half a
// one: it tells no gain, and the forces do in the second, too.

void FixClothAir::load(Cloth &cloth)
{
  AirMesh &mesh = *cloth.mesh;
  const VertexHalo &halo = mesh.halo;
  const double dt = update->dt, by = last_dt > 0.0 ? dt / last_dt : 1.0;
  cloth.velocity.resize(halo.n_owned());
  std::fill(mesh.v.begin(), mesh.v.end(), Vec3::Zero());
  options.wind.add_to(halo, mesh.v);
  if (options.shaded) mesh.wind = mesh.v;
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    const double w = dt * force->ftm2v * cloth.fix->inverse_mass(i);
    const bool first = std::isnan(motion[VELOCITY][i]);
    mesh.x[s] = Vec3(atom->x[i]);
    cloth.velocity[s] = first || w == 0.0 ? Vec3(atom->v[i]) : kept(VELOCITY, i);
    mesh.v[s] = cloth.velocity[s] - mesh.v[s];
    mesh.gain[s] = std::isnan(motion[GAIN][i]) ? Vec3(w * Vec3(atom->f[i]))
                                               : Vec3(by * kept(GAIN, i));
  }
  mesh.forward_motion();
}

void FixClothAir::find_shade()
{
  std::vector<AirMesh *> meshes;
  for (const Cloth &cloth : cloths) meshes.push_back(cloth.mesh.get());
  shade.find(meshes);
}

void FixClothAir::apply(const Cloth &cloth)
{
  const AirMesh &mesh = *cloth.mesh;
  const double by = 1.0 / (update->dt * force->ftm2v);
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    const int i = mesh.halo.atom_of(s);
    impulse += mesh.impulse[s];
    if (cloth.fix->is_attached(i)) continue;
    for (int d = 0; d < 3; d++) atom->f[i][d] += by * mesh.impulse[s][d];
  }
}

void FixClothAir::post_integrate()
{
  step_work = 0.0;
  for (const Cloth &cloth : cloths) end_step(cloth);
  work += step_work;
}

// The cloth has moved.  Forces on bodies have acted: what the air gives to attached vertices goes
// to their bodies with the pull of the cloth.

void FixClothAir::end_step(const Cloth &cloth)
{
  const AirMesh &mesh = *cloth.mesh;
  for (int s = 0; s < mesh.halo.n_owned(); s++) {
    const int i = mesh.halo.atom_of(s);
    const Vec3 &j = mesh.impulse[s], &before = cloth.velocity[s];
    const Vec3 of_added = cloth.added ? cloth.added->impulse_on_mesh(s) : Vec3::Zero();
    const double w = cloth.fix->inverse_mass(i);
    const Vec3 v = cloth.fix->mean_velocity(i);
    const bool first = std::isnan(motion[VELOCITY][i]);
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    const Vec3 gain = first || w == 0.0 ? Vec3::Constant(unknown) : Vec3(v - before - w * j);
    impulse += of_added;
    step_work += 0.5 * (j + of_added).dot(before + v);
    for (int d = 0; d < 3; d++) {
      motion[VELOCITY + d][i] = v[d];
      motion[GAIN + d][i] = gain[d];
    }
    if (cloth.fix->is_attached(i)) cloth.fix->push_held(i, j);
  }
}

/* ----------------------------------------------------------------------
   output: force of the air on the cloth (x, y, z), its power, its work, area that takes air
------------------------------------------------------------------------- */

double FixClothAir::compute_vector(int n)
{
  const double per_time = last_dt > 0.0 ? 1.0 / last_dt : 0.0;
  double mine = area, all;
  if (n < 3) mine = impulse[n] * per_time / force->ftm2v;
  if (n == 3) mine = step_work * per_time * force->mvv2e;
  if (n == 4) mine = work * force->mvv2e;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

/* ----------------------------------------------------------------------
   what is kept
------------------------------------------------------------------------- */

void FixClothAir::grow_arrays(int nmax)
{
  velocities.fingerprints.grow(nmax);
  motion.grow(nmax);
}

void FixClothAir::copy_arrays(int i, int j, int)
{
  velocities.fingerprints.copy(i, j);
  motion.copy(i, j);
}

void FixClothAir::set_arrays(int i)
{
  velocities.forget(i);
  for (int k = 0; k < motion.count(); k++) motion[k][i] = std::numeric_limits<double>::quiet_NaN();
}

// A vertex that got another velocity begins with it as in a first step.

void FixClothAir::forget_motion(int i)
{
  for (int k = 0; k < SEEN; k++) motion[k][i] = std::numeric_limits<double>::quiet_NaN();
}

int FixClothAir::pack_exchange(int i, double *buf)
{
  return static_cast<int>(motion.pack(i, velocities.fingerprints.pack(i, buf)) - buf);
}

int FixClothAir::unpack_exchange(int i, double *buf)
{
  velocities.fingerprints.unpack(i, buf);
  motion.unpack(i, buf + 1);
  return 1 + motion.count();
}

// The first value of a restart record is its length.

int FixClothAir::pack_restart(int i, double *buf)
{
  buf[0] = size_restart(i);
  motion.pack(i, velocities.pack_restart(atom, i, buf + 1));
  return size_restart(i);
}

void FixClothAir::unpack_restart(int i, int nth)
{
  const double *record = atom->extra[i];
  for (int k = 0; k < nth; k++) record += static_cast<int>(*record);
  // the lee may have been found before, and not be asked for now, or the other way round
  const int n = std::min(static_cast<int>(*record) - 2, motion.count());
  velocities.fingerprints.unpack(i, record + 1);
  for (int k = 0; k < n; k++) motion[k][i] = record[2 + k];
}

struct FixClothAir::Record {
  double last_dt, work, carried[3], lee_of[3];
};

void FixClothAir::write_restart(FILE *fp)
{
  double all;
  MPI_Allreduce(&work, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  Record record{last_dt, all, {}, {}};
  for (int d = 0; d < 3; d++) {
    record.carried[d] = options.wind.carried[d];
    record.lee_of[d] = shade.direction()[d];
  }
  if (comm->me == 0) write_record(fp, record);
}

void FixClothAir::restart(char *buf)
{
  const auto record = read_record<Record>(buf, label, error);
  last_dt = record.last_dt;
  work = comm->me == 0 ? record.work : 0.0;
  options.wind.carried = Vec3(record.carried[0], record.carried[1], record.carried[2]);
  shade.restore(Vec3(record.lee_of[0], record.lee_of[1], record.lee_of[2]));
  keep_restored_time(update);
}

double FixClothAir::memory_usage()
{
  double bytes = velocities.fingerprints.bytes() + motion.bytes() + options.wind.bytes() +
      water.bytes() + shade.bytes();
  for (const Cloth &cloth : cloths)
    bytes += cloth.mesh->bytes() + (cloth.added ? cloth.added->bytes() : 0.0) +
        sphcloth::bytes_of(cloth.velocity);
  return bytes;
}
