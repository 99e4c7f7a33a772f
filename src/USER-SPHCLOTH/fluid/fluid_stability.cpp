// SPDX-License-Identifier: GPL-2.0-or-later
// Sums over neighbors become frequencies and rates of friction.

#include "fluid/fluid_stability.h"

#include "atom.h"
#include "core/timestep/free_flight.h"
#include "core/util/bytes.h"
#include "domain.h"
#include "fluid/fluid_boundary.h"
#include "fluid/fluid_lattices.h"
#include "fluid/free_surface.h"
#include "fluid/sph_materials.h"
#include "fluid/vertex_mobility.h"
#include "lammps_util/atom_tools.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

void FluidStability::want(const VertexMobility *of_vertices)
{
  mobility = of_vertices;
  lattices.resize(atom->ntypes + 1);
}

// Vertices are known by their type, also those of other ranks.

void FluidStability::begin_lists()
{
  new_lists = false;
  std::vector<int> here(atom->ntypes + 1, 0);
  for (int i = 0; i < atom->nlocal; i++)
    if (materials.is_boundary(atom->type[i]) && mobility->inverse_mass_of(i) > 0.0)
      here[atom->type[i]] = 1;
  is_vertex = here;
  MPI_Allreduce(here.data(), is_vertex.data(), atom->ntypes + 1, MPI_INT, MPI_MAX, world);
  has_vertices = std::any_of(is_vertex.begin(), is_vertex.end(), [](int is) { return is != 0; });
  stiffness.resize(atom->nmax);
  found.resize(atom->nmax);
  if (!has_vertices) return;
  sounds.resize(atom->nmax);
  rows.resize(atom->nmax);
  vertices.resize(atom->nmax);
}

const LatticeModes &FluidStability::modes(int type, double mass)
{
  Lattice &lattice = lattices[type];
  if (mass != lattice.mass) {
    const int dim = domain->dimension;
    const double rho0 = materials.equation_of_state(type).rho0;
    const double spacing = dim == 3 ? std::cbrt(mass / rho0) : std::sqrt(mass / rho0);
    lattice.mass = mass;
    lattice.modes = with_kernel(materials.options.kernel, [&](auto kernel) {
      return lattice_modes<decltype(kernel)>(materials.support(type) / spacing, dim);
    });
  }
  return lattice.modes;
}

double FluidStability::find_sound(int i) const { return find_sound(i, atom->rho[i]); }

// In free flight that of the particle once it is pressed.

double FluidStability::find_sound_under_pressure(int i) const
{
  if (materials.options.tension) return find_sound(i);
  const double rho0 = materials.equation_of_state(atom->type[i]).rho0;
  return find_sound(i, std::max(atom->rho[i], rho0));
}

double FluidStability::find_sound(int i, double rho) const
{
  const int type = atom->type[i];
  const Tait &eos = materials.equation_of_state(type);
  const double sound = surface.stiffening(i) * eos.sound_speed() * eos.stiffening(rho) *
      std::sqrt(atom_mass(atom, i)) / rho;
  // gradients are those of the density sum
  return materials.calibrates() ? sound * of_fluids.slope_of(type, rho) : sound;
}

// Within rounding of rest density fluid counts as under pressure.

double FluidStability::find_share(int i) const
{
  const int type = atom->type[i];
  const double gap = materials.gap_to_pressure(type, atom->rho[i]);
  if (gap <= materials.density_rounding(type)) return 1.0;
  const double ahead = STEPS_AHEAD * update->dt / time_at_rate(gap, atom->drho[i]);
  return std::min(1.0, ahead * ahead);
}

bool FluidStability::find_shares(const Fluid &core)
{
  if (!with_shares) return false;
  if (new_lists) begin_lists();
  shares.resize(atom->nmax);
  core.for_active_fluid([this](int i, int) { shares[i] = find_share(i); });
  return true;
}

void FluidStability::find_fluid(Fluid &core, const Particles &p,
                                const std::vector<FluidBoundary *> &boundaries, const double *waits)
{
  if (new_lists) begin_lists();
  core.select_fluid([waits](int i) { return !waits || !(waits[i] > 0.0); }, due);
  core.stiffness(p, due, with_shares ? shares.data() : nullptr, stiffness.data());
  core.for_fluid(due, [&](int i, int t) {
    Stiffness &s = stiffness[i];
    for (FluidBoundary *boundary : boundaries) boundary->add_stiffness(i, s);
    const double mass = atom_mass(atom, i), sound = find_sound_under_pressure(i);
    const LatticeModes &of_lattice = modes(t, mass);
    const double share = with_shares ? s.pressed_share() : 1.0;
    found[i].fluid_sq = sound * sound * s.largest(mass, of_lattice.sound, share);
    found[i].friction = of_lattice.friction * s.friction;
  });
}

bool FluidStability::need_vertices(Fluid &core, const Particles &p,
                                   const std::vector<FluidBoundary *> &boundaries,
                                   const double *waits)
{
  with_vertices = has_vertices || have_vertices(boundaries);
  if (!with_vertices || !waits) return with_vertices;
  int here = 0, anywhere = 0;
  core.for_fluid(due, [&](int i, int) { here = here || is_near_vertices(core, p, boundaries, i); });
  MPI_Allreduce(&here, &anywhere, 1, MPI_INT, MPI_MAX, world);
  with_vertices = anywhere != 0;
  return with_vertices;
}

// T_j is complete, and that of a pinned vertex 0.  Inactive fluid presses on them, too.

void FluidStability::find_vertices(Fluid &core, const Particles &p,
                                   const std::vector<FluidBoundary *> &boundaries)
{
  for (FluidBoundary *boundary : boundaries) boundary->find_vertex_stiffness(*this);
  if (!has_vertices) return;
  for (int i = 0; i < p.n_all; i++)
    if (materials.is_fluid(atom->type[i])) sounds[i] = find_sound(i);
  core.vertex_stiffness(p, is_vertex.data(), sounds.data(), vertices.data());
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_vertex[atom->type[i]]) continue;
    const double volume = p.mass_or_volume[i], per_mass = volume * mobility->inverse_mass_of(i);
    VertexStiffness &v = vertices[i];
    for (double *of : {&v.xx, &v.yy, &v.zz, &v.xy, &v.xz, &v.yz}) *of *= volume * per_mass;
    v.friction *= per_mass;
  }
}

void FluidStability::find_rows(Fluid &core, const Particles &p,
                               const std::vector<FluidBoundary *> &boundaries, bool scaled)
{
  core.for_fluid(due, [&](int i, int) { found[i].vertices_sq = 0.0; });
  if (!with_vertices) return;
  if (has_vertices) core.vertex_rows(p, is_vertex.data(), vertices.data(), scaled, rows.data());
  core.for_fluid(due, [&](int i, int) {
    VertexRow row = has_vertices ? rows[i] : VertexRow();
    for (FluidBoundary *boundary : boundaries) boundary->add_row(i, row);
    if (!scaled) found[i].vertices_sq = find_sound(i) * row.sum;
    found[i].friction += row.friction;
  });
}

bool FluidStability::is_near_vertices(Fluid &core, const Particles &p,
                                      const std::vector<FluidBoundary *> &boundaries, int i) const
{
  if (have_vertices_beside(boundaries, i)) return true;
  if (!has_vertices) return false;
  for (int t = 1; t <= atom->ntypes; t++)
    if (is_vertex[t] && core.count_inside(p, i, t, 1) > 0) return true;
  return false;
}

double *FluidStability::pack(int i, double *end) const
{
  const VertexStiffness &v = vertices[i];
  for (const double number : {v.xx, v.yy, v.zz, v.xy, v.xz, v.yz, v.friction}) *end++ = number;
  return end;
}

const double *FluidStability::unpack(int i, const double *from)
{
  VertexStiffness &v = vertices[i];
  for (double *of : {&v.xx, &v.yy, &v.zz, &v.xy, &v.xz, &v.yz, &v.friction}) *of = *from++;
  return from;
}

double FluidStability::bytes() const
{
  return bytes_of(sounds, shares, stiffness, vertices, rows, found, due.slots);
}
