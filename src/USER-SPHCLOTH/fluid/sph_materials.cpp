// SPDX-License-Identifier: GPL-2.0-or-later
// pair_style sph/tait and its pair_coeff: reading, mixing, restart.

#include "fluid/sph_materials.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/restart_record.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace sphcloth;

static const std::string STYLE = "pair_style sph/tait";
static const std::string COEFF = "pair_coeff (sph/tait)";

static const std::vector<std::string> PRESSURES = {"own", "mirror", "extrapolate"};

void SPHMaterials::allocate()
{
  const int n = atom->ntypes + 1;
  types.assign(n, TypeData());
  pairs.assign(n * n, PairData());
  forget_pair_values();
}

const SPHMaterials::PairData &SPHMaterials::given(int i, int j) const
{
  return pairs[std::min(i, j) * (atom->ntypes + 1) + std::max(i, j)];
}

/* ----------------------------------------------------------------------
   pair_style sph/tait H keyword value ...
------------------------------------------------------------------------- */

void SPHMaterials::read_options(int narg, char **arg)
{
  ArgReader args(lmp, STYLE, narg, arg);
  forget_pair_values();
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
      options.density =
          static_cast<Density>(args.choice(keyword, {"summation", "continuity", "calibrated"}));
    else if (keyword == "delta")
      options.delta = args.at_least(keyword, 0.0);
    else if (keyword == "reinit")
      options.reinit = args.integer(keyword, 0, 1000000000);
    else if (keyword == "surface")
      options.surface = args.choice(keyword, {"no", "yes"});
    else
      args.unknown(keyword, "kernel, tension, precision, density, delta, reinit, surface");
  }
  if (completes_surfaces() && integrates_density())
    error->all(FLERR,
               "{}: surface is 'yes', which completes a sum, but 'density continuity' has no "
               "deficit at a free surface: leave out one of them",
               STYLE);
}

/* ----------------------------------------------------------------------
   pair_coeff I I fluid rho0 ... | pair_coeff I I boundary ... | pair_coeff I J keyword ...
------------------------------------------------------------------------- */

void SPHMaterials::read(int narg, char **arg, int **setflag)
{
  forget_pair_values();
  if (narg < 3) utils::missing_cmd_args(FLERR, COEFF, error);
  const int n = atom->ntypes + 1;
  ArgReader args(lmp, COEFF, narg, arg);
  const auto [ilo, ihi] = args.range("first type", atom->ntypes);
  const auto [jlo, jhi] = args.range("second type", atom->ntypes);

  const std::string role = arg[2];
  const bool of_type = role == "fluid" || role == "boundary" || role == "none";
  TypeData data;
  PairData pair;
  if (of_type) {
    args.word("role");
    if (role == "fluid") data = read_fluid(args, pair);
    if (role == "boundary") data = read_boundary(args);
    args.end();
  } else
    pair = read_pair(args);

  int count = 0;
  for (int i = ilo; i <= ihi; i++)
    for (int j = std::max(jlo, i); j <= jhi; j++) {
      if ((i == j) != of_type) continue;
      if (of_type) {
        data.lattice_mass = types[i].lattice_mass;
        types[i] = data;
      }
      pairs[i * n + j] = pair;
      setflag[i][j] = 1;
      count++;
    }
  if (count) return;
  if (of_type)
    error->all(FLERR, "{}: a role belongs to one type: give the same type twice (I = J)", COEFF);
  error->all(
      FLERR,
      "{}: pair {} {} has no role: start with 'fluid', 'boundary' or 'none' for I = J, and give "
      "I < J for two types",
      COEFF, arg[0], arg[1]);
}

// c0 follow MIN MAX, mach M

static SoundBounds read_sound_bounds(ArgReader &args)
{
  SoundBounds of;
  args.word("follow");
  of.min = args.positive("c0 follow MIN");
  of.max = args.positive("c0 follow MAX");
  if (!(of.min < of.max))
    args.fail("c0 follow MAX", fmt::format("{}", of.max),
              fmt::format("give more than MIN, which is {}", of.min));
  if (!args.more() || std::strcmp(args.peek(), "mach") != 0) return of;
  args.word("mach");
  of.mach = args.positive("c0 follow mach");
  if (of.mach > 1.0)
    args.fail("c0 follow mach", fmt::format("{}", of.mach), "give a number up to 1, as 0.1");
  return of;
}

// k, c0 and fluctuation are the start where the speed of sound follows the flow.

static void start_sound(ArgReader &args, SPHMaterials::TypeData &t)
{
  if (t.eos.k == 0.0) t.eos.k = t.sound.max * t.sound.max;
  const double start = t.eos.sound_speed();
  constexpr double ROUNDING = 1e-9;
  if (start < t.sound.min * (1.0 - ROUNDING) || start > t.sound.max * (1.0 + ROUNDING))
    args.fail("c0 follow", fmt::format("{} {}", t.sound.min, t.sound.max),
              fmt::format("the speed of sound at the start, {:.8g}, must be within", start));
}

SPHMaterials::TypeData SPHMaterials::read_fluid(ArgReader &args, PairData &pair) const
{
  TypeData t;
  t.role = Role::FLUID;
  t.eos.rho0 = args.positive("rho0");
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "c0" && args.more() && std::strcmp(args.peek(), "follow") == 0)
      t.sound = read_sound_bounds(args);
    else if (keyword == "k" || keyword == "c0" || keyword == "fluctuation")
      t.eos.k = read_stiffness(args, keyword);
    else if (keyword == "gamma") {
      t.eos.gamma = args.number("gamma");
      if (!(t.eos.gamma > 1.0))
        args.fail("gamma", std::to_string(t.eos.gamma), "give a number > 1");
    } else if (keyword == "nu")
      t.nu = args.at_least("nu", 0.0);
    else if (keyword == "alpha")
      t.alpha = args.at_least("alpha", 0.0);
    else if (keyword == "switch")
      t.floor = args.fraction("switch");
    else if (keyword == "support")
      pair.support = args.positive("support");
    else if (keyword == "spacing")
      t.spacing = args.positive("spacing");
    else
      args.unknown(keyword, "k, c0, fluctuation, gamma, nu, alpha, switch, support, spacing");
  }
  if (t.sound.follows())
    start_sound(args, t);
  else if (t.eos.k == 0.0)
    error->all(FLERR,
               "{}: a fluid needs a stiffness: add 'k K', 'c0 C', 'fluctuation ETA VREF' or 'c0 "
               "follow MIN MAX'",
               COEFF);
  return t;
}

// k, or what it follows from

double SPHMaterials::read_stiffness(ArgReader &args, const std::string &keyword) const
{
  const double value = args.positive(keyword);
  if (keyword == "k") return value;
  if (keyword == "c0") return value * value;
  return Tait::stiffness_from_fluctuation(value, args.positive("fluctuation reference speed"));
}

SPHMaterials::TypeData SPHMaterials::read_boundary(ArgReader &args) const
{
  TypeData t;
  t.role = Role::BOUNDARY;
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "volume" && args.more() && std::strcmp(args.peek(), "auto") == 0) {
      args.word("volume");
      t.volume = 0.0;
    } else if (keyword == "volume")
      t.volume = args.positive("volume");
    else if (keyword == "pressure")
      t.pressure = static_cast<Pressure>(args.choice(keyword, PRESSURES));
    else
      args.unknown(keyword, "volume, pressure");
  }
  return t;
}

SPHMaterials::PairData SPHMaterials::read_pair(ArgReader &args) const
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

/* ----------------------------------------------------------------------
   what follows for a pair
------------------------------------------------------------------------- */

double SPHMaterials::find_support(int i, int j) const
{
  if (given(i, j).support > 0.0) return given(i, j).support;
  if (i == j) return options.support;
  if (is_fluid(i) == is_fluid(j)) return 0.5 * (support(i, i) + support(j, j));
  return is_fluid(i) ? support(i, i) : support(j, j);
}

static double rho0_ratio(const SPHMaterials::TypeData &a, const SPHMaterials::TypeData &b)
{
  return a.eos.rho0 / b.eos.rho0;
}

// If all pairs approach each other Monaghan's alpha acts like nu = alpha c0 h_s / (2 (d + 2)).

double SPHMaterials::viscosity(int i, int j) const
{
  const double smoothing = 0.5 * support(i, j);
  return nu(i, j) + alpha(i, j) * sound(i, j) * smoothing / (2.0 * (domain->dimension + 2));
}

double SPHMaterials::find_viscosity(int i) const
{
  double largest = viscosity(i, i);
  for (int j = 1; j < static_cast<int>(types.size()); j++) {
    const double heavier = is_fluid(j) ? std::max(1.0, rho0_ratio(types[j], types[i])) : 1.0;
    if (given(i, j).nu >= 0.0 || given(i, j).alpha >= 0.0 || heavier > 1.0)
      largest = std::max(largest, 0.5 * (1.0 + heavier) * viscosity(i, j));
  }
  return largest;
}

double SPHMaterials::pressure_factor(int fluid, int boundary) const
{
  const double stiffness = given(fluid, boundary).stiffness;
  return stiffness > 0.0 ? stiffness / types[fluid].eos.k : 1.0;
}

double SPHMaterials::largest_pressure_factor(int fluid) const
{
  double largest = 1.0;
  for (int j = 1; j < static_cast<int>(types.size()); j++)
    if (is_boundary(j)) largest = std::max(largest, pressure_factor(fluid, j));
  return largest;
}

double SPHMaterials::sound(int i, int j) const
{
  return 0.5 * (fluid_of(i, j).eos.sound_speed() + fluid_of(j, i).eos.sound_speed());
}

bool SPHMaterials::sound_follows() const
{
  return std::any_of(types.begin(), types.end(),
                     [](const TypeData &t) { return t.sound.follows(); });
}

void SPHMaterials::cache_pair_values()
{
  forget_pair_values();
  const int n = static_cast<int>(types.size());
  std::vector<double> radii(n * n, 0.0), nus(n, 0.0);
  for (int i = 1; i < n; i++) {
    if (is_fluid(i)) nus[i] = find_viscosity(i);
    for (int j = 1; j < n; j++) radii[i * n + j] = find_support(i, j);
  }
  supports = std::move(radii);
  viscosities = std::move(nus);
}

void SPHMaterials::forget_pair_values()
{
  supports.clear();
  viscosities.clear();
}

// Coefficients of a pair that are not given: the mean of two fluids, the fluid's own at a boundary.

double SPHMaterials::nu(int i, int j) const
{
  const double nu = given(i, j).nu;
  return nu >= 0.0 ? nu : 0.5 * (fluid_of(i, j).nu + fluid_of(j, i).nu);
}

double SPHMaterials::alpha(int i, int j) const
{
  const double alpha = given(i, j).alpha;
  return alpha >= 0.0 ? alpha : 0.5 * (fluid_of(i, j).alpha + fluid_of(j, i).alpha);
}

PairTerms SPHMaterials::mix(int i, int j) const
{
  const PairData &of_pair = given(i, j);
  const TypeData &a = fluid_of(i, j);
  if (of_pair.stiffness > 0.0 && types[i].role == types[j].role)
    error->all(FLERR,
               "{}: a stiffness of pair {} {} is for a fluid and a boundary: give each fluid its "
               "own with I = J",
               COEFF, i, j);
  if (of_pair.stiffness > 0.0 && a.sound.follows())
    error->all(FLERR,
               "{}: a stiffness of pair {} {} is a multiple of that of the fluid, whose c0 follows "
               "the flow: leave it out",
               COEFF, i, j);

  PairTerms t;
  const double radius = support(i, j), smoothing = 0.5 * radius;
  t.kernel = with_kernel(
      options.kernel, [&](auto k) { return kernel_scale<decltype(k)>(radius, domain->dimension); });
  t.nu = nu(i, j);
  t.monaghan = alpha(i, j) * sound(i, j) * smoothing;
  t.soft = 0.01 * smoothing * smoothing;
  t.rho0 = a.eos.rho0;
  if (is_fluid(i) && is_fluid(j)) {
    t.rho0_ratio = rho0_ratio(types[i], types[j]);
    return t;
  }
  t.stiffness = is_fluid(i) ? pressure_factor(i, j) : pressure_factor(j, i);
  for (int k : {i, j})
    if (is_boundary(k) && types[k].pressure == Pressure::MIRROR) t.stiffness *= 2.0;
  // the mean of the fluid around a boundary particle follows the fluid that moves
  const double extrapolated = extrapolates(i) || extrapolates(j) ? 2.0 : 1.0;
  t.response = std::sqrt(extrapolated * t.stiffness);
  return t;
}

double SPHMaterials::reach(int i, int j) const
{
  if (types[i].role == Role::NONE || types[j].role == Role::NONE) return 0.0;
  // boundary particles only meet to measure their volume
  if (is_boundary(i) && is_boundary(j) && (i != j || types[i].volume > 0.0)) return 0.0;
  return support(i, j);
}

double SPHMaterials::acting_pressure(const Tait &eos, double rho) const
{
  const double p = eos.pressure(rho);
  return options.tension ? p : std::max(p, 0.0);
}

double SPHMaterials::stored_energy(const Tait &eos, double rho) const
{
  return rho < eos.rho0 && !options.tension ? 0.0 : eos.energy(rho);
}

WallTable SPHMaterials::wall_table() const
{
  return with_kernel(options.kernel, [&](auto kernel) {
    return sphcloth::wall_table<decltype(kernel)>(domain->dimension);
  });
}

WallImpact SPHMaterials::wall_impact() const
{
  return with_kernel(options.kernel, [&](auto kernel) {
    return sphcloth::wall_impact<decltype(kernel)>(domain->dimension);
  });
}

/* ----------------------------------------------------------------------
   restart and data files
------------------------------------------------------------------------- */

void SPHMaterials::write_options(FILE *fp) const
{
  const RecordHead head{RECORD_MARK, sizeof(Options)};
  fwrite(&head, sizeof(head), 1, fp);
  fwrite(&options, sizeof(Options), 1, fp);
}

void SPHMaterials::read_options(FILE *fp)
{
  RecordHead head;
  if (comm->me == 0) {
    utils::sfread(FLERR, &head, sizeof(head), 1, fp, nullptr, error);
    utils::sfread(FLERR, &options, sizeof(Options), 1, fp, nullptr, error);
  }
  MPI_Bcast(&head, sizeof(head), MPI_BYTE, 0, world);
  MPI_Bcast(&options, sizeof(Options), MPI_BYTE, 0, world);
  if (head.mark != RECORD_MARK || head.bytes != sizeof(Options) ||
      std::find(std::begin(ALL_KERNELS), std::end(ALL_KERNELS), options.kernel) ==
          std::end(ALL_KERNELS) ||
      !(options.support > 0.0))
    error->all(FLERR,
               "{}: its settings in the restart file are damaged, or of another release of "
               "sphcloth: take another file",
               STYLE);
  forget_pair_values();
}

void SPHMaterials::write_restart(FILE *fp) const
{
  fwrite(types.data(), sizeof(TypeData), types.size(), fp);
  fwrite(pairs.data(), sizeof(PairData), pairs.size(), fp);
}

void SPHMaterials::read_restart(FILE *fp)
{
  allocate();
  if (comm->me == 0) {
    utils::sfread(FLERR, types.data(), sizeof(TypeData), types.size(), fp, nullptr, error);
    utils::sfread(FLERR, pairs.data(), sizeof(PairData), pairs.size(), fp, nullptr, error);
  }
  MPI_Bcast(types.data(), static_cast<int>(types.size() * sizeof(TypeData)), MPI_BYTE, 0, world);
  MPI_Bcast(pairs.data(), static_cast<int>(pairs.size() * sizeof(PairData)), MPI_BYTE, 0, world);
}

// All digits, so that a data file gives the same forces.  Data files want a line for every pair; a
// stiffness is there only if it was given, for there is none to mix.

std::string SPHMaterials::words(int i, int j, bool state) const
{
  const auto only_if = [](double value, const char *keyword) {
    return value > 0.0 ? fmt::format(" {} {}", keyword, value) : "";
  };
  const TypeData &t = types[i];
  const PairData &of_pair = given(i, j);
  if (i != j)
    return fmt::format("support {} nu {} alpha {}", support(i, j), nu(i, j), alpha(i, j)) +
        only_if(of_pair.stiffness, "k");
  if (t.role == Role::NONE) return "none";
  if (is_boundary(i))
    return "boundary pressure " + PRESSURES[static_cast<int>(t.pressure)] +
        only_if(t.volume, "volume");
  std::string stiffness = fmt::format("k {}", t.eos.k);
  if (t.sound.follows()) {
    const std::string bounds =
        fmt::format("c0 follow {} {} mach {}", t.sound.min, t.sound.max, t.sound.mach);
    stiffness = state ? stiffness + " " + bounds : bounds;
  }
  return fmt::format("fluid {} {} gamma {} nu {} alpha {}", t.eos.rho0, stiffness, t.eos.gamma,
                     t.nu, t.alpha) +
      (t.floor < 1.0 ? fmt::format(" switch {}", t.floor) : "") +
      only_if(of_pair.support, "support") + (atom->rmass ? only_if(t.spacing, "spacing") : "");
}
