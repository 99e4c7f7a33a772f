// SPDX-License-Identifier: GPL-2.0-or-later
// Loads positions and inverse masses of a mesh for a step, and gives impulses back to atoms.

#include "contact/moving_triangles.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "force.h"
#include "lammps_util/atom_tools.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

MovingTriangles::MovingTriangles(LAMMPS *lmp_, ContactMesh *mesh_, const std::string &label_,
                                 int groupbits_, const ContactRules &rules_, ContactCounts &counts_,
                                 StepStart &step_start_) :
    TriangleSet(lmp_, mesh_, label_), groupbits(groupbits_), rules(rules_), counts(counts_),
    step_start(step_start_)
{
}

void MovingTriangles::rebuild(double max_distance)
{
  forget_particles();
  TriangleSet::rebuild(max_distance);
  w.assign(halo.n_slots(), 0.0);
  w_solver = w;
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    w[s] = mesh->inverse_mass(i);
    w_solver[s] = mesh->inverse_mass_in_solver(i);
  }
  halo.forward(0, w);
  halo.forward(0, w_solver);
  drift.assign(halo.n_owned(), Vec3::Zero());
  start.resize(halo.n_slots());
  end.resize(halo.n_slots());
}

void MovingTriangles::load_step()
{
  forget_particles();
  for (int s = 0; s < halo.n_owned(); s++) {
    const Sweep sweep = sweep_of(halo.atom_of(s));
    start[s] = sweep.start;
    end[s] = sweep.end;
  }
  halo.forward_positions(0, start.data(), update->dt);
  halo.forward_positions(0, end.data());
}

void MovingTriangles::load_positions()
{
  forget_particles();
  for (int s = 0; s < halo.n_slots(); s++) start[s] = end[s] = position(s);
}

// What a holder moves with its velocity has no drift, to the last bit.

void MovingTriangles::find_drift(double dt)
{
  any_drift = false;
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    const Sweep sweep = sweep_of(i);
    Vec3 expected = sweep.start;
    if (w[s] == 0.0) expected += dt * Vec3(atom->v[i]);
    drift[s] = (sweep.end - expected) / dt;
    any_drift = any_drift || drift[s] != Vec3::Zero();
  }
}

double MovingTriangles::max_displacement(const std::vector<Vec3> &from) const
{
  double max_sq = 0.0;
  for (int s = 0; s < halo.n_owned(); s++)
    max_sq =
        std::max({max_sq, (start[s] - from[s]).squaredNorm(), (end[s] - from[s]).squaredNorm()});
  return std::sqrt(max_sq);
}

int MovingTriangles::slot_of_particle(int i)
{
  if (entry[i] >= 0) return entry[i];
  entry[i] = static_cast<int>(start.size());
  particles.push_back(i);
  const Sweep sweep = sweep_of(i);
  start.push_back(sweep.start);
  end.push_back(sweep.end);
  w.push_back(1.0 / atom_mass(atom, i));
  w_solver.push_back(w.back());
  return entry[i];
}

void MovingTriangles::forget_particles()
{
  for (const int i : particles) entry[i] = -1;
  particles.clear();
  entry.resize(atom->nlocal, -1);
  const auto n = static_cast<std::size_t>(halo.n_slots());
  for (std::vector<Vec3> *each : {&start, &end}) each->resize(n);
  for (std::vector<double> *each : {&w, &w_solver}) each->resize(n);
}

// At an edge: inwards in the other triangle.  At a vertex: along all edges that end there, of which
// those of the triangle itself lead away from the point.

double MovingTriangles::leaning_into_others(int t, const Vec3 &weight, const Vec3 &from_nearest,
                                            double enough, int slot_of_point) const
{
  std::array<int, 3> at{};    // the vertices of the edge, or the vertex
  int n = 0;
  for (int q = 0; q < 3; q++)
    if (weight[q] > 0.0) at[n++] = triangles[t][q];
  if (n == 3) return 0.0;
  const Vec3 a = end[at[0]];
  const Vec3 edge = n == 2 ? Vec3(end[at[1]] - a) : Vec3::Zero();
  const double inv_sq = n == 2 ? 1.0 / edge.squaredNorm() : 0.0, distance = from_nearest.norm();
  double largest = 0.0;
  for (int k = first[at[0]]; k < first[at[0] + 1]; k++) {
    const std::array<int, 3> &other = triangles[incident[k]];
    if (n == 2 && std::find(other.begin(), other.end(), at[1]) == other.end()) continue;
    if (std::find(other.begin(), other.end(), slot_of_point) != other.end()) continue;
    for (int s : other) {
      if (s == at[0] || (n == 2 && s == at[1])) continue;
      Vec3 direction = end[s] - a;
      direction -= edge.dot(direction) * inv_sq * edge;
      largest = std::max(largest, leaning(direction, from_nearest));
      if (largest > enough * distance) return largest / distance;
    }
  }
  return largest > 0.0 ? largest / distance : 0.0;
}

void MovingTriangles::push_held(int i, const Vec3 &impulse)
{
  mesh->push_held(i, impulse);
  for (int d = 0; d < 3; d++) counts.impulse[d] += impulse[d] / force->ftm2v;
}

double MovingTriangles::memory_usage() const
{
  return halo.memory_usage() +
      bytes_of(first, incident, start, end, w, w_solver, drift, particles, entry);
}
