// Weakly compressible SPH: density summation (1), momentum (2), Tait equation of state (3).
// The sums themselves are in core/sph_loops.h.

#include "pair_sph_tait.h"

#include "arg_reader.h"
#include "atom.h"
#include "atom_tools.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_wall_sph.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace sphcloth;

static const std::string STYLE = "pair_style sph/tait";
static const std::string COEFF = "pair_coeff (sph/tait)";

/* ---------------------------------------------------------------------- */

PairSPHTait::PairSPHTait(LAMMPS *lmp) :
    Pair(lmp), kernel(Kernel::WENDLAND_C2), support_global(0.0), keep_tension(0), viscous(false),
    several_fluids(false), several_roles(false), measure_volume(false), walls(nullptr),
    active(nullptr), active_column(0), single_fluid(1), stage(Stage::DENSITY), densities_fn(nullptr),
    forces_fn(nullptr), virial_fn(nullptr), volumes_fn(nullptr)
{
  restartinfo = 1;
  single_enable = 0;
  manybody_flag = 1;
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
  types.assign(n, TypeData());
  pairs.assign(n * n, PairData());
  terms.assign(n * n, PairTerms());
}

/* ----------------------------------------------------------------------
   pair_style sph/tait H keyword value ...
------------------------------------------------------------------------- */

void PairSPHTait::settings(int narg, char **arg)
{
  ArgReader args(lmp, STYLE, narg, arg);
  support_global = args.positive("support radius H");
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "kernel") {
      const std::string name = args.word("kernel");
      if (name == WendlandC2::NAME)
        kernel = Kernel::WENDLAND_C2;
      else if (name == CubicSpline::NAME)
        kernel = Kernel::CUBIC;
      else
        args.fail("kernel", name, "use wendland/c2 or cubic");
    } else if (keyword == "tension") {
      const std::string choice = args.word("tension");
      if (choice != "yes" && choice != "no") args.fail("tension", choice, "use yes or no");
      keep_tension = choice == "yes";
    } else
      args.unknown(keyword, "kernel, tension");
  }
}

/* ----------------------------------------------------------------------
   pair_coeff I I fluid rho0 ... | pair_coeff I I boundary ... | pair_coeff I J keyword ...
------------------------------------------------------------------------- */

void PairSPHTait::coeff(int narg, char **arg)
{
  if (narg < 3) utils::missing_cmd_args(FLERR, COEFF, error);
  if (!allocated) allocate();
  int ilo, ihi, jlo, jhi;
  utils::bounds(FLERR, arg[0], 1, atom->ntypes, ilo, ihi, error);
  utils::bounds(FLERR, arg[1], 1, atom->ntypes, jlo, jhi, error);

  ArgReader args(lmp, COEFF, narg, arg, 2);
  const std::string role = arg[2];
  if (role == "fluid" || role == "boundary") {
    args.word("role");
    PairData own;
    const TypeData data = role == "fluid" ? read_fluid(args, own) : read_boundary(args);
    store_fluid_and_boundary(ilo, ihi, jlo, jhi, data, own);
    return;
  }
  const PairData data = read_pair(args);
  int count = 0;
  for (int i = ilo; i <= ihi; i++)
    for (int j = std::max(jlo, i); j <= jhi; j++) {
      if (i == j) continue;
      pairs[i * (atom->ntypes + 1) + j] = data;
      setflag[i][j] = 1;
      count++;
    }
  if (!count)
    error->all(FLERR,
               "{}: pair {} {} has no role: start with 'fluid' or 'boundary' for I = J, and give "
               "I < J for two types",
               COEFF, arg[0], arg[1]);
}

void PairSPHTait::store_fluid_and_boundary(int ilo, int ihi, int jlo, int jhi, const TypeData &data,
                                           const PairData &own)
{
  int count = 0;
  for (int i = std::max(ilo, jlo); i <= std::min(ihi, jhi); i++) {
    types[i] = data;
    pairs[i * (atom->ntypes + 1) + i] = own;
    setflag[i][i] = 1;
    count++;
  }
  if (!count)
    error->all(FLERR, "{}: a role belongs to one type: give the same type twice (I = J)", COEFF);
}

PairSPHTait::TypeData PairSPHTait::read_fluid(ArgReader &args, PairData &own) const
{
  TypeData t;
  t.role = Role::FLUID;
  t.eos.rho0 = args.positive("rho0");
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "k" || keyword == "c0" || keyword == "fluctuation")
      t.eos.k = read_stiffness(args, keyword);
    else if (keyword == "gamma") {
      t.eos.gamma = args.number("gamma");
      if (!(t.eos.gamma > 1.0))
        args.fail("gamma", std::to_string(t.eos.gamma), "give a number > 1");
    } else if (keyword == "nu")
      t.nu = args.at_least("nu", 0.0);
    else if (keyword == "alpha")
      t.alpha = args.at_least("alpha", 0.0);
    else if (keyword == "support")
      own.support = args.positive("support");
    else
      args.unknown(keyword, "k, c0, fluctuation, gamma, nu, alpha, support");
  }
  if (t.eos.k == 0.0)
    error->all(FLERR, "{}: a fluid needs a stiffness: add 'k K', 'c0 C' or 'fluctuation ETA VREF'",
               COEFF);
  return t;
}

// k, or what it follows from

double PairSPHTait::read_stiffness(ArgReader &args, const std::string &keyword) const
{
  const double value = args.positive(keyword);
  if (keyword == "k") return value;
  if (keyword == "c0") return value * value;
  return Tait::stiffness_from_fluctuation(value, args.positive("fluctuation reference speed"));
}

PairSPHTait::TypeData PairSPHTait::read_boundary(ArgReader &args) const
{
  TypeData t;
  t.role = Role::BOUNDARY;
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword != "volume") args.unknown(keyword, "volume");
    if (std::strcmp(args.more() ? args.peek() : "", "auto") == 0) {
      args.word("volume");
      t.volume = 0.0;
    } else
      t.volume = args.positive("volume");
  }
  return t;
}

PairSPHTait::PairData PairSPHTait::read_pair(ArgReader &args) const
{
  PairData p;
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "k" || keyword == "c0" || keyword == "fluctuation")
      p.stiffness = read_stiffness(args, keyword);
    else if (keyword == "nu")
      p.nu = args.at_least("nu", 0.0);
    else if (keyword == "alpha")
      p.alpha = args.at_least("alpha", 0.0);
    else if (keyword == "support")
      p.support = args.positive("support");
    else
      args.unknown(keyword,
                   "k, c0, fluctuation, nu, alpha, support for two types, or fluid, "
                   "boundary for one type");
  }
  return p;
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
  if (atom->molecular != Atom::ATOMIC)
    for (int k = 1; k < 4; k++)
      if (force->special_lj[k] != 1.0 || force->special_coul[k] != 1.0)
        error->all(FLERR,
                   "{}: special_bonds would hide bonded neighbours from the sums: add "
                   "'special_bonds lj/coul 1.0 1.0 1.0'",
                   STYLE);
  neighbor->add_request(this, NeighConst::REQ_FULL);
  active = nullptr;    // until a fix says who is
  const auto found = modify->get_fix_by_style("^wall/sph$");
  walls = found.empty() ? nullptr : dynamic_cast<FixWallSPH *>(found[0]);

  switch (kernel) {
    case Kernel::WENDLAND_C2: bind_kernel<WendlandC2>(); break;
    case Kernel::CUBIC: bind_kernel<CubicSpline>(); break;
  }
  viscous = measure_volume = several_fluids = several_roles = false;
  support_sq.assign((atom->ntypes + 1) * (atom->ntypes + 1), 0.0);
  fluid_type.assign(atom->ntypes + 1, 0);
  single_fluid = 0;
  for (int i = 1; i <= atom->ntypes; i++) {
    if (types[i].role == Role::FLUID) {
      several_fluids = several_fluids || single_fluid != 0;
      if (!single_fluid) single_fluid = i;
      fluid_type[i] = 1;
    } else
      several_roles = true;
    if (types[i].role == Role::BOUNDARY && types[i].volume == 0.0) measure_volume = true;
  }
}

template <class K> void PairSPHTait::bind_kernel()
{
  volumes_fn = &PairSPHTait::volumes<K>;
  densities_fn = &PairSPHTait::densities<K>;
  forces_fn = &PairSPHTait::forces<K>;
  virial_fn = &PairSPHTait::tally_virial<K>;
}

double PairSPHTait::pair_support(int i, int j) const
{
  const int n = atom->ntypes + 1;
  const double said = pairs[std::min(i, j) * n + std::max(i, j)].support;
  if (said > 0.0) return said;
  if (i == j) return support_global;
  const bool fluid_i = types[i].role == Role::FLUID, fluid_j = types[j].role == Role::FLUID;
  if (fluid_i == fluid_j) return 0.5 * (pair_support(i, i) + pair_support(j, j));
  return fluid_i ? pair_support(i, i) : pair_support(j, j);
}

double PairSPHTait::support(int itype) const { return pair_support(itype, itype); }

double PairSPHTait::viscosity(int itype) const
{
  // Monaghan's alpha acts like nu = alpha c0 h_s / (2 (d + 2))
  const TypeData &t = types[itype];
  const double artificial =
      t.alpha * t.eos.sound_speed() * 0.5 * support(itype) / (2.0 * (domain->dimension + 2));
  return t.nu + artificial;
}

double PairSPHTait::lattice_sum(int itype, double spacing) const
{
  switch (kernel) {
    case Kernel::WENDLAND_C2: return kernel_lattice_sum<WendlandC2>(support(itype), spacing);
    case Kernel::CUBIC: return kernel_lattice_sum<CubicSpline>(support(itype), spacing);
  }
  return 0.0;
}

WallTable PairSPHTait::wall_table() const
{
  switch (kernel) {
    case Kernel::WENDLAND_C2: return sphcloth::wall_table<WendlandC2>(domain->dimension);
    case Kernel::CUBIC: return sphcloth::wall_table<CubicSpline>(domain->dimension);
  }
  return {};
}

template <class K> double PairSPHTait::kernel_lattice_sum(double support, double spacing) const
{
  const KernelScale s = kernel_scale<K>(support, domain->dimension);
  const int reach = static_cast<int>(support / spacing);
  const int reach_z = domain->dimension == 3 ? reach : 0;
  double sum = 0.0;
  for (int i = -reach; i <= reach; i++)
    for (int j = -reach; j <= reach; j++)
      for (int k = -reach_z; k <= reach_z; k++) {
        const double r = spacing * std::sqrt(static_cast<double>(i * i + j * j + k * k));
        if (r < support) sum += s.w * K::shape(r / support);
      }
  return sum;
}

PairSPHTait::Wetting PairSPHTait::wetting(int i) const
{
  Wetting w;
  const Neighbourhood near_i = neighbourhood(i);
  for (int k = 0; k < near_i.n_fluid; k++) {
    const Tait &eos = types[atom->type[near_i.fluid[k]]].eos;
    w.fluid_mass = std::max(w.fluid_mass, eos.rho0 * amount[i]);
    w.sound = std::max(w.sound, eos.sound_speed());
  }
  return w;
}

double PairSPHTait::init_one(int i, int j)
{
  const int n = atom->ntypes + 1;
  const double support = pair_support(i, j);
  if (comm->cutghostuser > 0.0 && comm->cutghostuser < support)
    error->all(FLERR,
               "{}: the ghost cut-off {} of comm_modify is smaller than the support {} of types {} "
               "and {}: raise it to the support plus the skin",
               STYLE, comm->cutghostuser, support, i, j);
  PairTerms &t = terms[i * n + j];
  switch (kernel) {
    case Kernel::WENDLAND_C2:
      t.kernel = kernel_scale<WendlandC2>(support, domain->dimension);
      break;
    case Kernel::CUBIC: t.kernel = kernel_scale<CubicSpline>(support, domain->dimension); break;
  }
  mix(i, j, t);
  terms[j * n + i] = t;
  support_sq[i * n + j] = support_sq[j * n + i] = t.kernel.support_sq;
  if (t.nu > 0.0 || t.monaghan > 0.0) viscous = true;

  // two boundary particles only meet to measure their volume
  const bool both_boundary = types[i].role == Role::BOUNDARY && types[j].role == Role::BOUNDARY;
  if (both_boundary && (i != j || types[i].volume > 0.0)) return 0.0;
  return support;
}

// What the user did not say of a pair: the mean of two fluids, the fluid's own at a boundary.

void PairSPHTait::mix(int i, int j, PairTerms &t) const
{
  const PairData &said = pairs[std::min(i, j) * (atom->ntypes + 1) + std::max(i, j)];
  const TypeData &a = types[i].role == Role::FLUID ? types[i] : types[j];
  const TypeData &b = types[j].role == Role::FLUID ? types[j] : a;
  const double smoothing = 0.5 * pair_support(i, j);
  const double alpha = said.alpha >= 0.0 ? said.alpha : 0.5 * (a.alpha + b.alpha);
  const double sound = 0.5 * (a.eos.sound_speed() + b.eos.sound_speed());
  t.nu = said.nu >= 0.0 ? said.nu : 0.5 * (a.nu + b.nu);
  t.monaghan = alpha * sound * smoothing;
  t.soft = 0.01 * smoothing * smoothing;
  t.rho0 = a.eos.rho0;
  t.stiffness = said.stiffness > 0.0 ? said.stiffness / a.eos.k : 1.0;
  if (said.stiffness > 0.0 && types[i].role == types[j].role)
    error->all(FLERR,
               "{}: a stiffness of pair {} {} is for a fluid and a boundary: give each fluid its "
               "own with I = J",
               COEFF, i, j);
}

/* ----------------------------------------------------------------------
   one evaluation: volumes of boundary particles, densities, pressures, forces
------------------------------------------------------------------------- */

void PairSPHTait::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  const bool new_lists = neighbor->ago == 0;
  if (new_lists) sort_by_role();
  if (measure_volume) (this->*volumes_fn)();
  if (new_lists || measure_volume) {
    stage = Stage::AMOUNT;
    comm->forward_comm(this, 1);
  }
  (this->*densities_fn)();
  if (walls) add_wall_densities();
  equation_of_state_all();
  stage = Stage::DENSITY;
  comm->forward_comm(this, 2);

  (this->*forces_fn)();
  if (walls) add_wall_forces();
  if (vflag_either) (this->*virial_fn)();
  if (eflag_either) tally_energy();
}

// Fixed until the next list build: roles, masses, room for the neighbours inside the support.

void PairSPHTait::sort_by_role()
{
  const int nlocal = atom->nlocal;
  const int *type = atom->type;
  amount.resize(atom->nmax);
  pressure.resize(atom->nmax);
  std::fill(pressure.begin(), pressure.end(), 0.0);
  for (int i = 0; i < nlocal; i++) {
    const TypeData &t = types[type[i]];
    if (t.role == Role::BOUNDARY)
      amount[i] = t.volume;
    else
      amount[i] = atom_mass(atom, i);
  }

  fluid.clear();
  boundary.clear();
  near_start.resize(nlocal);
  near_fluid.assign(nlocal, 0);
  near_boundary.assign(nlocal, 0);
  std::int64_t total = 0;
  int most = 0;
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    (types[type[i]].role == Role::FLUID ? fluid : boundary).push_back(i);
    near_start[i] = total;
    total += list->numneigh[i];
    most = std::max(most, list->numneigh[i]);
  }
  near.resize(total);
  near_rsq.resize(most);
}

ParticleView PairSPHTait::view() const
{
  return {atom->nmax ? atom->x[0] : nullptr,
          atom->nmax ? atom->v[0] : nullptr,
          amount.data(),
          atom->rho,
          pressure.data(),
          atom->type};
}

Neighbourhood PairSPHTait::neighbourhood(int i) const
{
  const int *front = near.data() + near_start[i];
  const int *back = front + list->numneigh[i] - near_boundary[i];
  return {front, back, near_fluid[i], near_boundary[i]};
}

// Keeps those neighbours of i that are inside the support: fluid at the front of i's stretch,
// boundary at its back, squared distances in near_rsq likewise.  Every neighbour is written and the
// cursor moves only past the wanted ones: whether one is inside is a coin toss that no branch
// predictor wins.

void PairSPHTait::gather_near(int i, bool want_fluid, bool want_boundary)
{
  const int *type = atom->type;
  const double *x = atom->x[0];
  const double *cut = &support_sq[type[i] * (atom->ntypes + 1)];
  const double xi = x[3 * i], yi = x[3 * i + 1], zi = x[3 * i + 2];
  const int *jlist = list->firstneigh[i];
  const int jnum = list->numneigh[i];
  int *out = near.data() + near_start[i];
  int front = 0, back = jnum;
  for (int jj = 0; jj < jnum; jj++) {
    const int j = jlist[jj] & NEIGHMASK;
    const int t = type[j];
    const double dx = xi - x[3 * j], dy = yi - x[3 * j + 1], dz = zi - x[3 * j + 2];
    const double rsq = dx * dx + dy * dy + dz * dz;
    const bool inside = rsq < cut[t], fluid_j = fluid_type[t];
    near_rsq[front] = rsq;
    out[front] = j;
    front += inside & fluid_j & want_fluid;
    if (several_roles && (inside & !fluid_j & want_boundary)) behind.push_back({j, rsq});
  }
  for (const auto &[j, rsq] : behind) {
    out[--back] = j;
    near_rsq[back] = rsq;
  }
  behind.clear();
  near_fluid[i] = front;
  near_boundary[i] = jnum - back;
}

// V_b = 1 / sum_k W_bk over the boundary particles of the same type, with itself

template <class K> void PairSPHTait::volumes()
{
  for (int i : boundary) {
    const int itype = atom->type[i];
    if (types[itype].volume > 0.0) continue;
    gather_near(i, false, true);
    const PairTerms &t = terms[itype * (atom->ntypes + 1) + itype];
    const Neighbourhood near_i = neighbourhood(i);
    double sum = t.kernel.w * K::shape(0.0);
    for (int k = 0; k < near_i.n_boundary; k++) {
      if (atom->type[near_i.boundary[k]] != itype) continue;
      const double rsq = near_rsq[list->numneigh[i] - near_i.n_boundary + k];
      sum += t.kernel.w * K::shape(std::sqrt(rsq) * t.kernel.inv_support);
    }
    amount[i] = 1.0 / sum;
  }
}

template <class K> void PairSPHTait::densities()
{
  const int n = atom->ntypes + 1;
  const ParticleView p = view();
  for (int i : fluid) {
    if (!is_active(i)) continue;
    gather_near(i, true, true);
    const int itype = atom->type[i];
    const PairTerms *row = &terms[itype * n];
    const Neighbourhood near_i = neighbourhood(i);
    double rho = amount[i] * row[itype].kernel.w * K::shape(0.0);
    if (several_fluids)
      rho += kernel_sum<K, true>(p, row, near_rsq.data(), near_i.fluid, near_i.n_fluid);
    else
      rho +=
          kernel_sum<K, false>(p, fluid_terms(row), near_rsq.data(), near_i.fluid, near_i.n_fluid);
    if (near_i.n_boundary) {
      const double *rsq = near_rsq.data() + list->numneigh[i] - near_i.n_boundary;
      rho += types[itype].eos.rho0 *
          kernel_sum<K, true>(p, row, rsq, near_i.boundary, near_i.n_boundary);
    }
    atom->rho[i] = rho;
  }
}

void PairSPHTait::add_wall_densities()
{
  walls->begin();
  for (int i : fluid)
    if (is_active(i)) atom->rho[i] += walls->density(i);
}

void PairSPHTait::add_wall_forces()
{
  for (int i : fluid)
    if (is_active(i)) walls->push(i, pressure[i]);
}

void PairSPHTait::equation_of_state_all()
{
  for (int i : fluid) {
    if (!is_active(i)) continue;
    const double rho = atom->rho[i];
    double p = types[atom->type[i]].eos.pressure(rho);
    if (!std::isfinite(p))
      error->one(FLERR,
                 "{}: particle {} has density {}: particles overlap or the time step is too large",
                 STYLE, atom->tag[i], rho);
    if (!keep_tension) p = std::max(p, 0.0);
    pressure[i] = p / (rho * rho);
  }
}

template <class K> void PairSPHTait::forces()
{
  for (int i : fluid) {
    if (!is_active(i)) continue;
    const Acceleration a = viscous ? on_fluid<K, true, false>(i) : on_fluid<K, false, false>(i);
    atom->drho[i] += a.drho;
    add_force(i, a);
  }
  for (int i : boundary) {
    gather_near(i, true, false);
    if (!near_fluid[i]) continue;
    add_force(i, viscous ? on_boundary<K, true, false>(i) : on_boundary<K, false, false>(i));
  }
}

// Only on steps that ask for it, and beside the forces: what is printed must not change, not even
// in the last bit, what is computed.

template <class K> void PairSPHTait::tally_virial()
{
  for (int i : fluid)
    add_virial(i, viscous ? on_fluid<K, true, true>(i) : on_fluid<K, false, true>(i));
  for (int i : boundary)
    if (near_fluid[i])
      add_virial(i, viscous ? on_boundary<K, true, true>(i) : on_boundary<K, false, true>(i));
}

// on a fluid particle, per mass

template <class K, bool VISCOUS, bool VIRIAL> Acceleration PairSPHTait::on_fluid(int i) const
{
  const ParticleView p = view();
  const PairTerms *row = &terms[atom->type[i] * (atom->ntypes + 1)];
  const Neighbourhood near_i = neighbourhood(i);
  Acceleration a;
  if (several_fluids)
    fluid_on_fluid<K, VISCOUS, true, VIRIAL>(p, row, i, near_i.fluid, near_i.n_fluid, a);
  else
    fluid_on_fluid<K, VISCOUS, false, VIRIAL>(p, fluid_terms(row), i, near_i.fluid, near_i.n_fluid,
                                              a);
  if (near_i.n_boundary)
    across_boundary<K, VISCOUS, false, VIRIAL>(p, row, i, near_i.boundary, near_i.n_boundary, a);
  return a;
}

// on a boundary particle, per volume

template <class K, bool VISCOUS, bool VIRIAL> Acceleration PairSPHTait::on_boundary(int i) const
{
  const Neighbourhood near_i = neighbourhood(i);
  Acceleration a;
  across_boundary<K, VISCOUS, true, VIRIAL>(view(), &terms[atom->type[i] * (atom->ntypes + 1)], i,
                                            near_i.fluid, near_i.n_fluid, a);
  return a;
}

void PairSPHTait::add_force(int i, const Acceleration &a)
{
  const double scale = amount[i] / force->ftm2v;
  atom->f[i][0] += scale * a.x;
  atom->f[i][1] += scale * a.y;
  atom->f[i][2] += scale * a.z;
}

void PairSPHTait::add_virial(int i, const Acceleration &a)
{
  const double scale = amount[i] * force->mvv2e;
  for (int m = 0; m < 6; m++) {
    if (vflag_global) virial[m] += scale * a.virial[m];
    if (vflag_atom) vatom[i][m] += scale * a.virial[m];
  }
}

// internal energy of the fluid: what compression has stored

void PairSPHTait::tally_energy()
{
  for (int i : fluid) {
    const Tait &eos = types[atom->type[i]].eos;
    const double rho = atom->rho[i];
    if (rho < eos.rho0 && !keep_tension) continue;
    const double e = amount[i] * eos.energy(rho) * force->mvv2e;
    if (eflag_global) eng_vdwl += e;
    if (eflag_atom) eatom[i] += e;
  }
}

/* ----------------------------------------------------------------------
   ghosts: mass or volume, then density and pressure of fluid
------------------------------------------------------------------------- */

int PairSPHTait::pack_forward_comm(int n, int *sendlist, double *buf, int, int *)
{
  int m = 0;
  if (stage == Stage::AMOUNT) {
    for (int k = 0; k < n; k++) buf[m++] = amount[sendlist[k]];
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
  for (int i = first; i < first + n; i++) {
    atom->rho[i] = buf[m++];
    pressure[i] = buf[m++];
  }
}

/* ----------------------------------------------------------------------
   restart: settings and coefficients, as the user gave them
------------------------------------------------------------------------- */

void PairSPHTait::write_restart_settings(FILE *fp)
{
  fwrite(&support_global, sizeof(double), 1, fp);
  fwrite(&kernel, sizeof(Kernel), 1, fp);
  fwrite(&keep_tension, sizeof(int), 1, fp);
}

void PairSPHTait::read_restart_settings(FILE *fp)
{
  if (comm->me == 0) {
    utils::sfread(FLERR, &support_global, sizeof(double), 1, fp, nullptr, error);
    utils::sfread(FLERR, &kernel, sizeof(Kernel), 1, fp, nullptr, error);
    utils::sfread(FLERR, &keep_tension, sizeof(int), 1, fp, nullptr, error);
  }
  MPI_Bcast(&support_global, 1, MPI_DOUBLE, 0, world);
  MPI_Bcast(&kernel, sizeof(Kernel), MPI_BYTE, 0, world);
  MPI_Bcast(&keep_tension, 1, MPI_INT, 0, world);
}

void PairSPHTait::write_restart(FILE *fp)
{
  write_restart_settings(fp);
  const int n = atom->ntypes + 1;
  fwrite(types.data(), sizeof(TypeData), n, fp);
  fwrite(pairs.data(), sizeof(PairData), n * n, fp);
  for (int i = 1; i < n; i++) fwrite(&setflag[i][i], sizeof(int), n - i, fp);
}

void PairSPHTait::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  allocate();
  const int n = atom->ntypes + 1;
  if (comm->me == 0) {
    utils::sfread(FLERR, types.data(), sizeof(TypeData), n, fp, nullptr, error);
    utils::sfread(FLERR, pairs.data(), sizeof(PairData), n * n, fp, nullptr, error);
    for (int i = 1; i < n; i++)
      utils::sfread(FLERR, &setflag[i][i], sizeof(int), n - i, fp, nullptr, error);
  }
  MPI_Bcast(types.data(), n * sizeof(TypeData), MPI_BYTE, 0, world);
  MPI_Bcast(pairs.data(), n * n * sizeof(PairData), MPI_BYTE, 0, world);
  for (int i = 1; i < n; i++) MPI_Bcast(&setflag[i][i], n - i, MPI_INT, 0, world);
}

double PairSPHTait::memory_usage()
{
  return Pair::memory_usage() + sizeof(double) * (amount.capacity() + pressure.capacity()) +
      sizeof(int) * (near.capacity() + near_fluid.capacity() + near_boundary.capacity()) +
      sizeof(std::int64_t) * near_start.capacity();
}
