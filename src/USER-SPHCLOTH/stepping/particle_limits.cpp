// SPDX-License-Identifier: GPL-2.0-or-later
// The longest time step that each fluid particle and each vertex of a cloth allows.

#include "stepping/particle_limits.h"

#include "core/sph/mass_scaling.h"
#include "core/timestep/motion_states.h"
#include "domain.h"
#include "fluid/fluid_boundary.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "group.h"
#include "lammps_util/atom_tools.h"
#include "modify.h"
#include "neighbor.h"
#include "stepping/stability_watch.h"

#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace sphcloth;

void ParticleLimits::init(FluidState *style, SteppingScheme scheme)
{
  fluid = style;
  lambda = options.lambda;
  if (scheme == SteppingScheme::GLOBAL) lambda.stability = 0.0;
  asks_neighbors = scheme != SteppingScheme::GLOBAL;
  interpolates_density = scheme == SteppingScheme::INDIVIDUAL;
  types.assign(atom->ntypes + 1, FluidType());
  for (auto *of_types : {&motion.support, &motion.rounding})
    of_types->assign(atom->ntypes + 1, 0.0);
  // what is no fluid is never in free flight
  motion.rest.assign(atom->ntypes + 1, -std::numeric_limits<double>::infinity());
  take_materials();
  cloths.clear();
  for (Fix *fix : modify->get_fix_by_style("^pbd/cloth$"))
    cloths.push_back({fix, dynamic_cast<LimitedVertices *>(fix)});

  if (scheme == SteppingScheme::CONSTANT) {
    if (options.scales_mass(scheme)) fluid->want_frequencies(this);
    return;
  }
  fluid->want_density_rate();
  if (lambda.relative > 0.0) fluid->want_approach();
  if (options.lambda.stability > 0.0) {
    fluid->want_frequencies(this);
    if (scheme == SteppingScheme::GLOBAL) fluid->want_shares_under_pressure(true);
  } else if (!cloths.empty())
    fluid->want_wetting();
}

void ParticleLimits::take_materials()
{
  for (int t = 1; t <= atom->ntypes; t++) {
    FluidType &its = types[t];
    motion.support[t] = fluid->support(t);
    if (!fluid->is_fluid(t)) continue;
    its.eos = fluid->equation_of_state(t);
    its.sound = its.eos.sound_speed();
    its.at_boundary = std::sqrt(fluid->largest_pressure_factor(t));
    its.viscosity = fluid->viscosity(t);
    motion.rest[t] = fluid->flight_density(t);
    motion.rounding[t] = fluid->density_rounding(t);
  }
}

double ParticleLimits::inverse_mass_of(int i) const
{
  for (const Cloth &cloth : cloths)
    if (atom->mask[i] & cloth.fix->groupbit) return cloth.vertices->inverse_mass(i);
  return 0.0;
}

// Others of this package wake water where they act, and some of LAMMPS, as those that it defines
// itself, move nothing though they are called where forces and positions change.

static bool may_hold(const Fix *fix, int mask)
{
  if (!(mask & (INITIAL_INTEGRATE | POST_INTEGRATE | PRE_EXCHANGE | POST_FORCE))) return false;
  const auto is = [fix](const char *pattern) { return utils::strmatch(fix->style, pattern); };
  return !is("^sph/") && !is("^balance$") && !is("^store/") && !is("^[A-Z]");
}

std::uint64_t ParticleLimits::fixes_that_hold(bool told_by_id) const
{
  std::uint64_t sum = EMPTY_HASH;
  for (int k = 0; k < modify->nfix; k++) {
    const Fix *fix = modify->fix[k];
    if (!may_hold(fix, modify->fmask[k])) continue;
    std::uint64_t hash = hash_with(EMPTY_HASH, std::string_view(fix->style));
    hash = hash_with(hash, std::string_view(group->names[fix->igroup]));
    sum += told_by_id ? hash_with(hash, std::string_view(fix->id)) : hash;
  }
  return sum;
}

std::uint64_t ParticleLimits::settings() const
{
  std::uint64_t hash = hash_with(EMPTY_HASH, static_cast<std::uint64_t>(fluid->options.kernel));
  hash = hash_with(hash, bits_of(fluid->options.support));
  for (int i = 1; i <= atom->ntypes; i++) {
    if (atom->mass) hash = hash_with(hash, bits_of(atom->mass[i]));
    for (int j = i; j <= atom->ntypes; j++)
      hash = hash_with(hash, std::string_view(fluid->words(i, j)));
  }
  // sums, in which particles may stand in any order
  std::uint64_t mine = 0, of_ranks;
  for_moving_vertices([&](int i, const LimitedVertices &) {
    mine += hash_with(EMPTY_HASH, static_cast<std::uint64_t>(atom->tag[i]));
  });
  for (int i = 0; i < atom->nlocal; i++)
    mine += hash_with(hash_with(EMPTY_HASH, bits_of(atom_mass(atom, i))),
                      static_cast<std::uint64_t>(atom->type[i]));
  MPI_Allreduce(&mine, &of_ranks, 1, MPI_UINT64_T, MPI_SUM, world);
  for (const FluidBoundary *boundary : find_fluid_boundaries(modify))
    hash = hash_with(hash, boundary->settings());
  hash = hash_with(hash, fixes_that_hold(false));
  for (int k = 0; k < neighbor->nex_type; k++)
    for (const int type : {neighbor->ex1_type[k], neighbor->ex2_type[k]})
      hash = hash_with(hash, static_cast<std::uint64_t>(type));
  // a box that a fix deforms is another one in each step
  const auto &fixes = modify->get_fix_list();
  const auto deforms = [](const Fix *fix) { return fix->box_change & ~Fix::BOX_CHANGE_DOMAIN; };
  if (std::none_of(fixes.begin(), fixes.end(), deforms)) {
    for (int d = 0; d < 3; d++)
      if (domain->periodicity[d]) hash = hash_with(hash, bits_of(domain->prd[d]));
    for (const double tilt : {domain->xy, domain->xz, domain->yz})
      hash = hash_with(hash, bits_of(tilt));
  }
  for (const std::uint64_t number :
       {of_ranks, static_cast<std::uint64_t>(atom->natoms), bits_of(options.lambda.stability)})
    hash = hash_with(hash, number);
  return hash;
}

double ParticleLimits::shortest_sound_time() const
{
  double shortest = std::numeric_limits<double>::infinity();
  for (int t = 1; t <= atom->ntypes; t++)
    if (fluid->is_fluid(t)) shortest = std::min(shortest, 0.5 * motion.support[t] / types[t].sound);
  return shortest;
}

double ParticleLimits::sound_time(int i) const
{
  const int type = atom->type[i];
  return motion.support[type] / types[type].sound;
}

double ParticleLimits::acceleration(int i, double by_force) const
{
  return by_force * force->ftm2v / atom_mass(atom, i);
}

/* ----------------------------------------------------------------------
   fluid particles
------------------------------------------------------------------------- */

void ParticleLimits::find(const int *particles, int n, const Rates &rates, StepLimits &limits) const
{
  StepStates states;
  find_motions(particles, n, rates, states);
  if (lambda.motion_alone()) return motion_limits(lambda, states, n, limits);
  for (int k = 0; k < n; k++) add_pressure(particles[k], k, rates, states);
  particle_limits(lambda, states, n, limits);
}

// of velocities, forces and rates of the density

void ParticleLimits::find_motions(const int *particles, int n, const Rates &rates,
                                  StepStates &states) const
{
  const double *drho = rates.density ? rates.density : atom->drho;
  const bool of_types = !atom->rmass;
  const double *const *external = rates.accel_sq ? nullptr : rates.external;
  find_motion_states({atom->type, atom->v[0], atom->f[0], atom->rho, drho, external,
                      of_types ? atom->mass : atom->rmass, of_types, motion.support.data(),
                      motion.rest.data(), motion.rounding.data(), force->ftm2v, lambda.density,
                      !interpolates_density},
                     particles, n, states);
  if (rates.accel_sq)
    for (int k = 0; k < n; k++) states.accel_sq[k] = rates.accel_sq[particles[k]];
}

double ParticleLimits::acceleration_sq(int i, const double *f) const
{
  const double to_accel = force->ftm2v / atom_mass(atom, i);
  return to_accel * to_accel * (f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
}

inline void ParticleLimits::add_pressure(int i, int k, const Rates &rates, StepStates &states) const
{
  StepState s{};
  if (lambda.stability > 0.0)
    set_frequencies(i, s);
  else if (lambda.acoustic > 0.0 || lambda.viscous > 0.0) {
    const FluidType &type = types[atom->type[i]];
    s.nu = type.viscosity;
    s.sound = type.at_boundary * type.sound * type.eos.stiffening(atom->rho[i]);
  }
  if (lambda.relative > 0.0) s.approach = fluid->approach_speed(i);
  const bool flies = states.until_pressed[k] > 0.0;
  if (flies && s.of_vertices_sq == 0.0 && (lambda.stability > 0.0 || lambda.acoustic > 0.0))
    s.until_pressed = until_pressed(i, rates.density ? rates.density[i] : atom->drho[i], s);
  states.set_pressure(k, s);
}

inline void ParticleLimits::set_frequencies(int i, StepState &s) const
{
  const Frequencies &its = fluid->frequencies(i);
  s.of_fluid_sq = its.fluid_sq;
  s.of_vertices_sq = its.vertices_sq;
  s.friction = its.friction;
}

// Free flight must not end before the limit is found again.

StepLimit ParticleLimits::stable_limit(int i) const
{
  StepCoefficients alone;
  alone.velocity = alone.force = alone.density = 0.0;
  alone.stability = options.lambda.stability;
  StepState s{};
  set_frequencies(i, s);
  if (fluid->is_in_flight(i) && s.of_vertices_sq == 0.0)
    s.until_pressed = until_pressed(i, atom->drho[i], s) / StabilityWatch::LONGEST_WAIT;
  return particle_limit(alone, s);
}

// Neighbors under a pressure p are pushed toward each other and toward the particle, and the
// density grows ever faster, by p/h_s^2.  Neighbors are not asked either where the particle's own
// sound, or the ceiling, allows less.

double ParticleLimits::until_pressed(int i, double density_rate, const StepState &s) const
{
  const double gap = fluid->gap_to_pressure(atom->type[i], atom->rho[i]);
  const double alone = time_at_rate(gap, density_rate);
  if (!asks_neighbors) return alone;
  const double smoothing = 0.5 * motion.support[atom->type[i]];
  const double by_sound = lambda.stability > 0.0
      ? lambda.stability * stable_step(s.of_fluid_sq + s.of_vertices_sq, s.friction)
      : lambda.acoustic * smoothing / s.sound;
  if (0.5 * alone <= by_sound || options.ceiling <= by_sound) return alone;
  const double ratio = atom->rho[i] / smoothing;
  return time_to_cross(gap, density_rate, fluid->p_over_rho2_beside(i) * ratio * ratio);
}

/* ----------------------------------------------------------------------
   vertices
------------------------------------------------------------------------- */

StepLimit ParticleLimits::of_vertex(int i, const LimitedVertices &vertices) const
{
  const double edge = lambda.cloth > 0.0 ? vertices.shortest_edge(i) : 0.0;
  return vertex_limit(lambda, vertex_state(i), edge);
}

// The longer a step, the more mass is added to a vertex beside fluid: from the step that the vertex
// alone allows to longer ones.

double ParticleLimits::scaled_acceleration(int i, double unscaled) const
{
  constexpr int ROUNDS = 3;
  const ScaledMass &scaled = fluid->scaled_mass();
  const int n = scaled.row(i);
  if (n < 0) return unscaled;
  const double mass = atom_mass(atom, i), support = motion.support[atom->type[i]];
  const Eigen::Vector3d alone = force->ftm2v / mass * Eigen::Vector3d(atom->f[i]);
  double result = unscaled;
  for (int k = 0; k < ROUNDS; k++) {
    const double dt = lambda.force * std::sqrt(support / result);
    if (!(dt < options.ceiling)) break;
    result = MassScaling(scaled.stiffness(n), 1.0 / mass, dt).scaled(alone).norm();
  }
  return result;
}

// Fluid acts on a light vertex like a spring on a light mass: the sound that limits the step is
// faster by the root of the ratio of the masses (added mass).  Friction is faster by that ratio.

StepState ParticleLimits::vertex_state(int i) const
{
  StepState s{};
  const double mass = atom_mass(atom, i);
  const double *v = atom->v[i];
  s.support = motion.support[atom->type[i]];
  s.speed_sq = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  s.accel_sq = acceleration_sq(i, atom->f[i]);
  if (options.lambda.stability > 0.0) {
    if (fluid->scaled_mass().on() && lambda.force > 0.0)
      s.accel_sq = std::pow(scaled_acceleration(i, std::sqrt(s.accel_sq)), 2);
    return s;
  }
  const Wetting wet = fluid->wetting(i);
  const double ratio = std::max(1.0, wet.fluid_mass / mass), smoothing = 0.5 * s.support;
  s.sound = smoothing * wet.sound_rate * std::sqrt(ratio);
  s.nu = smoothing * smoothing * wet.viscous_rate * ratio;
  return s;
}
