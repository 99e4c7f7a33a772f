// SPDX-License-Identifier: GPL-2.0-or-later
// Constraints (cloth/cloth_constraints.h) are projected color by color; after a color only the
// vertices that it moved are forwarded to other ranks.

#include "cloth/substepping.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace sphcloth;

static constexpr int ALL = ClothConstraints::ALL;

// of hinges, in radians, over the strain of edges
static constexpr double ANGLE_OVER_STRAIN = 5.0;

// What a projection of hinges for several substeps may leave, of their compliance; what damping
// may take away at once, of the stretching motion
static constexpr double MAX_HINGE_SOFTNESS = 0.01, MAX_DAMPING = 0.02;

int Substepping::wanted_substeps(double dt)
{
  if (!follows_load()) return usual_substeps();
  const double wanted = length.substeps(dt, options.iterations);
  if (length.is_held())
    warn(fmt::format("edges are strained by more than {}, whatever the substep: what holds them is "
                     "too far apart for their lengths; give a compliance, or a larger 'strain'",
                     options.strain));
  if (length.is_overloaded())
    warn(fmt::format("a strain of {} under the present load takes more than {:.6g} substeps: the "
                     "sheet stretches more, see 'unconverged' of compute pbd/cloth; give a "
                     "compliance, a larger 'strain', more 'iterations', or a shorter step",
                     options.strain, wanted));
  return static_cast<int>(std::max(wanted, length.substeps_for(dt, longest_without_size)));
}

// A projection leaves a constraint as soft as the time says that it stands for, of one substep or
// several (core/pbd/solver_softness.h).

void Substepping::measure_compliances()
{
  if (!uses(ClothSolver::SUBSTEPS)) return;
  const double mine[2] = {constraints.bending.min_compliance_per_weight(),
                          constraints.distance.min_compliance_per_weight(true)};
  double all[2];
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_MIN, world);
  const auto longest = [this](double softness, double compliance_per_weight) {
    return std::sqrt(softness / SINGLE_SWEEP_SOFTNESS * compliance_per_weight / force->ftm2v);
  };
  if (single_sweeps()) longest_of_hinges = longest(MAX_HINGE_SOFTNESS, all[0]);
  if (follows_load()) longest_without_size = longest(share_without_size(), all[1]);
}

// How much a solver does whose projections are counted is for the user to say.

void Substepping::missed_in_contact(double share)
{
  constexpr int MANY = 10;
  if (follows_load()) {
    length.missed_in_contact(share);
    return;
  }
  steps_missed = share > SubstepLength::MISSED ? steps_missed + 1 : 0;
  if (steps_missed == MANY)
    warn(fmt::format("contact leaves more than half of the momentum that stops particles after {} "
                     "iterations: what is heavy beside the cloth may gain energy; give more "
                     "'iterations', or neither 'iterations' nor 'solver'",
                     options.iterations));
}

// once

void Substepping::warn(const std::string &of)
{
  if (comm->me == 0 && !warned) error->warning(FLERR, "{}: {}", owner, of);
  warned = true;
}

void Substepping::begin_step(double dt, int substeps, const std::vector<SolverCoupling *> &meets,
                             HolderForces &holders_)
{
  couplings = &meets;
  holders = &holders_;
  step_dt = dt;
  n_substeps = substeps;
  if (!follows_load()) length.follow(substep_dt());
  hinge_groups = SubstepGroups(substeps, dt, longest_of_hinges);
  damping_groups = SubstepGroups(substeps, options.damping * dt, MAX_DAMPING);
}

// With direction start velocities are those of half a substep ago; those that are given are of the
// time of the positions.

double Substepping::first_kick(int slot) const
{
  const bool given = !velocities.has_taken_steps(vertices.halo.atom_of(slot));
  return options.from_start && given ? 0.5 : 1.0;
}

double Substepping::part_with_forces(int slot) const
{
  return 1.0 - (1.0 - first_kick(slot)) / n_substeps;
}

// of rigid edges, on all ranks

double Substepping::strain_at_start() const
{
  const double mine = largest_strain(constraints.distance, vertices.start.data());
  double all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all;
}

void Substepping::end_step()
{
  started = true;
  if (!follows_load()) return;
  const SolverError edges = error_of(constraints.distance, allowed_strain(), max_edge_share(), 1);
  const SolverError hinges = error_of(constraints.bending, ANGLE_OVER_STRAIN * allowed_strain(),
                                      max_hinge_share(), hinge_groups.last_size());
  const double mine[2] = {-std::min(edges.hardest, hinges.hardest), edges.largest};
  double all[2];
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_MAX, world);
  length.found(-all[0], all[1] / allowed_strain());
}

double Substepping::longest_sq() const { return std::pow(length.longest(), 2) * force->ftm2v; }

// of this rank's constraints, from the multipliers of the last sweep

template <std::size_t N>
SolverError Substepping::error_of(const Constraints<N> &c, double allowed, double share,
                                  int substeps) const
{
  return solver_error(c, {inv_dt_sq(substeps), longest_sq(), allowed, softest(share)});
}

// Couplings of all cloths that have as many behind them are called together: what couples cloths is
// as near the end in each.

template <class Do>
static void for_each_coupling(const std::vector<Substepping *> &cloths, Do something)
{
  std::size_t max_size = 0;
  for (const Substepping *cloth : cloths) max_size = std::max(max_size, cloth->present().size());
  for (std::size_t from_end = max_size; from_end > 0; from_end--)
    for (Substepping *cloth : cloths)
      if (const std::size_t size = cloth->present().size(); size >= from_end)
        something(*cloth, *cloth->present()[size - from_end]);
}

void Substepping::substep(int n, const std::vector<Substepping *> &cloths)
{
  for (Substepping *cloth : cloths) cloth->begin_substep(n);
  for_each_coupling(cloths, [](Substepping &cloth, SolverCoupling &coupling) {
    coupling.begin_substep(cloth.vertices.start.data(), cloth.vertices.v.data(),
                           cloth.substep_dt());
  });
  bool done = false;
  while (!done) {
    for (Substepping *cloth : cloths) cloth->sweep();
    for_each_coupling(cloths, [](Substepping &cloth, SolverCoupling &coupling) {
      coupling.project(cloth.vertices.displacement.data());
    });
    done = true;
    for (Substepping *cloth : cloths) done = cloth->is_done() && done;
  }
  for (Substepping *cloth : cloths) cloth->end_substep();
  for_each_coupling(cloths, [](Substepping &cloth, SolverCoupling &coupling) {
    coupling.end_substep(cloth.vertices.v.data(), cloth.substep_dt());
  });
  for (Substepping *cloth : cloths)
    if (n < cloth->n_substeps - 1) cloth->vertices.start = cloth->vertices.p;
}

void Substepping::begin_substep(int n)
{
  const double dt = substep_dt();
  if (follows_load() && !started && n == 0) length.begin(strain_at_start() / options.strain);
  // before the forces: weight is not damped
  if (const int together = damping_groups.done_in(n); options.damping > 0.0 && together)
    damp(together);
  apply_forces(dt * force->ftm2v, n == 0);
  predict(n == n_substeps - 1);
  std::fill(constraints.distance.lambda.begin(), constraints.distance.lambda.end(), 0.0);
  hinges_for = hinge_groups.done_in(n);
  if (hinges_for)
    std::fill(constraints.bending.lambda.begin(), constraints.bending.lambda.end(), 0.0);
  sweeps = 0;
}

void Substepping::end_substep()
{
  const double dt = substep_dt();
  vertices.update_positions();
  if (holders->wanted()) {
    const Vertex *start = options.from_start ? vertices.start.data() : nullptr;
    holders->add_pull(constraints.distance, start, dt, n_substeps);
    if (hinges_for) holders->add_pull(constraints.bending, start, dt, n_substeps * hinges_for);
  }
  set_velocities();
}

void Substepping::apply_forces(double dtf, bool first)
{
  for (int s = 0; s < vertices.halo.n_owned(); s++) {
    const double kick = (first ? first_kick(s) : 1.0) * dtf;
    const double *f = atom->f[vertices.halo.atom_of(s)], by = kick * vertices.inverse_mass[s];
    vertices.v[s].x += by * f[0];
    vertices.v[s].y += by * f[1];
    vertices.v[s].z += by * f[2];
  }
}

void Substepping::predict(bool last)
{
  const double dt = substep_dt();
  Vertices &displacement = vertices.displacement;
  const Vertices &start = vertices.start, &v = vertices.v;
  for (int s = 0; s < vertices.halo.n_owned(); s++) {
    displacement[s] = {dt * v[s].x, dt * v[s].y, dt * v[s].z, displacement[s].w};
    if (!last || displacement[s].w > 0.0) continue;
    const double *x = atom->x[vertices.halo.atom_of(s)];    // without rounding
    displacement[s] = {x[0] - start[s].x, x[1] - start[s].y, x[2] - start[s].z, 0.0};
  }
  vertices.halo.forward_displacements(ALL, displacement.data(), dt);
}

void Substepping::set_velocities()
{
  const double inv_dt = 1.0 / substep_dt();
  const Vertices &displacement = vertices.displacement;
  for (int s = 0; s < vertices.halo.n_owned(); s++) {
    if (displacement[s].w == 0.0) continue;
    vertices.v[s].x = inv_dt * displacement[s].x;
    vertices.v[s].y = inv_dt * displacement[s].y;
    vertices.v[s].z = inv_dt * displacement[s].z;
  }
}

// Takes the stretching motion out of the edges (line 29), at the rate that the user gave.

void Substepping::damp(int substeps)
{
  const double share = -std::expm1(-options.damping * substep_dt() * substeps);
  Vertex *v = vertices.v.data();
  vertices.halo.forward_velocities(ALL, v);
  for (int c = 0; c < constraints.edge_colors(); c++) {
    sphcloth::damp(constraints.distance, c, vertices.start.data(), v, share);
    vertices.halo.forward_velocities(constraints.channel_of_edge_color(c), v);
  }
}

void Substepping::sweep()
{
  ClothState state;
  state.start = vertices.start.data();
  state.displacement = vertices.displacement.data();
  state.along_start = options.from_start;
  if (uses(ClothSolver::JACOBI)) state.change = vertices.change.data();
  state.inv_dt_sq = inv_dt_sq();
  state.max_edge_share = max_edge_share();
  state.max_hinge_share = max_hinge_share();
  if (uses(ClothSolver::SUBSTEPS)) state.longest_sq = std::pow(length.longest() / substep_dt(), 2);
  if (follows_load()) {
    state.max_edge_error = allowed_strain();
    state.max_hinge_error = ANGLE_OVER_STRAIN * allowed_strain();
    state.without_size = share_without_size();
  }
  uses(ClothSolver::JACOBI) ? jacobi(state) : gauss_seidel(state);
  sweeps++;
}

// Collective.  Other ranks learn what the couplings of all cloths have moved.

bool Substepping::is_done()
{
  if (!couplings->empty())
    vertices.halo.forward_displacements(ALL, vertices.displacement.data(), substep_dt());
  if (options.tolerance > 0.0) {
    vertices.update_positions();
    if (converged()) return true;
  }
  return sweeps >= (uses(ClothSolver::SUBSTEPS) ? 1 : options.iterations);
}

// One after the other in a fixed order, a sweep pulls harder one way than the other: what it does
// to a sheet is no force with an energy.  Forward and backward it is.

void Substepping::gauss_seidel(const ClothState &state)
{
  const int n = constraints.distance.colors() + (hinges_for ? constraints.bending.colors() : 0);
  for (int c = 0; c < n; c++) project_color(c, state);
  for (int c = n - 1; options.symmetric_sweeps && c >= 0; c--) project_color(c, state);
}

// edges first, then hinges

void Substepping::project_color(int c, const ClothState &state)
{
  const int hinge = c - constraints.distance.colors();
  Vertex *displacement = vertices.displacement.data();
  if (hinge < 0) {
    project(constraints.distance, c, state);
    vertices.halo.forward_displacements(constraints.channel_of_edge_color(c), displacement,
                                        substep_dt());
  } else {
    ClothState longer = state;
    longer.inv_dt_sq = inv_dt_sq(hinges_for);
    longer.longest_sq /= hinges_for * hinges_for;
    longer.part_of_way = 1.0 / hinges_for;
    project(constraints.bending, hinge, longer);
    vertices.halo.forward_displacements(constraints.channel_of_hinge_color(hinge), displacement,
                                        substep_dt());
  }
}

void Substepping::jacobi(const ClothState &state)
{
  for (int c = 0; c < constraints.distance.colors(); c++) project(constraints.distance, c, state);
  for (int c = 0; c < constraints.bending.colors(); c++) project(constraints.bending, c, state);
  Vertices &displacement = vertices.displacement;
  for (int s = 0; s < vertices.halo.n_owned(); s++) {
    displacement[s].x += vertices.change[s].x;
    displacement[s].y += vertices.change[s].y;
    displacement[s].z += vertices.change[s].z;
  }
  std::fill(vertices.change.begin(), vertices.change.end(), Vertex());
  vertices.halo.forward_displacements(ALL, displacement.data(), substep_dt());
}

// A compliance times this is an inverse mass, in all systems of units.

double Substepping::inv_dt_sq(double substeps) const
{
  const double dt = substeps * substep_dt();
  return 1.0 / (dt * dt * force->ftm2v);
}

double Substepping::residual() const
{
  const double by = inv_dt_sq();
  const Vertex *p = vertices.p.data();
  const double of_edges =
      sphcloth::residual(constraints.distance, p, by, constraints.mean_length());
  // those that were projected for several substeps are where they have moved to since
  if (!hinge_groups.are_single()) return of_edges;
  return std::max(of_edges, sphcloth::residual(constraints.bending, p, by));
}

double Substepping::unconverged() const
{
  if (!uses(ClothSolver::SUBSTEPS)) return 0.0;
  const double allowed = follows_load() ? allowed_strain() : 0.0;
  return error_of(constraints.distance, allowed, max_edge_share(), 1).largest;
}

// force times length: the unit of energy in all systems of units

double Substepping::energy() const
{
  const int n_owned = vertices.halo.n_owned();
  return elastic_energy(constraints.distance, vertices.p.data(), n_owned) +
      elastic_energy(constraints.bending, vertices.p.data(), n_owned);
}

bool Substepping::converged() const
{
  double mine = residual(), all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all < options.tolerance;
}
