// SPDX-License-Identifier: GPL-2.0-or-later
// Position-based dynamics of cloth: (4) to (9) and lines 19 to 29 of Algorithm 1.  The sweeps over
// constraints are in cloth/substepping.cpp.

#include "fix_pbd_cloth.h"

#include "atom.h"
#include "bond.h"
#include "cloth/cloth_input.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/rank_error.h"
#include "lammps_util/restart_record.h"
#include "modify.h"
#include "stepping/stepping_scheme.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace sphcloth;

/* ----------------------------------------------------------------------
   fix ID group pbd/cloth keyword value ...
------------------------------------------------------------------------- */

FixPBDCloth::FixPBDCloth(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} pbd/cloth", id)), options(lmp, label, igroup),
    held(lmp, this, options), mesh(lmp, label), ghosts(lmp, label), constraints(lmp, label, mesh),
    reference(lmp, label, options.reference, constraints), vertices(lmp), lists_of_atoms(lmp),
    holders(lmp, vertices),
    substepping(lmp, label, options.solving, constraints, vertices, velocities),
    scaled(lmp, vertices), holder_force{}, measured(true), last_residual(0.0), last_energy(0.0),
    last_unconverged(0.0)
{
  time_integrate = 1;
  restart_peratom = 1;
  restart_global = 1;
  create_attribute = 1;
  vector_flag = 1;
  size_vector = 11;
  global_freq = 1;
  extvector = 0;

  if (atom->molecular != Atom::MOLECULAR || !atom->num_bond)
    error->all(FLERR,
               "{}: atom_style {} has no bonds: use atom_style molecular, or hybrid sph molecular",
               label, atom->atom_style);
  if (group->count(igroup) == 0)
    error->all(FLERR, "{}: group {} has no atoms: create the cloth before this fix", label,
               group->names[igroup]);

  rest_box = RestBox::of(domain);
  rest_x.create(3, atom->nmax);
  velocities.create(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++) {
    double unwrapped[3];
    domain->unmap(atom->x[i], atom->image[i], unwrapped);
    rest_x.unpack(i, unwrapped);
  }

  ArgReader args(lmp, label, narg, arg, 3);
  options.read(args);
  if (!options.rest_property.empty())
    ClothInput(lmp, this, label).read_rest_positions(options.rest_property, rest_x);
  if (options.attachbit) want_reaction_forces();
  if (substepping.uses(ClothSolver::SUBSTEPS)) half_kick.turn_on(atom->nmax);
  held.stop_pins();
}

FixPBDCloth::~FixPBDCloth()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
}

FixPBDCloth *FixPBDCloth::find(LAMMPS *lmp, const std::string &asking, const std::string &id)
{
  auto *fix = dynamic_cast<FixPBDCloth *>(lmp->modify->get_fix_by_id(id));
  if (!fix)
    lmp->error->all(FLERR, "{}: there is no fix pbd/cloth with the ID '{}': define it before",
                    asking, id);
  return fix;
}

std::vector<FixPBDCloth *> LAMMPS_NS::cloths_before(LAMMPS *lmp, const Fix *fix,
                                                    const std::string &asking)
{
  std::vector<FixPBDCloth *> cloths;
  bool behind = false;
  for (Fix *each : lmp->modify->get_fix_list()) {
    behind = behind || each == fix;
    auto *cloth = dynamic_cast<FixPBDCloth *>(each);
    if (!cloth) continue;
    if (behind)
      lmp->error->all(FLERR, "{}: fix {} pbd/cloth is defined after it: define it before", asking,
                      cloth->id);
    cloths.push_back(cloth);
  }
  return cloths;
}

int FixPBDCloth::setmask()
{
  return POST_INTEGRATE | PRE_EXCHANGE | MIN_PRE_EXCHANGE | POST_NEIGHBOR | MIN_POST_NEIGHBOR |
      END_OF_STEP | POST_RUN | (options.attachbit ? PRE_REVERSE : 0);
}

/* ----------------------------------------------------------------------
   the mesh and what follows from it
------------------------------------------------------------------------- */

void FixPBDCloth::init()
{
  lists_of_atoms.initialized();
  velocities.begin_run(atom, [this](int i) {
    if (half_kick.on()) half_kick.forget(i);
  });
  couplings = {&scaled};
  solved_here = {this};
  scaled.init();
  const ClothInput made_of(lmp, this, label);
  made_of.check_vertices();
  options.check_groups();
  held.stop_pins();
  mesh.gather(groupbit);
  if (!mesh.edges.size())
    error->all(FLERR, "{}: group {} has no bonds: create the cloth with create_cloth or read_data",
               label, group->names[igroup]);
  made_of.check_styles();
  if (ghosts.matters()) {
    mesh.measure();
    ghosts.require(mesh.widest_element(), mesh.widest_element());
  }
  constraints.measure_rest(groupbit, rest_x, rest_box);
  const Substepping::Options &solving = options.solving;
  constraints.color(solving.symmetric_sweeps ? 2 * solving.iterations : solving.iterations,
                    substepping.uses(ClothSolver::JACOBI));
}

// the fix that integrates the fluid knows its scheme since its init()

void FixPBDCloth::setup_post_neighbor()
{
  SteppingScheme scheme = SteppingScheme::CONSTANT;
  for (Fix *fix : modify->get_fix_by_style("^sph/integrate$"))
    if (const auto *integrates = dynamic_cast<HasSteppingScheme *>(fix))
      scheme = integrates->stepping_scheme();
  reference.set_steps_vary(scheme != SteppingScheme::CONSTANT);
  post_neighbor();
}

/* ----------------------------------------------------------------------
   this rank's vertices and constraints, after each list build
------------------------------------------------------------------------- */

void FixPBDCloth::pre_exchange()
{
  require_inside_box(lmp, label, groupbit);
  if (!ghosts.matters()) return;
  vertices.halo.forward_positions(ClothConstraints::ALL, vertices.p.data());
  constraints.check_lengths(vertices);
  mesh.measure();
  ghosts.require_in_run(mesh.widest_element(), mesh.widest_element());
}

void FixPBDCloth::post_neighbor()
{
  if (!measured) measure();    // while the vertices of the last step are there
  std::vector<int> owned;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) owned.push_back(i);
  VertexHalo &halo = vertices.halo;
  halo.reset(constraints.n_channels(), owned);
  constraints.collect(halo);
  halo.connect();
  lists_of_atoms.lists_are_new();

  std::vector<double> w(halo.n_slots());
  vertices.attached.clear();
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    w[s] = held.inverse_mass_in_solver(i);
    if (held.is_attached(i)) vertices.attached.push_back(s);
  }
  halo.forward(ClothConstraints::ALL, w);
  vertices.reset(w, substepping.uses(ClothSolver::JACOBI));
  constraints.distance.weigh(vertices.p.data());
  constraints.bending.weigh(vertices.p.data());
  substepping.measure_compliances();
}

/* ----------------------------------------------------------------------
   one step: lines 19 to 29 of Algorithm 1
------------------------------------------------------------------------- */

void FixPBDCloth::post_integrate()
{
  if (solved_here.empty()) return;
  int substeps = 1;
  for (FixPBDCloth *cloth : solved_here)
    substeps = std::max(substeps, cloth->substepping.wanted_substeps(update->dt));
  std::vector<Substepping *> solvers;
  for (FixPBDCloth *cloth : solved_here) {
    cloth->begin_step(substeps);
    solvers.push_back(&cloth->substepping);
  }
  for (int n = 0; n < substeps; n++) Substepping::substep(n, solvers);
  for (FixPBDCloth *cloth : solved_here) cloth->end_step();
  for (FixPBDCloth *cloth : solved_here)
    if (cloth->scaled.on()) cloth->scaled.move_fluid();
}

void FixPBDCloth::begin_step(int substeps)
{
  lists_of_atoms.check(label);
  if (!(update->dt > 0.0))
    error->all(FLERR, "{}: the time step is {}: it must be above 0: give 'timestep DT'", label,
               update->dt);
  velocities.begin_step();
  held.move_pins(vertices.halo);
  substepping.begin_step(update->dt, substeps, present, holders);
  if (scaled.on())
    scaled.scale_forces(update->dt, [this](int s) { return substepping.part_with_forces(s); });
  if (half_kick.on()) half_kick.apply(vertices, substeps, update->dt, force->ftm2v, atom);
  load();
  if (holders.wanted()) holders.begin_step();
  begin_couplings();
  reference.rescale(substepping.usual_substeps(), substepping.substep_dt());
}

void FixPBDCloth::end_step()
{
  if (holders.wanted()) holders.end_step();
  store();
  for (SolverCoupling *coupling : present) coupling->end_step();
  measured = false;
  substepping.end_step();
}

void FixPBDCloth::solve_together(const std::vector<FixPBDCloth *> &cloths)
{
  FixPBDCloth *first = cloths.front();
  const Substepping::Options &one = first->options.solving;
  for (FixPBDCloth *cloth : cloths) {
    const Substepping::Options &other = cloth->options.solving;
    if (one.solver != other.solver || one.iterations != other.iterations ||
        one.strain != other.strain)
      cloth->error->all(
          FLERR,
          "{}: solver, iterations or strain differ from those of {}, and the two may meet: "
          "give both the same, or put the cloths into one fix",
          cloth->label, first->label);
    cloth->solved_here.clear();
  }
  first->solved_here = cloths;
}

void FixPBDCloth::begin_couplings()
{
  present.clear();
  const double dt = update->dt;
  Vertices &p = vertices.p;
  const Vertices &start = vertices.start, &v = vertices.v;
  for (int s = 0; s < vertices.halo.n_owned(); s++) {
    const double *f = atom->f[vertices.halo.atom_of(s)];
    const double by = dt * force->ftm2v * vertices.inverse_mass[s];
    p[s].x = start[s].x + dt * (v[s].x + by * f[0]);
    p[s].y = start[s].y + dt * (v[s].y + by * f[1]);
    p[s].z = start[s].z + dt * (v[s].z + by * f[2]);
  }
  for (SolverCoupling *coupling : couplings)
    if (coupling->begin_step(start.data(), p.data(), dt)) present.push_back(coupling);
}

// A held vertex is on its way from where its velocity says that it was to where it is.

void FixPBDCloth::load()
{
  for (int s = 0; s < vertices.halo.n_owned(); s++) {
    const int i = vertices.halo.atom_of(s);
    const double *x = atom->x[i], *u = atom->v[i], w = vertices.p[s].w;
    const double back = vertices.inverse_mass[s] == 0.0 ? update->dt : 0.0;
    vertices.start[s] = {x[0] - back * u[0], x[1] - back * u[1], x[2] - back * u[2], w};
    vertices.v[s] = {u[0], u[1], u[2], w};
  }
  vertices.note_step_start();
  for (int s : vertices.attached) holders.load_attached(s);
  vertices.halo.forward_positions(ClothConstraints::ALL, vertices.start.data(), update->dt);
}

// What the free vertices gained beyond the external forces came from those that are held.

void FixPBDCloth::store()
{
  Vec3 gained = Vec3::Zero(), external = Vec3::Zero(), from_couplings = Vec3::Zero();
  for (int s = 0; s < vertices.halo.n_owned(); s++) {
    const int i = vertices.halo.atom_of(s);
    const Vertex &p = vertices.p[s], &v = vertices.v[s];
    velocities.note_step(i);
    if (!held.is_attached(i)) {
      external += Vec3(atom->f[i][0], atom->f[i][1], atom->f[i][2]);
      for (const SolverCoupling *coupling : present) {
        from_couplings += coupling->impulse_on(s);
        if (p.w == 0.0) push_held(i, coupling->impulse_on(s));
      }
    }
    if (vertices.inverse_mass[s] == 0.0) continue;
    const double velocity[3] = {v.x, v.y, v.z}, position[3] = {p.x, p.y, p.z};
    for (int d = 0; d < 3; d++) {
      gained[d] += (velocity[d] - atom->v[i][d]) / p.w;
      atom->v[i][d] = velocity[d];
      atom->x[i][d] = position[d];
    }
  }
  const Vec3 from_holders = (gained - from_couplings) / (update->dt * force->ftm2v) - external;
  if (!std::isfinite(from_holders.sum()))
    rank_error(lmp, FLERR,
               "{}: the cloth flew apart in step {}: hinges may contradict each other or have no "
               "stiff edges, or the time step is too large",
               label, update->ntimestep);
  for (int d = 0; d < 3; d++) holder_force[d] = from_holders[d];
}

/* ----------------------------------------------------------------------
   forces between the cloth and the holders of its vertices
------------------------------------------------------------------------- */

void FixPBDCloth::pre_reverse(int, int)
{
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit && held.is_attached(i)) {
      const Vec3 force_on = holders.force_on_holder(i);
      for (int d = 0; d < 3; d++) atom->f[i][d] += force_on[d];
    }
}

Eigen::Vector3d FixPBDCloth::reaction_force(int i) const
{
  return held.is_held(i) ? Vec3(-holders.force_on_holder(i)) : Vec3::Zero();
}

/* ----------------------------------------------------------------------
   output: force of the holders on the cloth (x, y, z), largest edge strain, residual, sweeps,
   elastic energy, momentum that the half-kick correction has given ahead (x, y, z), strain that the
   solver has left
------------------------------------------------------------------------- */

double FixPBDCloth::compute_vector(int n)
{
  if (n == 5) return substepping.sweeps_of_last_step();
  if ((n == 4 || n == 6 || n == 10) && !measured) measure();
  double mine = 0.0, all;
  if (n < 3) mine = holder_force[n];
  if (n == 3) mine = constraints.largest_strain(vertices.halo, options.heldbits());
  if (n == 4) mine = last_residual;
  if (n == 6) mine = last_energy;
  if (n > 6 && n < 10) mine = half_kick.sum(vertices, n - 7);
  if (n == 10) mine = last_unconverged;
  const bool is_largest = n == 3 || n == 4 || n == 10;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, is_largest ? MPI_MAX : MPI_SUM, world);
  return all;
}

// residual, energy and strain left of the last step, once and only if they are asked for or the
// lists change

void FixPBDCloth::measure()
{
  measured = true;
  last_residual = substepping.residual();
  last_energy = substepping.energy();
  last_unconverged = substepping.unconverged();
}

/* ----------------------------------------------------------------------
   rest positions, and what else is kept of a vertex, travel with it
------------------------------------------------------------------------- */

// n of them, in the order of restart records; null: not kept in this run

ParticleColumns *FixPBDCloth::kept(int n)
{
  ParticleColumns *const all[] = {&rest_x, &velocities.fingerprints, &holders.columns,
                                  &half_kick.impulse};
  return all[n]->empty() ? nullptr : all[n];
}

void FixPBDCloth::grow_arrays(int nmax)
{
  for (int n = 0; n < N_KEPT; n++)
    if (ParticleColumns *columns = kept(n)) columns->grow(nmax);
}

void FixPBDCloth::copy_arrays(int i, int j, int)
{
  for (int n = 0; n < N_KEPT; n++)
    if (ParticleColumns *columns = kept(n)) columns->copy(i, j);
}

void FixPBDCloth::set_arrays(int i)
{
  for (int d = 0; d < 3; d++) rest_x[d][i] = std::numeric_limits<double>::quiet_NaN();
  velocities.forget(i);
  if (holders.wanted()) holders.columns.clear(i);
  if (half_kick.on()) half_kick.forget(i);
}

int FixPBDCloth::pack_exchange(int i, double *buf)
{
  double *end = buf;
  for (int n = 0; n < N_KEPT; n++)
    if (ParticleColumns *columns = kept(n)) end = columns->pack(i, end);
  return static_cast<int>(end - buf);
}

int FixPBDCloth::unpack_exchange(int i, double *buf)
{
  const double *from = buf;
  for (int n = 0; n < N_KEPT; n++)
    if (ParticleColumns *columns = kept(n)) {
      columns->unpack(i, from);
      from += columns->count();
    }
  return static_cast<int>(from - buf);
}

// the first value of a restart record is its length

int FixPBDCloth::pack_restart(int i, double *buf)
{
  buf[0] = 1 + pack_exchange(i, buf + 1);
  velocities.pack_restart(atom, i, buf + 1 + rest_x.count());
  return static_cast<int>(buf[0]);
}

// It may have been written with another solver, or without forces of holders.

void FixPBDCloth::unpack_restart(int i, int nth)
{
  constexpr int ALWAYS = 4, HOLDERS = HolderForces::N_COLUMNS;
  const double *record = atom->extra[i];
  for (int k = 0; k < nth; k++) record += static_cast<int>(*record);
  const int size = static_cast<int>(*record) - 1;
  const bool has_holders = size >= ALWAYS + HOLDERS;
  const bool has_half_kick = size - (has_holders ? HOLDERS : 0) > ALWAYS;
  const double *from = record + 1;
  rest_x.unpack(i, from);
  velocities.fingerprints.unpack(i, from + rest_x.count());
  from += ALWAYS;
  if (holders.wanted() && has_holders) holders.columns.unpack(i, from);
  if (has_holders) from += HOLDERS;
  if (half_kick.on() && has_half_kick)
    half_kick.impulse.unpack(i, from);
  else if (half_kick.on())
    half_kick.forget(i);
}

struct FixPBDCloth::Record {
  Substepping::State substepping;
  double first_step;
  RestBox rest_box;
};

void FixPBDCloth::write_restart(FILE *fp)
{
  if (comm->me) return;
  write_record(fp, Record{substepping.state(), reference.first_step(), rest_box});
}

void FixPBDCloth::restart(char *buf)
{
  const auto record = read_record<Record>(buf, label, error);
  substepping.set_state(record.substepping);
  reference.set_first_step(record.first_step);
  rest_box = record.rest_box;
  keep_restored_time(update);
}

double FixPBDCloth::memory_usage()
{
  return rest_x.bytes() + velocities.fingerprints.bytes() + holders.columns.bytes() +
      half_kick.impulse.bytes() + constraints.distance.bytes() + constraints.bending.bytes() +
      vertices.bytes() + scaled.bytes();
}
