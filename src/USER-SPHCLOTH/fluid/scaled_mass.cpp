// SPDX-License-Identifier: GPL-2.0-or-later
// Finds the pairs, and moves the fluid by its part.

#include "fluid/scaled_mass.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "fluid/fluid_stability.h"
#include "force.h"
#include "lammps_util/atom_tools.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

void ScaledMass::find(Fluid &core, const Particles &p, FluidStability &stability,
                      const std::vector<FluidBoundary *> &boundaries)
{
  kicks_known = false;
  const std::vector<int> &is_vertex = stability.vertex_types();
  any_pairs = stability.any_vertices();
  any_vertices = any_pairs || have_vertices(boundaries);
  if (!any_vertices) return;
  gradients.resize(atom->nmax);
  strength.assign(atom->nmax, 0.0);
  normals.resize(3 * static_cast<std::size_t>(atom->nmax));
  if (any_pairs) core.vertex_gradients(p, is_vertex.data(), gradients.data());
  core.for_active_fluid([&](int i, int) {
    if (!any_pairs) gradients[i] = VertexGradients();
    for (FluidBoundary *boundary : boundaries) boundary->add_gradients(i, gradients[i]);
    const double sum = gradients[i].trace();
    if (sum == 0.0 || !(atom->mask[i] & groupbit)) return;
    const double sound = stability.find_sound(i);
    strength[i] = sound * sound * sum;
    Vec3::Map(&normals[3 * i]) = Vec3(gradients[i].away).normalized();
  });
  if (any_pairs) ghosts.send_to_ghosts(GhostData::STRENGTH);
  beside.clear();
  for (int i = 0; i < p.n_all; i++)
    if (strength[i] > 0.0) beside.push_back(i);
  vertex_pairs.clear();
  if (any_pairs)
    core.vertex_pairs(p, is_vertex.data(), strength.data(), normals.data(), vertex_pairs);
  stiffnesses.clear();
  rows.assign(atom->nlocal, -1);
  for (int n = 0; n < vertex_pairs.size(); n++) {
    stiffnesses.push_back(stiffness_of(vertex_pairs, n));
    rows[vertex_pairs.vertices[n]] = n;
  }
  meshes.begin();
  for (FluidBoundary *boundary : boundaries) boundary->add_springs(meshes, strength);
  meshes.sum_stiffness(
      [this](int i, const Eigen::Matrix3d &stiffness) { stiffnesses[row_of(i)] += stiffness; });
  changes.assign(stiffnesses.size(), {});
}

// those that meshes alone press on have rows behind those with pairs

int ScaledMass::row_of(int vertex)
{
  if (rows[vertex] < 0) {
    rows[vertex] = static_cast<int>(stiffnesses.size());
    stiffnesses.push_back(Eigen::Matrix3d::Zero());
  }
  return rows[vertex];
}

void ScaledMass::bound_frequencies(const Fluid &core, FluidStability &stability) const
{
  core.for_fluid(stability.found_now(), [&](int i, int) {
    if (!is_beside_vertices(i)) return;
    const double alone_sq = stability[i].fluid_sq;
    stability.set_fluid_sq(
        i, MassScaling::frequency_sq(alone_sq, strength[i], gradients[i], atom_mass(atom, i)));
  });
}

// In the column, dt^2 times the stiffness of all springs of a particle in the last step.  One for
// which it is not known, at the start or of a source, begins with the springs that it has.

static constexpr double UNKNOWN = 0.0, NO_SPRINGS = -1.0;

void ScaledMass::note_springs(double dt)
{
  double *of_last = (*last)[0];
  for (int i = 0; i < atom->nlocal; i++) {
    const double before = std::max(of_last[i], 0.0);
    const bool known = of_last[i] != UNKNOWN;
    of_last[i] = NO_SPRINGS;
    if (!(strength[i] > 0.0)) continue;
    const double now = dt * dt * strength[i] * gradients[i].trace();
    kicks[i].new_part = known ? FluidKick::new_part_of(before, now) : 0.0;
    of_last[i] = now;
  }
}

static auto each_of(const std::vector<FluidKick> &kicks)
{
  return [&kicks](int fluid) -> const FluidKick & { return kicks[fluid]; };
}

void ScaledMass::find_kicks(double dt)
{
  if (kicks_known) return;
  kicks_known = true;
  kicks.resize(atom->nmax);
  impulses.resize(atom->nmax, Vec3::Zero());
  for (const int i : beside) {
    if (i >= atom->nlocal) break;
    kicks[i].change = dt * force->ftm2v / atom_mass(atom, i) * Vec3(atom->f[i]);
  }
  note_springs(dt);
  if (any_pairs) ghosts.send_to_ghosts(GhostData::KICK);
  carried_by_meshes.assign(stiffnesses.size(), Vec3::Zero());
  meshes.carry(dt, each_of(kicks),
               [this](int i, const Vec3 &carried) { carried_by_meshes[rows[i]] += carried; });
}

ScaledMass::Vec3 ScaledMass::carried(int n, double dt) const
{
  Vec3 sum = carried_by_meshes[n];
  if (n < vertex_pairs.size()) sum += carried_by_fluid(vertex_pairs, n, dt, each_of(kicks));
  return sum;
}

void ScaledMass::give(int n, const VertexChange &change, double dt)
{
  changes[n] = change;
  if (n >= vertex_pairs.size()) return;
  give_to_fluid(vertex_pairs, n, dt, change.velocity, change.part_of_step, each_of(kicks),
                [this](int fluid, const Vec3 &impulse) { impulses[fluid] += impulse; });
}

// The fluid has drifted already, from where its forces were replaced.

int ScaledMass::held_in_step(int i, double dt) const
{
  const Vec3 before = Vec3::Map(atom->x[i]) - dt * Vec3::Map(atom->v[i]);
  return held.axes(atom->mask[i], before.data(), atom->f[i]);
}

void ScaledMass::move_fluid(double dt)
{
  meshes.give(
      dt, each_of(kicks),
      [this](int vertex) { return rows[vertex] < 0 ? VertexChange() : changes[rows[vertex]]; },
      [this](int fluid, const Vec3 &impulse) { impulses[fluid] += impulse; });
  std::fill(changes.begin(), changes.end(), VertexChange());    // each cloth of a step for itself
  if (any_pairs) ghosts.add_from_ghosts(GhostData::IMPULSE);
  for (const int i : beside) {
    if (i < atom->nlocal) {
      const Vec3 change = impulses[i] / atom_mass(atom, i);
      const int held_axes = held.any() ? held_in_step(i, dt) : 0;
      for (int d = 0; d < 3; d++) {
        if (held_axes >> d & 1) continue;
        atom->v[i][d] += change[d];
        atom->x[i][d] += dt * change[d];
      }
    }
    impulses[i].setZero();    // each cloth of a step gives its part anew
  }
}

int ScaledMass::ghost_size(GhostData what)
{
  switch (what) {
    case GhostData::STRENGTH: return 4;
    case GhostData::KICK: return 4;
    case GhostData::IMPULSE: return 3;
    default: return 0;
  }
}

int ScaledMass::pack(GhostData what, int i, double *buf) const
{
  if (what == GhostData::STRENGTH) {
    Vec3::Map(buf) = Vec3::Map(&normals[3 * i]);
    buf[3] = strength[i];
    return ghost_size(what);
  }
  Vec3::Map(buf) = what == GhostData::KICK ? kicks[i].change : impulses[i];
  if (what == GhostData::KICK) buf[3] = kicks[i].new_part;
  return ghost_size(what);
}

int ScaledMass::unpack(GhostData what, int i, const double *buf)
{
  if (what == GhostData::STRENGTH) {
    Vec3::Map(&normals[3 * i]) = Vec3::Map(buf);
    strength[i] = buf[3];
  } else {
    kicks[i] = {Vec3::Map(buf), buf[3]};
  }
  return ghost_size(what);
}

void ScaledMass::add(int i, const double *buf) { impulses[i] += Vec3::Map(buf); }

double ScaledMass::bytes() const
{
  return vertex_pairs.bytes() + meshes.bytes() +
      bytes_of(gradients, strength, normals, beside, rows, stiffnesses, carried_by_meshes, changes,
               kicks, impulses);
}
