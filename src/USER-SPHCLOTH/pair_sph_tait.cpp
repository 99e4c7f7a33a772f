// Weakly compressible SPH: density summation (1), momentum (2), Tait equation of state (3).
// The sums themselves are in core/sph/fluid_loops.h, what is said of types in sph_materials.cpp.

#include "pair_sph_tait.h"

#include "atom.h"
#include "comm.h"
#include "core/util/bytes.h"
#include "domain.h"
#include "error.h"
#include "fix_cloth_contact.h"
#include "force.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/rank_error.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "stepping/step_hooks.h"
#include "timer.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>

using namespace LAMMPS_NS;
using namespace sphcloth;

static const std::string STYLE = "pair_style sph/tait";

/* ---------------------------------------------------------------------- */

PairSPHTait::PairSPHTait(LAMMPS *lmp_) :
    Pair(lmp_), materials(lmp), sheets(nullptr), hooks(nullptr), is_evaluated(false),
    measure_volume(false), extrapolate(false), any_fluid(true), active(nullptr), active_column(0),
    elapsed(0.0), stage(Stage::DENSITY)
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
  materials.allocate();
}

/* ----------------------------------------------------------------------
   pair_style sph/tait H keyword value ...
------------------------------------------------------------------------- */

void PairSPHTait::settings(int narg, char **arg)
{
  ArgReader args(lmp, STYLE, narg, arg);
  forget_evaluation();
  options = Options();
  options.support = args.positive("support radius H");
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "kernel") {
      std::vector<std::string> names;
      for (KernelName k : ALL_KERNELS) names.push_back(kernel_word(k));
      options.kernel = ALL_KERNELS[args.choice(keyword, names)];
    } else if (keyword == "tension")
      options.tension = args.choice(keyword, {"no", "yes"});
    else if (keyword == "precision")
      options.precision = args.choice(keyword, {"double", "mixed"}) ? Precision::MIXED
                                                                    : Precision::DOUBLE;
    else if (keyword == "density")
      options.continuity = args.choice(keyword, {"summation", "continuity"});
    else if (keyword == "delta")
      options.delta = args.at_least(keyword, 0.0);
    else if (keyword == "reinit")
      options.reinit = args.integer(keyword, 0, 1000000000);
    else
      args.unknown(keyword, "kernel, tension, precision, density, delta, reinit");
  }
  materials.default_support = options.support;
  materials.set_lattice_masses(options.kernel);
}

void PairSPHTait::coeff(int narg, char **arg)
{
  if (!allocated) allocate();
  materials.read(narg, arg, setflag);
  materials.set_lattice_masses(options.kernel);
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
  materials.set_lattice_masses(options.kernel);    // 'mass' may have come since
  active = nullptr;    // until a fix says who is
  hooks = nullptr;
  pressures_follow = false;
  comm_forward = diffuses() ? 3 : 2;

  boundaries = find_fluid_boundaries(modify);
  find_sheets();

  // lists outlive init(): 'run pre no' goes on with them
  if (!fluid) fluid = Fluid::create(options.kernel, options.precision);
  set_model();
  moved.assign(atom->ntypes + 1, 0);
  moved_here = moved;
}

void PairSPHTait::find_sheets()
{
  sheets = nullptr;
  for (Fix *fix : modify->get_fix_by_style("^cloth/contact$")) {
    auto *contact = dynamic_cast<FixClothContact *>(fix);
    if (!contact->has_sides()) continue;
    if (sheets)
      error->all(FLERR,
                 "{}: fix {} and fix {} cloth/contact both part the fluid: give one of them "
                 "'sides no'",
                 STYLE, sheets->id, contact->id);
    sheets = contact;
  }
  double longest = 0.0;
  for (int i = 1; i <= atom->ntypes; i++)
    if (materials.is_fluid(i)) longest = std::max(longest, support(i));
  if (sheets) sheets->set_sight(longest + neighbor->skin);
}

void PairSPHTait::forget_evaluation()
{
  fluid.reset();
  materials.unsettle();
  is_evaluated = false;
}

void PairSPHTait::set_model()
{
  materials.settle();
  FluidModel &model = fluid->model;
  const int n = atom->ntypes + 1;
  model.dimension = domain->dimension;
  model.n_types = atom->ntypes;
  model.friction = Friction::NONE;
  model.also = Outputs::NOTHING;
  model.role.assign(n, Role::NONE);
  model.mass.resize(n, 0.0);
  model.terms.assign(n * n, PairTerms());
  reach.assign(n * n, 0.0);
  for (int i = 1; i < n; i++) model.role[i] = materials.type(i).role;
}

double PairSPHTait::lattice_sum(int itype, double spacing) const
{
  return materials.lattice_sum(itype, spacing, options.kernel);
}

WallTable PairSPHTait::wall_table() const
{
  return with_kernel(options.kernel, [&](auto kernel) {
    return sphcloth::wall_table<decltype(kernel)>(domain->dimension);
  });
}

double PairSPHTait::init_one(int i, int j)
{
  const int n = atom->ntypes + 1;
  const double radius = materials.support(i, j);
  if (comm->cutghostuser > 0.0 && comm->cutghostuser < radius)
    error->all(FLERR,
               "{}: the ghost cut-off {} of comm_modify is smaller than the support {} of types {} "
               "and {}: raise it to the support plus the skin",
               STYLE, comm->cutghostuser, radius, i, j);

  // LAMMPS counts the images of a box within the cut-off in an int, and makes ghosts of all of them
  constexpr double MOST_BOXES = 1000.0, MOST_IMAGES = 1000.0;
  const double box = std::max({domain->prd[0], domain->prd[1], domain->prd[2]});
  double images = 1.0;
  for (int d = 0; d < domain->dimension; d++)
    if (domain->periodicity[d]) images *= 1.0 + 2.0 * radius / domain->prd[d];
  if (radius > MOST_BOXES * box || images > MOST_IMAGES)
    error->all(
        FLERR,
        "{}: the support {} of types {} and {} is {:.3g} times the box, {}, and reaches over "
        "{:.3g} images of it: give H and 'support' in the units of the box",
        STYLE, radius, i, j, radius / box, box, images);

  FluidModel &model = fluid->model;
  PairTerms t = materials.mix(i, j, options.kernel);
  // density diffuses within a fluid, not across the step between two
  if (i == j && options.continuity)
    t.diffusion = 2.0 * options.delta * equation_of_state(i).sound_speed() * 0.5 * radius;
  model.terms[i * n + j] = model.terms[j * n + i] = t;
  if (t.monaghan > 0.0) model.friction = std::max(model.friction, Friction::ARTIFICIAL);
  if (t.nu > 0.0) model.friction = Friction::ANY;

  const double far = excluded(i, j) ? 0.0 : materials.reach(i, j);
  reach[i * n + j] = reach[j * n + i] = far;
  return far;
}

// by neigh_modify exclude type; boundary particles that measure their volume still meet

bool PairSPHTait::excluded(int i, int j) const
{
  if (!is_fluid(i) && !is_fluid(j)) return false;
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
  is_evaluated = false;
  const bool new_neighbors = neighbor->ago == 0;
  if (new_neighbors) renew();
  const Particles p = particles();
  follow(p, new_neighbors);

  select(p);
  fluid->place(p, box());
  measure_amounts(p, new_neighbors);
  for (FluidBoundary *boundary : boundaries) boundary->begin();
  densities(p);
  pressures(p, pressures_follow || new_neighbors);
  stage = Stage::DENSITY;
  comm->forward_comm(this, 2);
  if (extrapolate) boundary_pressures(p);
  fluid->record(p);
  if (hooks && hooks->correct_velocities()) fluid->record(p);

  fluid->forces(p, hooks ? Target::FLUID : Target::ALL);
  if (hooks) hooks->note_pair_forces();
  for (FluidBoundary *boundary : boundaries)
    for_each_fluid([&](int i, const Tait &) { boundary->push(i, pressure[i]); });
  if (vflag_either) tally_virial(p);
  if (hooks) hooks->apply_impulses();
  for (FluidBoundary *boundary : boundaries) boundary->end();
  if (eflag_either) tally_energy();
  is_evaluated = true;
}

// who is updated, and those of the fluid as a list

void PairSPHTait::select(const Particles &p)
{
  if (!fluid->select(p)) return;
  if (!hooks) return;
  active_fluid.clear();
  for (int t = 1; t <= atom->ntypes; t++)
    if (materials.is_fluid(t))
      for (const int slot : fluid->active().of(t)) active_fluid.push_back(fluid->order().at(slot));
}

void PairSPHTait::push_walls_more(int i, double p_over_rho2, double times)
{
  for (FluidBoundary *boundary : boundaries) boundary->push_more(i, p_over_rho2, times);
}

void PairSPHTait::prolong_walls(double times)
{
  for (FluidBoundary *boundary : boundaries) boundary->prolong(times);
}

void PairSPHTait::hand_over_pushes(const FluidBoundary::Take &take)
{
  for (FluidBoundary *boundary : boundaries) boundary->defer(take);
}

bool PairSPHTait::feels_moving_wall(int i) const
{
  return std::any_of(boundaries.begin(), boundaries.end(),
                     [&](FluidBoundary *boundary) { return boundary->moves_beside(i); });
}

bool PairSPHTait::is_beside_mesh(int i) const
{
  return std::any_of(boundaries.begin(), boundaries.end(),
                     [&](FluidBoundary *boundary) { return boundary->has_vertices_beside(i); });
}

void PairSPHTait::give_impulses(const std::vector<int> &slots, const double *pressure_time,
                                const double *span)
{
  const Particles p = particles();
  fluid->record_impulses(p, pressure_time, span);
  fluid->impulses(p, slots);
}

// of all, also of those who have steps of their own and are not updated now

void PairSPHTait::tally_virial(Particles p)
{
  const auto receive = [](void *self, int i, const Acceleration &a) {
    auto *pair = static_cast<PairSPHTait *>(self);
    const double scale = pair->amount[i] * pair->force->mvv2e;
    for (int m = 0; m < 6; m++) {
      if (pair->vflag_global) pair->virial[m] += scale * a.virial[m];
      if (pair->vflag_atom) pair->vatom[i][m] += scale * a.virial[m];
    }
  };
  if (!hooks) return fluid->virials(p, receive, this);
  const Particles updated = p;
  p.active = nullptr;
  fluid->select(p);
  fluid->virials(p, receive, this);
  fluid->select(updated);
}

Particles PairSPHTait::particles()
{
  Particles p;
  p.n_owned = atom->nlocal;
  p.n_all = atom->nlocal + atom->nghost;
  if (p.n_all == 0) return p;
  p.type = atom->type;
  p.x = atom->x[0];
  p.v = atom->v[0];
  p.amount = amount.data();
  p.pressure = pressure.data();
  p.rho = atom->rho;
  p.drho = atom->drho;
  p.f = atom->f[0];
  p.approach = approach.data();
  p.force_unit = 1.0 / force->ftm2v;
  if (sheets) p.sides = sheets->sides();
  p.active = active;
  p.active_column = active_column;
  return p;
}

Fluid::Box PairSPHTait::box() const
{
  const double *lo = domain->triclinic ? domain->boxlo_bound : domain->boxlo;
  const double tilt = std::fabs(domain->xy) + std::fabs(domain->xz) + std::fabs(domain->yz);
  return {{lo[0], lo[1], lo[2]},
          {domain->prd[0], domain->prd[1], domain->prd[2]},
          comm->get_comm_cutoff() + neighbor->skin + tilt};
}

// Fixed until LAMMPS has new neighbours again: masses.

void PairSPHTait::renew()
{
  amount.resize(atom->nmax);
  pressure.assign(atom->nmax, 0.0);
  if (diffuses()) gradient.assign(3 * static_cast<std::size_t>(atom->nmax), 0.0);
  if (fluid->model.also == Outputs::RATE_AND_APPROACH) approach.resize(atom->nmax);
  for (int i = 0; i < atom->nlocal; i++) {
    const int itype = atom->type[i];
    if (!materials.is_boundary(itype))
      amount[i] = atom_mass(atom, i);
    else if (materials.type(itype).volume > 0.0)
      amount[i] = materials.type(itype).volume;
    const double *v = atom->v[i];
    if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2]))
      rank_error(lmp, FLERR, "{}: particle {} has velocity {} {} {}: give finite numbers", STYLE,
                 atom->tag[i], v[0], v[1], v[2]);
  }
  evaluated_order = order_of_atoms(atom);
}

// As wide as LAMMPS's skin lists hold until LAMMPS renews its own: it looks at how far the fastest has
// gone.  Narrower ones are made anew where particles have come nearer.

void PairSPHTait::follow(const Particles &p, bool new_neighbors)
{
  try {
    if (new_neighbors)
      fluid->list(p, reach.data(), neighbor->skin, motion(p));
    else
      fluid->follow(p);
  } catch (const std::bad_alloc &) {
    rank_error(
        lmp, FLERR,
        "{}: not enough memory for the neighbours of {} particles within the support {}: are "
        "particles or vertices much nearer to each other than that?",
        STYLE, atom->nlocal, options.support);
  }
  timer->stamp(Timer::NEIGH);
}

// As far as velocities tell, for a step that sound often asks for: the step itself is another after a
// restart than before.

Motion PairSPHTait::motion(const Particles &p) const
{
  Motion motion;
  motion.v = p.v;
  constexpr double USUAL = 0.5;    // of h_s/c
  double step = std::numeric_limits<double>::max();
  for (int t = 1; t <= atom->ntypes; t++)
    if (is_fluid(t))
      step = std::min(step, USUAL * 0.5 * support(t) / equation_of_state(t).sound_speed());
  motion.step = step;
  motion.interval.assign(atom->ntypes + 1, 1.0);
  if (hooks) hooks->find_intervals(motion.interval);
  return motion;
}

bool PairSPHTait::is_measured(int t) const
{
  return materials.is_boundary(t) && !(materials.type(t).volume > 0.0);
}

// Volumes of boundary particles that share space among themselves follow their motion, as long as
// there is fluid to feel them.

void PairSPHTait::measure_amounts(const Particles &p, bool new_neighbors)
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
    if (!is_measured(t) || !moved[t]) continue;
    fluid->volumes(p, t, amount.data());
    measured = true;
  }
  if (!measured && !new_neighbors) return;
  stage = Stage::AMOUNT;
  comm->forward_comm(this, 1);
  if (!new_neighbors) return;
  std::array<int, 3> here{0, 0, 0}, anywhere{0, 0, 0};
  for (int i = 0; i < p.n_owned; i++) {
    const int t = p.type[i];
    if (materials.is_fluid(t)) here[0] = 1;
    if (materials.extrapolates(t)) here[1] = 1;
    if (is_measured(t)) here[2] = 1;
  }
  MPI_Allreduce(here.data(), anywhere.data(), 3, MPI_INT, MPI_MAX, world);
  any_fluid = anywhere[0];
  extrapolate = anywhere[1];
  measure_volume = anywhere[2];

  // a mass that all particles of a type share leaves the sums
  std::vector<double> &mass = fluid->model.mass;
  std::fill(mass.begin(), mass.end(), -1.0);
  for (int i = 0; i < p.n_all; i++) {
    const int t = p.type[i];
    if (mass[t] < 0.0) mass[t] = materials.is_fluid(t) ? amount[i] : 0.0;
    if (mass[t] != amount[i]) mass[t] = 0.0;
  }
}

template <class F> void PairSPHTait::for_each_fluid(F &&act) const
{
  for (int t = 1; t <= atom->ntypes; t++) {
    if (!materials.is_fluid(t)) continue;
    const Tait eos = materials.type(t).eos;
    for (const int slot : fluid->active().of(t)) act(fluid->order().at(slot), eos);
  }
}

void PairSPHTait::densities(const Particles &p)
{
  if (!options.continuity) {
    fluid->gather(p, true);
    for (FluidBoundary *boundary : boundaries)
      for_each_fluid([&](int i, const Tait &) { p.rho[i] = boundary->density(i, p.rho[i]); });
    return;
  }
  check_densities();
  fluid->record(p);
  fluid->gather(p, false);
  integrate_density(p);
}

// The velocities are those with which the particles came here, so the rate is that of the middle of
// the way.  At its end it would be wrong by the divergence that the forces have made since, which
// is a diffusion of -dt c0^2 / 2.

void PairSPHTait::integrate_density(const Particles &p)
{
  rate.resize(atom->nmax);
  if (elapsed > 0.0) {
    const double back = 0.5 * elapsed;
    density_rates(p, back);
    for (FluidBoundary *boundary : boundaries)
      for_each_fluid(
          [&](int i, const Tait &) { rate[i] = boundary->density_rate(i, rate[i], back); });
    for_each_fluid([&](int i, const Tait &) { p.rho[i] += elapsed * rate[i]; });
    elapsed = 0.0;
    if (options.reinit && update->ntimestep % options.reinit == 0) {
      stage = Stage::DENSITY;
      comm->forward_comm(this, 2);
      fluid->smooth_densities(p, rate.data());
      for_each_fluid([&](int i, const Tait &) { p.rho[i] = rate[i]; });
    }
  }
}

// Particles that are not active keep the gradient that they had.

void PairSPHTait::density_rates(const Particles &p, double back)
{
  if (!diffuses()) return fluid->density_rates(p, nullptr, back, rate.data());
  fluid->density_gradients(p, gradient.data());
  stage = Stage::GRADIENT;
  comm->forward_comm(this, 3);
  fluid->density_rates(p, gradient.data(), back, rate.data());
}

void PairSPHTait::check_densities() const
{
  for (int i = 0; i < atom->nlocal; i++)
    if (is_fluid(atom->type[i]) && !(atom->rho[i] > 0.0))
      rank_error(lmp, FLERR,
                 "{}: particle {} has density {}: give every fluid particle one, 'set group all "
                 "sph/rho RHO0', or use 'density summation'",
                 STYLE, atom->tag[i], atom->rho[i]);
}

// Those who are not active keep theirs, but not beyond a list build: then it follows from the density.

void PairSPHTait::pressures(const Particles &p, bool of_all)
{
  const double least = options.tension ? -std::numeric_limits<double>::max() : 0.0;
  const auto find = [&](int i, const Tait &eos) {
    const double rho = p.rho[i];
    double &term = pressure[i];
    term = std::max(eos.pressure(rho), least) / (rho * rho);
    // a density that is renormalized has a gradient that is
    for (FluidBoundary *boundary : boundaries) term *= boundary->inverse_gamma(i);
    // neither true of what is not a number
    if (!(term < std::numeric_limits<double>::max()) || !(rho > 0.0))
      rank_error(lmp, FLERR,
                 "{}: particle {} has density {}: particles overlap or the time step is too large",
                 STYLE, atom->tag[i], rho);
  };
  if (!of_all || !active) return for_each_fluid(find);
  for (int i = 0; i < p.n_owned; i++)
    if (is_fluid(p.type[i])) find(i, equation_of_state(p.type[i]));
}

void PairSPHTait::boundary_pressures(const Particles &p)
{
  for (int t = 1; t <= atom->ntypes; t++)
    if (materials.extrapolates(t)) fluid->boundary_pressures(p, t, pressure.data());
  comm->forward_comm(this, 2);
}

void PairSPHTait::add_virial(int i, const Eigen::Vector3d &apart, const Eigen::Vector3d &on)
{
  if (!vflag_either) return;
  const double v[6] = {apart[0] * on[0], apart[1] * on[1], apart[2] * on[2],
                       apart[0] * on[1], apart[0] * on[2], apart[1] * on[2]};
  for (int m = 0; m < 6; m++) {
    if (vflag_global) virial[m] += v[m];
    if (vflag_atom) vatom[i][m] += v[m];
  }
}

// internal energy of the fluid: what compression has stored

void PairSPHTait::tally_energy()
{
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_fluid(atom->type[i])) continue;
    const double e =
        amount[i] * stored_energy(equation_of_state(atom->type[i]), atom->rho[i]) * force->mvv2e;
    if (eflag_global) eng_vdwl += e;
    if (eflag_atom) eatom[i] += e;
  }
}

double PairSPHTait::acting_pressure(const Tait &eos, double rho) const
{
  const double p = eos.pressure(rho);
  return options.tension ? p : std::max(p, 0.0);
}

double PairSPHTait::stored_energy(const Tait &eos, double rho) const
{
  return rho < eos.rho0 && !options.tension ? 0.0 : eos.energy(rho);
}

/* ----------------------------------------------------------------------
   what the last evaluation found
------------------------------------------------------------------------- */

bool PairSPHTait::evaluated() const
{
  return is_evaluated && evaluated_order == order_of_atoms(atom);
}

double PairSPHTait::pressure_of(int i) const
{
  double p = pressure[i] * atom->rho[i] * atom->rho[i];
  if (is_fluid(atom->type[i]))
    for (FluidBoundary *boundary : boundaries) p /= boundary->inverse_gamma(i);
  return p;
}

int PairSPHTait::count_neighbors(int i)
{
  if (fluid->order().slots() == 0) return 0;    // a scene without fluid has no lists
  const Particles p = particles();
  int n = 0;
  for (int t = 1; t <= atom->ntypes; t++)
    if (is_fluid(atom->type[i]) || is_fluid(t))
      n += fluid->count_inside(p, i, t, std::numeric_limits<int>::max());
  return n;
}

static double apart_sq(const double *x, const double *y)
{
  const double dx = x[0] - y[0], dy = x[1] - y[1], dz = x[2] - y[2];
  return dx * dx + dy * dy + dz * dz;
}

bool PairSPHTait::inside_support(int i, int j) const
{
  const double far = support(atom->type[i], atom->type[j]);
  return apart_sq(atom->x[i], atom->x[j]) < far * far;
}

double PairSPHTait::p_over_rho2_beside(int i)
{
  double **x = atom->x;
  double greatest = 0.0;
  for (int t = 1; t <= atom->ntypes; t++) {
    const double far = support(atom->type[i], t), far_sq = far * far;
    const NeighborSpan near = neighbors(i, t);
    for (int k = 0; k < near.n; k++)
      if (const int j = near.of[k]; pressure[j] > greatest && apart_sq(x[i], x[j]) < far_sq)
        greatest = pressure[j];
  }
  return greatest;
}

void PairSPHTait::want_wetting() const
{
  for (FluidBoundary *boundary : boundaries) boundary->want_wetting();
}

double PairSPHTait::approach_speed(int i)
{
  double most = approach[i];
  for (FluidBoundary *boundary : boundaries) most = std::max(most, boundary->approach(i));
  return most;
}

PairSPHTait::Wetting PairSPHTait::wetting(int i)
{
  if (!materials.is_boundary(atom->type[i])) {
    for (const FluidBoundary *boundary : boundaries)
      if (const Wetting wet = boundary->wetting(i); wet.fluid_mass > 0.0) return wet;
    return {};
  }
  const Particles p = particles();
  Wetting w;
  for (int t = 1; t <= atom->ntypes; t++) {
    if (!materials.is_fluid(t) || fluid->count_inside(p, i, t, 1) == 0) continue;
    const Tait &eos = materials.type(t).eos;
    w.fluid_mass = std::max(w.fluid_mass, eos.rho0 * amount[i]);
    w.sound = std::max(w.sound, eos.sound_speed());
  }
  return w;
}

/* ----------------------------------------------------------------------
   ghosts: mass or volume, gradient of the density, then density and pressure of fluid
------------------------------------------------------------------------- */

int PairSPHTait::pack_forward_comm(int n, int *sendlist, double *buf, int, int *)
{
  int m = 0;
  if (stage == Stage::AMOUNT) {
    for (int k = 0; k < n; k++) buf[m++] = amount[sendlist[k]];
    return m;
  }
  if (stage == Stage::GRADIENT) {
    for (int k = 0; k < n; k++)
      for (int d = 0; d < 3; d++) buf[m++] = gradient[3 * sendlist[k] + d];
    return m;
  }
  for (int k = 0; k < n; k++) {
    buf[m++] = atom->rho[sendlist[k]];
    buf[m++] = pressure[sendlist[k]];
  }
  return m;
}

void PairSPHTait::unpack_forward_comm(int n, int first, double *buf)
{
  int m = 0;
  if (stage == Stage::AMOUNT) {
    for (int i = first; i < first + n; i++) amount[i] = buf[m++];
    return;
  }
  if (stage == Stage::GRADIENT) {
    std::copy(buf, buf + 3 * n, gradient.begin() + 3 * first);
    return;
  }
  for (int i = first; i < first + n; i++) {
    atom->rho[i] = buf[m++];
    pressure[i] = buf[m++];
  }
}

/* ----------------------------------------------------------------------
   restart and data files: settings and coefficients, as the user gave them
------------------------------------------------------------------------- */

void PairSPHTait::write_restart_settings(FILE *fp) { fwrite(&options, sizeof(Options), 1, fp); }

void PairSPHTait::read_restart_settings(FILE *fp)
{
  if (comm->me == 0) utils::sfread(FLERR, &options, sizeof(Options), 1, fp, nullptr, error);
  MPI_Bcast(&options, sizeof(Options), MPI_BYTE, 0, world);
  if (std::find(std::begin(ALL_KERNELS), std::end(ALL_KERNELS), options.kernel) ==
          std::end(ALL_KERNELS) ||
      !(options.support > 0.0))
    error->all(FLERR,
               "{}: its settings in the restart file are damaged, or of another release of "
               "sphcloth: take another file",
               STYLE);
  forget_evaluation();
  materials.default_support = options.support;
}

void PairSPHTait::write_restart(FILE *fp)
{
  write_restart_settings(fp);
  materials.write_restart(fp);
  for (int i = 1; i <= atom->ntypes; i++)
    fwrite(&setflag[i][i], sizeof(int), atom->ntypes + 1 - i, fp);
}

void PairSPHTait::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  allocate();
  materials.read_restart(fp);
  for (int i = 1; i <= atom->ntypes; i++) {
    const int n = atom->ntypes + 1 - i;
    if (comm->me == 0) utils::sfread(FLERR, &setflag[i][i], sizeof(int), n, fp, nullptr, error);
    MPI_Bcast(&setflag[i][i], n, MPI_INT, 0, world);
  }
}

void PairSPHTait::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; i++) utils::print(fp, "{} {}\n", i, materials.words(i, i));
}

void PairSPHTait::write_data_all(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++)
      utils::print(fp, "{} {} {}\n", i, j, materials.words(i, j));
}

double PairSPHTait::memory_usage()
{
  return Pair::memory_usage() + (fluid ? fluid->bytes() : 0.0) +
      bytes_of(amount, pressure, rate, gradient, approach, active_fluid);
}
