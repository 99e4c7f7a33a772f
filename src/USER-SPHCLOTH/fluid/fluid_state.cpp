// SPDX-License-Identifier: GPL-2.0-or-later
// What the loops over particles read and write, and what was found in the last evaluation.

#include "fluid/fluid_state.h"

#include "fluid/side_source.h"
#include "force.h"
#include "lammps_util/atom_tools.h"
#include "pair.h"

#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

FluidState *FluidState::find(Force *force)
{
  Pair *style = force->pair_match("sph/tait", 1);
  int dim = 0;
  return style ? static_cast<FluidState *>(style->extract(EXTRACT, dim)) : nullptr;
}

bool FluidState::has_role(int itype) const
{
  return pair->allocated && pair->setflag[itype][itype];
}

void FluidState::want_density_rate()
{
  core->model.outputs = std::max(core->model.outputs, Outputs::RATE);
}

void FluidState::set_active(double **array, int column, bool interpolated)
{
  active = array;
  active_column = column;
  pressures_follow = interpolated;
}

/* ----------------------------------------------------------------------
   what the loops know of the materials
------------------------------------------------------------------------- */

const PairTerms &FluidState::set_terms(int i, int j)
{
  FluidModel &model = core->model;
  const int n = atom->ntypes + 1;
  PairTerms t = mix(i, j);
  const double scale = model.pressure_scale[i] * model.pressure_scale[j];
  t.stiffness /= is_fluid(i) && is_fluid(j) ? std::sqrt(scale) : scale;
  // density diffuses within a fluid, not across the step between two
  if (i == j && integrates_density())
    t.diffusion = 2.0 * options.delta * equation_of_state(i).sound_speed() * 0.5 * support(i);
  model.terms[i * n + j] = model.terms[j * n + i] = t;
  model.terms[j * n + i].rho0_ratio = 1.0 / t.rho0_ratio;
  return model.terms[i * n + j];
}

void FluidState::change_stiffness(int type, double k)
{
  set_stiffness(type, k, 0.0);
  cache_pair_values();
  for (int j = 1; j <= atom->ntypes; j++) set_terms(std::min(type, j), std::max(type, j));
}

/* ----------------------------------------------------------------------
   what the loops read and write
------------------------------------------------------------------------- */

Particles FluidState::particles()
{
  Particles p;
  p.n_owned = atom->nlocal;
  p.n_all = atom->nlocal + atom->nghost;
  if (p.n_all == 0) return p;
  p.type = atom->type;
  p.x = atom->x[0];
  p.v = atom->v[0];
  p.mass_or_volume = mass_or_volume.data();
  p.p_over_rho2 = p_over_rho2.data();
  p.rho = atom->rho;
  p.drho = atom->drho;
  p.f = atom->f[0];
  p.approach = approach.data();
  p.force_unit = 1.0 / force->ftm2v;
  if (sides) {
    p.sides = sides->sides();
    p.layers = sides->layers();
  }
  p.active = active;
  p.active_column = active_column;
  return p;
}

/* ----------------------------------------------------------------------
   for step hooks and boundaries
------------------------------------------------------------------------- */

void FluidState::push_walls_more(int i, double p_over_rho2_of_i, double times)
{
  for (FluidBoundary *boundary : boundaries) boundary->push_more(i, p_over_rho2_of_i, times);
}

void FluidState::prolong_walls(double times)
{
  for (FluidBoundary *boundary : boundaries) boundary->prolong(times);
}

void FluidState::hand_over_pushes(const FluidBoundary::Take &take)
{
  for (FluidBoundary *boundary : boundaries) boundary->defer(take);
}

bool FluidState::feels_moving_wall(int i) const
{
  return std::any_of(boundaries.begin(), boundaries.end(),
                     [&](FluidBoundary *boundary) { return boundary->moves_beside(i); });
}

bool FluidState::is_beside_mesh(int i) const { return have_vertices_beside(boundaries, i); }

void FluidState::find_pair_forces(std::vector<double> &forces)
{
  Particles p = particles();
  forces.assign(3 * static_cast<std::size_t>(atom->nmax), 0.0);
  std::vector<double> rates(atom->nmax, 0.0);    // are known
  p.f = forces.data();
  p.drho = rates.data();
  core->forces(p, Target::FLUID);
}

void FluidState::add_virial(int i, const Eigen::Vector3d &from, const Eigen::Vector3d &on)
{
  if (!pair->vflag_either) return;
  const double v[6] = {from[0] * on[0], from[1] * on[1], from[2] * on[2],
                       from[0] * on[1], from[0] * on[2], from[1] * on[2]};
  for (int m = 0; m < 6; m++) {
    if (pair->vflag_global) pair->virial[m] += v[m];
    if (pair->vflag_atom) pair->vatom[i][m] += v[m];
  }
}

/* ----------------------------------------------------------------------
   what the last evaluation found
------------------------------------------------------------------------- */

bool FluidState::evaluated() const
{
  return is_evaluated && evaluated_order == order_of_atoms(atom);
}

int FluidState::foreign_type_in(int groupbit) const
{
  int here = 0, anywhere = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit && !is_fluid(atom->type[i])) here = atom->type[i];
  MPI_Allreduce(&here, &anywhere, 1, MPI_INT, MPI_MAX, world);
  return anywhere;
}

double FluidState::pressure_of(int i) const
{
  const int type = atom->type[i];
  const double rho = atom->rho[i];
  double p = p_over_rho2[i] * rho * rho;
  if (is_fluid(type)) {
    if (lattices.adapts_density()) p /= lattices.slope(i, type, rho);
    p /= surface.along(i);
  } else if (calibrates())
    p /= lattices.slope_at_rest();
  if (is_fluid(type))
    for (FluidBoundary *boundary : renormalizing) p /= boundary->inverse_gamma(i);
  return p;
}

int FluidState::count_neighbors(int i)
{
  if (core->order().slots() == 0) return 0;    // a scene without fluid has no lists
  const Particles p = particles();
  int n = 0;
  for (int t = 1; t <= atom->ntypes; t++)
    if (is_fluid(atom->type[i]) || is_fluid(t))
      n += core->count_inside(p, i, t, std::numeric_limits<int>::max());
  return n;
}

static double distance_sq(const double *x, const double *y)
{
  const double dx = x[0] - y[0], dy = x[1] - y[1], dz = x[2] - y[2];
  return dx * dx + dy * dy + dz * dz;
}

bool FluidState::inside_support(int i, int j) const
{
  const double reach = support(atom->type[i], atom->type[j]);
  return distance_sq(atom->x[i], atom->x[j]) < reach * reach;
}

double FluidState::p_over_rho2_beside(int i)
{
  double **x = atom->x;
  double max = 0.0;
  for (int t = 1; t <= atom->ntypes; t++) {
    const double reach = support(atom->type[i], t), reach_sq = reach * reach;
    const NeighborSpan near = neighbors(i, t);
    for (int k = 0; k < near.n; k++)
      if (const int j = near.of[k]; p_over_rho2[j] > max && distance_sq(x[i], x[j]) < reach_sq)
        max = p_over_rho2[j];
  }
  return max;
}

void FluidState::want_wetting() const
{
  for (FluidBoundary *boundary : boundaries) boundary->want_wetting();
}

double FluidState::approach_speed(int i)
{
  double fastest = approach[i];
  for (FluidBoundary *boundary : boundaries) fastest = std::max(fastest, boundary->approach(i));
  return fastest;
}

Wetting FluidState::wetting(int i)
{
  if (!is_boundary(atom->type[i])) {
    for (const FluidBoundary *boundary : boundaries)
      if (const Wetting wet = boundary->wetting(i); wet.fluid_mass > 0.0) return wet;
    return {};
  }
  const Particles p = particles();
  Wetting w;
  for (int t = 1; t <= atom->ntypes; t++) {
    if (!is_fluid(t) || core->count_inside(p, i, t, 1) == 0) continue;
    const Wetting by = wetting_by(t, viscosity(t, atom->type[i]));
    const double stiffening = std::sqrt(pressure_factor(t, atom->type[i]));
    w.fluid_mass = std::max(w.fluid_mass, type(t).eos.rho0 * mass_or_volume[i]);
    w.sound_rate = std::max(w.sound_rate, stiffening * by.sound_rate);
    w.viscous_rate = std::max(w.viscous_rate, by.viscous_rate);
  }
  return w;
}

Wetting FluidState::wetting_by(int fluid_type, double nu) const
{
  const double smoothing = 0.5 * support(fluid_type);
  return {0.0, type(fluid_type).eos.sound_speed() / smoothing, nu / (smoothing * smoothing)};
}
