// Weakly compressible SPH: density summation (1), momentum (2), Tait equation of state (3). Here
// are its arguments, the phases of an evaluation, its ghosts and restart.  The sums are in
// core/sph/fluid_loops.h, the types in fluid/sph_materials.cpp, arrays and queries in
// fluid/fluid_state.cpp.

#include "pair_sph_tait.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neighbor.h"
#include "stepping/step_hooks.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

static const std::string STYLE = "pair_style sph/tait";

/* ---------------------------------------------------------------------- */

PairSPHTait::PairSPHTait(LAMMPS *lmp_) : Pair(lmp_), fluid(lmp_, this)
{
  restartinfo = 1;
  single_enable = 0;
  manybody_flag = 1;
  writedata = 1;
  no_virial_fdotr_compute = 1;
  comm_forward = 2;
}

PairSPHTait::~PairSPHTait()
{
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
  }
}

void PairSPHTait::allocate()
{
  allocated = 1;
  const int n = atom->ntypes + 1;
  memory->create(setflag, n, n, "pair:setflag");
  memory->create(cutsq, n, n, "pair:cutsq");
  for (int i = 1; i < n; i++)
    for (int j = i; j < n; j++) setflag[i][j] = 0;
  fluid.allocate();
}

/* ----------------------------------------------------------------------
   pair_style sph/tait H keyword value ...
------------------------------------------------------------------------- */

void PairSPHTait::settings(int narg, char **arg)
{
  fluid.forget();
  fluid.read_options(narg, arg);
  fluid.set_lattice_masses();
}

void PairSPHTait::coeff(int narg, char **arg)
{
  if (!allocated) allocate();
  fluid.read(narg, arg, setflag);
  fluid.set_lattice_masses();
}

/* ---------------------------------------------------------------------- */

void PairSPHTait::init_style()
{
  if (!atom->rho_flag)
    error->all(FLERR,
               "{}: atom_style {} has no density: use atom_style sph, or hybrid sph molecular "
               "for a scene with cloth",
               STYLE, atom->atom_style);
  if (!comm->ghost_velocity)
    error->all(FLERR, "{}: ghost atoms have no velocity: add 'comm_modify vel yes'", STYLE);
  if (neighbor->nex_group || neighbor->nex_mol)
    error->all(FLERR,
               "{}: neigh_modify exclude group or molecule would hide neighbours from the sums: "
               "exclude types, or remove it; boundary particles leave each other out by their role",
               STYLE);
  fluid.set_lattice_masses();    // 'mass' may have come since
  comm_forward = fluid.diffuses() ? 3 : 2;
  fluid.begin_run();
  const int n = atom->ntypes + 1;
  reach.assign(n * n, 0.0);
  moved.assign(n, 0);
  moved_here = moved;
}

double PairSPHTait::init_one(int i, int j)
{
  const int n = atom->ntypes + 1;
  const double radius = fluid.support(i, j);
  if (comm->cutghostuser > 0.0 && comm->cutghostuser < radius)
    error->all(FLERR,
               "{}: the ghost cut-off {} of comm_modify is smaller than the support {} of types {} "
               "and {}: raise it to the support plus the skin",
               STYLE, comm->cutghostuser, radius, i, j);

  // LAMMPS counts the images of a box within the cut-off in an int, and makes ghosts of all of them
  constexpr double MAX_BOXES = 1000.0, MAX_IMAGES = 1000.0;
  const double box = std::max({domain->prd[0], domain->prd[1], domain->prd[2]});
  double images = 1.0;
  for (int d = 0; d < domain->dimension; d++)
    if (domain->periodicity[d]) images *= 1.0 + 2.0 * radius / domain->prd[d];
  if (radius > MAX_BOXES * box || images > MAX_IMAGES)
    error->all(
        FLERR,
        "{}: the support {} of types {} and {} is {:.3g} times the box, {}, and reaches over "
        "{:.3g} images of it: give H and 'support' in the units of the box",
        STYLE, radius, i, j, radius / box, box, images);

  FluidModel &model = fluid.core->model;
  PairTerms t = fluid.mix(i, j);
  // density diffuses within a fluid, not across the step between two
  if (i == j && fluid.integrates_density())
    t.diffusion =
        2.0 * fluid.options.delta * fluid.equation_of_state(i).sound_speed() * 0.5 * radius;
  model.terms[i * n + j] = model.terms[j * n + i] = t;
  if (t.monaghan > 0.0) model.friction = std::max(model.friction, Friction::ARTIFICIAL);
  if (t.nu > 0.0) model.friction = Friction::ANY;

  const double listed = excluded(i, j) ? 0.0 : fluid.reach(i, j);
  reach[i * n + j] = reach[j * n + i] = listed;
  return listed;
}

// by neigh_modify exclude type; boundary particles that measure their volume still meet

bool PairSPHTait::excluded(int i, int j) const
{
  if (!fluid.is_fluid(i) && !fluid.is_fluid(j)) return false;
  for (int k = 0; k < neighbor->nex_type; k++) {
    const int a = neighbor->ex1_type[k], b = neighbor->ex2_type[k];
    if ((a == i && b == j) || (a == j && b == i)) return true;
  }
  return false;
}

/* ----------------------------------------------------------------------
   one evaluation: volumes of boundary particles, densities, pressures, forces
------------------------------------------------------------------------- */

void PairSPHTait::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  fluid.is_evaluated = false;
  const bool new_neighbors = neighbor->ago == 0;
  if (new_neighbors) fluid.begin_lists();
  const Particles p = fluid.particles();
  if (new_neighbors) {
    const Motion motion = usual_motion(p);
    fluid.update_lists(p, reach.data(), &motion);
  } else
    fluid.update_lists(p, reach.data(), nullptr);

  Fluid &core = *fluid.core;
  StepHooks *hooks = fluid.hooks;
  fluid.select(p);
  core.place(p, box());
  measure_volumes(p, new_neighbors);
  for (FluidBoundary *boundary : fluid.boundaries) boundary->begin();
  densities(p);
  fluid.find_pressures(p, fluid.pressures_follow || new_neighbors);
  send_to_ghosts(Stage::DENSITY);
  if (extrapolate) boundary_pressures(p);
  core.record(p);
  if (hooks && hooks->correct_velocities()) core.record(p);

  core.forces(p, hooks ? Target::FLUID : Target::ALL);
  if (hooks) hooks->note_pair_forces();
  for (FluidBoundary *boundary : fluid.boundaries) push(*boundary);
  if (vflag_either) tally_virial(p);
  if (hooks) hooks->apply_impulses();
  for (FluidBoundary *boundary : fluid.boundaries) boundary->end();
  if (eflag_either) tally_energy();
  fluid.is_evaluated = true;
}

// Where the pressures of inactive particles follow, these act on a boundary in every step.

void PairSPHTait::push(FluidBoundary &boundary)
{
  const auto push_one = [&](int i, const Tait &) { boundary.push(i, fluid.pressure[i]); };
  if (!fluid.pressures_follow) return fluid.for_each_fluid(push_one);
  for (int i = 0; i < atom->nlocal; i++)
    if (const int t = atom->type[i]; fluid.is_fluid(t)) push_one(i, fluid.equation_of_state(t));
}

Fluid::Box PairSPHTait::box() const
{
  const double *lo = domain->triclinic ? domain->boxlo_bound : domain->boxlo;
  const double tilt = std::fabs(domain->xy) + std::fabs(domain->xz) + std::fabs(domain->yz);
  return {{lo[0], lo[1], lo[2]},
          {domain->prd[0], domain->prd[1], domain->prd[2]},
          comm->get_comm_cutoff() + neighbor->skin + tilt};
}

// From velocities and a usual acoustic step: the step itself is another after a restart than
// before.

Motion PairSPHTait::usual_motion(const Particles &p) const
{
  Motion motion;
  motion.dimension = domain->dimension;
  motion.v = p.v;
  constexpr double USUAL = 0.5;    // of h_s/c
  double step = std::numeric_limits<double>::max();
  for (int t = 1; t <= atom->ntypes; t++)
    if (fluid.is_fluid(t))
      step =
          std::min(step, USUAL * 0.5 * fluid.support(t) / fluid.equation_of_state(t).sound_speed());
  motion.step = step;
  motion.interval.assign(atom->ntypes + 1, 1.0);
  if (fluid.hooks) fluid.hooks->find_intervals(motion.interval);
  return motion;
}

// of all particles, also of inactive ones

void PairSPHTait::tally_virial(Particles p)
{
  const auto receive = [](void *self, int i, const Acceleration &a) {
    auto *pair = static_cast<PairSPHTait *>(self);
    const double scale = pair->fluid.mass_or_volume[i] * pair->force->mvv2e;
    for (int m = 0; m < 6; m++) {
      if (pair->vflag_global) pair->virial[m] += scale * a.virial[m];
      if (pair->vflag_atom) pair->vatom[i][m] += scale * a.virial[m];
    }
  };
  Fluid &core = *fluid.core;
  if (!fluid.hooks) return core.virials(p, receive, this);
  const Particles updated = p;
  p.active = nullptr;
  core.select(p);
  core.virials(p, receive, this);
  core.select(updated);
}

// Volumes of boundary particles that share space among themselves follow their motion, as long as
// there is fluid to feel them.

void PairSPHTait::measure_volumes(const Particles &p, bool new_neighbors)
{
  const int n = atom->ntypes + 1;
  std::fill(moved.begin(), moved.end(), new_neighbors);
  if (measure_volume && !new_neighbors && any_fluid) {
    std::vector<int> &here = moved_here;
    std::fill(here.begin(), here.end(), 0);
    for (int i = 0; i < p.n_owned; i++) {
      const double *v = p.v + 3 * i;
      if (v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0) here[p.type[i]] = 1;
    }
    MPI_Allreduce(here.data(), moved.data(), n, MPI_INT, MPI_MAX, world);
  }
  bool measured = false;
  for (int t = 1; t < n; t++) {
    if (!fluid.is_measured(t) || !moved[t]) continue;
    fluid.core->volumes(p, t, fluid.mass_or_volume.data());
    measured = true;
  }
  if (!measured && !new_neighbors) return;
  send_to_ghosts(Stage::MASS_OR_VOLUME);
  if (!new_neighbors) return;
  std::array<int, 3> here{0, 0, 0}, anywhere{0, 0, 0};
  for (int i = 0; i < p.n_owned; i++) {
    const int t = p.type[i];
    if (fluid.is_fluid(t)) here[0] = 1;
    if (fluid.extrapolates(t)) here[1] = 1;
    if (fluid.is_measured(t)) here[2] = 1;
  }
  MPI_Allreduce(here.data(), anywhere.data(), 3, MPI_INT, MPI_MAX, world);
  any_fluid = anywhere[0];
  extrapolate = anywhere[1];
  measure_volume = anywhere[2];
  fluid.find_equal_masses(p);
}

void PairSPHTait::densities(const Particles &p)
{
  Fluid &core = *fluid.core;
  if (!fluid.integrates_density()) {
    core.gather(p, true);
    for (FluidBoundary *boundary : fluid.boundaries)
      fluid.for_each_fluid([&](int i, const Tait &) { p.rho[i] = boundary->density(i, p.rho[i]); });
    return;
  }
  fluid.check_densities();
  core.record(p);
  core.gather(p, false);
  integrate_density(p);
}

// The velocities are those with which the particles came here, so the rate is that at the middle of
// the displacement.  At its end it would be wrong by the divergence that the forces have made
// since, which is a diffusion of -dt c0^2 / 2.

void PairSPHTait::integrate_density(const Particles &p)
{
  std::vector<double> &rate = fluid.rate;
  rate.resize(atom->nmax);
  const double elapsed = fluid.elapsed, back = 0.5 * elapsed;
  if (!(elapsed > 0.0)) return;
  density_rates(p, back);
  for (FluidBoundary *boundary : fluid.boundaries)
    fluid.for_each_fluid(
        [&](int i, const Tait &) { rate[i] = boundary->density_rate(i, rate[i], back); });
  fluid.for_each_fluid([&](int i, const Tait &) { p.rho[i] += elapsed * rate[i]; });
  fluid.elapsed = 0.0;
  if (const int every = fluid.options.reinit; every && update->ntimestep % every == 0) {
    send_to_ghosts(Stage::DENSITY);
    fluid.core->smooth_densities(p, rate.data());
    fluid.for_each_fluid([&](int i, const Tait &) { p.rho[i] = rate[i]; });
  }
}

// Inactive particles keep their gradient.

void PairSPHTait::density_rates(const Particles &p, double back)
{
  double *gradient = nullptr;
  if (fluid.diffuses()) {
    gradient = fluid.gradient.data();
    fluid.core->density_gradients(p, gradient);
    send_to_ghosts(Stage::GRADIENT);
  }
  fluid.core->density_rates(p, gradient, back, fluid.rate.data());
}

void PairSPHTait::boundary_pressures(const Particles &p)
{
  for (int t = 1; t <= atom->ntypes; t++)
    if (fluid.extrapolates(t)) fluid.core->boundary_pressures(p, t, fluid.pressure.data());
  send_to_ghosts(Stage::DENSITY);
}

// internal energy of the fluid: what compression has stored

void PairSPHTait::tally_energy()
{
  for (int i = 0; i < atom->nlocal; i++) {
    const int t = atom->type[i];
    if (!fluid.is_fluid(t)) continue;
    const double e = fluid.mass_or_volume[i] *
        fluid.stored_energy(fluid.equation_of_state(t), atom->rho[i]) * force->mvv2e;
    if (eflag_global) eng_vdwl += e;
    if (eflag_atom) eatom[i] += e;
  }
}

/* ----------------------------------------------------------------------
   ghosts: mass or volume, gradient of the density, then density and pressure of fluid
------------------------------------------------------------------------- */

void PairSPHTait::send_to_ghosts(Stage what)
{
  stage = what;
  comm->forward_comm(this, what == Stage::MASS_OR_VOLUME ? 1 : what == Stage::DENSITY ? 2 : 3);
}

int PairSPHTait::pack_forward_comm(int n, int *sendlist, double *buf, int, int *)
{
  int m = 0;
  if (stage == Stage::MASS_OR_VOLUME) {
    for (int k = 0; k < n; k++) buf[m++] = fluid.mass_or_volume[sendlist[k]];
    return m;
  }
  if (stage == Stage::GRADIENT) {
    for (int k = 0; k < n; k++)
      for (int d = 0; d < 3; d++) buf[m++] = fluid.gradient[3 * sendlist[k] + d];
    return m;
  }
  for (int k = 0; k < n; k++) {
    buf[m++] = atom->rho[sendlist[k]];
    buf[m++] = fluid.pressure[sendlist[k]];
  }
  return m;
}

void PairSPHTait::unpack_forward_comm(int n, int first, double *buf)
{
  int m = 0;
  if (stage == Stage::MASS_OR_VOLUME) {
    for (int i = first; i < first + n; i++) fluid.mass_or_volume[i] = buf[m++];
    return;
  }
  if (stage == Stage::GRADIENT) {
    std::copy(buf, buf + 3 * n, fluid.gradient.begin() + 3 * first);
    return;
  }
  for (int i = first; i < first + n; i++) {
    atom->rho[i] = buf[m++];
    fluid.pressure[i] = buf[m++];
  }
}

/* ----------------------------------------------------------------------
   restart and data files: settings and coefficients, as the user gave them
------------------------------------------------------------------------- */

void PairSPHTait::write_restart_settings(FILE *fp) { fluid.write_options(fp); }

void PairSPHTait::read_restart_settings(FILE *fp)
{
  fluid.forget();
  fluid.read_options(fp);
}

void PairSPHTait::write_restart(FILE *fp)
{
  write_restart_settings(fp);
  fluid.write_restart(fp);
  for (int i = 1; i <= atom->ntypes; i++)
    fwrite(&setflag[i][i], sizeof(int), atom->ntypes + 1 - i, fp);
}

void PairSPHTait::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  allocate();
  fluid.read_restart(fp);
  for (int i = 1; i <= atom->ntypes; i++) {
    const int n = atom->ntypes + 1 - i;
    if (comm->me == 0) utils::sfread(FLERR, &setflag[i][i], sizeof(int), n, fp, nullptr, error);
    MPI_Bcast(&setflag[i][i], n, MPI_INT, 0, world);
  }
}

void PairSPHTait::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; i++) utils::print(fp, "{} {}\n", i, fluid.words(i, i));
}

void PairSPHTait::write_data_all(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) utils::print(fp, "{} {} {}\n", i, j, fluid.words(i, j));
}

double PairSPHTait::memory_usage() { return Pair::memory_usage() + fluid.bytes(); }

void *PairSPHTait::extract(const char *name, int &)
{
  return std::strcmp(name, FluidState::EXTRACT) == 0 ? &fluid : nullptr;
}
