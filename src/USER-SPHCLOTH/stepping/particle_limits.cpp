// SPDX-License-Identifier: GPL-2.0-or-later
// The longest time step that each fluid particle and each vertex of a cloth allows.

#include "stepping/particle_limits.h"

#include "fluid/fluid_state.h"
#include "force.h"
#include "lammps_util/atom_tools.h"
#include "modify.h"

#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

void ParticleLimits::init(FluidState *style, SteppingScheme scheme)
{
  fluid = style;
  asks_neighbors = scheme != SteppingScheme::GLOBAL;
  interpolates_density = scheme == SteppingScheme::INDIVIDUAL;
  types.assign(atom->ntypes + 1, FluidType());
  for (int t = 1; t <= atom->ntypes; t++) {
    FluidType &its = types[t];
    its.support = fluid->support(t);
    if (!fluid->is_fluid(t)) continue;
    its.eos = fluid->equation_of_state(t);
    its.sound = its.eos.sound_speed();
    its.at_boundary = std::sqrt(fluid->largest_pressure_factor(t));
    its.viscosity = fluid->viscosity(t);
  }
  cloths.clear();
  for (Fix *fix : modify->get_fix_by_style("^pbd/cloth$"))
    cloths.push_back({fix, dynamic_cast<LimitedVertices *>(fix)});

  if (scheme == SteppingScheme::CONSTANT) return;
  fluid->want_density_rate();
  if (options.lambda.relative > 0.0) fluid->want_approach();
  if (!cloths.empty()) fluid->want_wetting();
}

double ParticleLimits::shortest_sound_time() const
{
  double shortest = std::numeric_limits<double>::infinity();
  for (int t = 1; t <= atom->ntypes; t++)
    if (fluid->is_fluid(t)) shortest = std::min(shortest, 0.5 * types[t].support / types[t].sound);
  return shortest;
}

double ParticleLimits::sound_time(int i) const
{
  const FluidType &type = types[atom->type[i]];
  return type.support / type.sound;
}

double ParticleLimits::acceleration(int i, double by_force) const
{
  return by_force * force->ftm2v / atom_mass(atom, i);
}

/* ----------------------------------------------------------------------
   fluid particles
------------------------------------------------------------------------- */

void ParticleLimits::find(const int *particles, int n, const double *const *external,
                          StepLimits &limits) const
{
  StepStates states;
  for (int k = 0; k < n; k++) {
    const int i = particles[k];
    double f[3];
    std::copy_n(atom->f[i], 3, f);
    if (external)
      for (int d = 0; d < 3; d++) f[d] += external[d][i];
    states.set(k, particle_state(i, f));
  }
  particle_limits(options.lambda, states, n, limits);
}

// what particles and vertices have in common; returns the mass

inline double ParticleLimits::set_motion(int i, const double *f, StepState &s) const
{
  const double mass = atom_mass(atom, i);
  const double *v = atom->v[i];
  const double to_accel = force->ftm2v / mass;
  s.support = types[atom->type[i]].support;
  s.speed_sq = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  s.accel_sq = to_accel * to_accel * (f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  return mass;
}

inline StepState ParticleLimits::particle_state(int i, const double *f) const
{
  StepState s{};
  set_motion(i, f, s);
  const FluidType &type = types[atom->type[i]];
  s.rho = atom->rho[i];
  s.nu = type.viscosity;
  s.sound = type.at_boundary * type.sound * type.eos.stiffening(s.rho);
  if (options.lambda.relative > 0.0) s.approach = fluid->approach_speed(i);
  const bool in_flight = fluid->p_over_rho2_of_all()[i] == 0.0;
  if (in_flight) s.until_pressed = until_pressed(i, type.eos.rho0 - s.rho, s.sound);
  // nothing is compressed in free flight, but individual steps interpolate the density
  if (!in_flight || interpolates_density) s.drho = atom->drho[i];
  return s;
}

// Neighbors under a pressure p are pushed toward each other and toward the particle, and the
// density grows ever faster, by p/h_s^2.  Neighbors are not asked either where the particle's own
// sound, or the ceiling, allows less.

double ParticleLimits::until_pressed(int i, double gap, double sound) const
{
  const double alone = time_to_cross(gap, atom->drho[i], 0.0);
  const double smoothing = 0.5 * types[atom->type[i]].support;
  const double by_sound = options.lambda.acoustic * smoothing / sound;
  if (!asks_neighbors || 0.5 * alone <= by_sound || options.ceiling <= by_sound) return alone;
  const double ratio = atom->rho[i] / smoothing;
  return time_to_cross(gap, atom->drho[i], fluid->p_over_rho2_beside(i) * ratio * ratio);
}

/* ----------------------------------------------------------------------
   vertices
------------------------------------------------------------------------- */

StepLimit ParticleLimits::of_vertex(int i, const LimitedVertices &vertices) const
{
  const double edge = options.lambda.cloth > 0.0 ? vertices.shortest_edge(i) : 0.0;
  return vertex_limit(options.lambda, vertex_state(i), edge);
}

// Fluid acts on a light vertex like a spring on a light mass: the sound that limits the step is
// faster by the root of the ratio of the masses (added mass).  Friction is faster by that ratio.

StepState ParticleLimits::vertex_state(int i) const
{
  StepState s{};
  const double mass = set_motion(i, atom->f[i], s);
  const Wetting wet = fluid->wetting(i);
  const double ratio = std::max(1.0, wet.fluid_mass / mass), smoothing = 0.5 * s.support;
  s.sound = smoothing * wet.sound_rate * std::sqrt(ratio);
  s.nu = smoothing * smoothing * wet.viscous_rate * ratio;
  return s;
}
