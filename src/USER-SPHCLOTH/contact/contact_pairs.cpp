// SPDX-License-Identifier: GPL-2.0-or-later
// Splits masses over simultaneous contacts, and applies their impulses.

#include "contact/contact_pairs.h"

#include "atom.h"
#include "core/util/bytes.h"
#include "lammps_util/atom_tools.h"

using namespace LAMMPS_NS;
using namespace sphcloth;

void ContactPairs::clear()
{
  for (const ContactParticle &p : particles) entry[p.atom] = -1;
  particles.clear();
  pairs.clear();
  active.clear();
  entry.resize(atom->nlocal, -1);
}

ContactPair &ContactPairs::add(int i, int triangle, const ContactResult &contact)
{
  if (entry[i] < 0) {
    entry[i] = static_cast<int>(particles.size());
    particles.push_back({});
    particles.back().atom = i;
    particles.back().w = 1.0 / atom_mass(atom, i);
  }
  particles[entry[i]].contacts++;
  pairs.push_back({});
  pairs.back().particle = entry[i];
  pairs.back().triangle = triangle;
  pairs.back().weight = contact.weight;
  pairs.back().normal = contact.normal;
  return pairs.back();
}

void ContactPairs::share_evenly()
{
  pairs_at.assign(mesh.halo.n_slots(), Vec3::Zero());
  for (const ContactPair &pair : pairs)
    for (int s : mesh.triangles[pair.triangle]) pairs_at[s][0] += 1.0;
  sum_of_images(pairs_at);
}

void ContactPairs::share_by_load()
{
  for (ContactParticle &p : particles) p.load = 0.0;
  load_at.assign(mesh.halo.n_slots(), Vec3::Zero());
  for (int k : active) {
    const ContactPair &pair = pairs[k];
    particle_of(pair).load += pair.normal_correction;
    for (int q = 0; q < 3; q++)
      load_at[mesh.triangles[pair.triangle][q]][0] += pair.normal_correction * pair.weight[q];
  }
  sum_of_images(load_at);
}

void ContactPairs::sum_of_images(std::vector<Vec3> &sums)
{
  mesh.halo.reverse_add(0, sums.data());
  mesh.halo.forward(0, sums.data());
}

double ContactPairs::split_mass(const ContactPair &pair,
                                const std::vector<double> &inverse_mass) const
{
  const ContactParticle &p = particle_of(pair);
  double inverse = p.w * p.contacts;
  for (int q = 0; q < 3; q++) {
    const int s = mesh.triangles[pair.triangle][q];
    inverse += inverse_mass[s] * pairs_at[s][0] * pair.weight[q] * pair.weight[q];
  }
  return 1.0 / inverse;
}

double ContactPairs::loaded_mass(const ContactPair &pair) const
{
  const ContactParticle &p = particle_of(pair);
  double inverse = p.w * p.load;
  for (int q = 0; q < 3; q++) {
    const int s = mesh.triangles[pair.triangle][q];
    inverse += mesh.w_solver[s] * pair.weight[q] * load_at[s][0];
  }
  return pair.normal_correction / inverse;
}

Eigen::Vector3d ContactPairs::relative_velocity(const ContactPair &pair) const
{
  Vec3 relative = particle_of(pair).velocity;
  for (int q = 0; q < 3; q++)
    relative -= pair.weight[q] * velocity[mesh.triangles[pair.triangle][q]];
  return relative;
}

void ContactPairs::clear_impulses()
{
  impulse.assign(mesh.halo.n_slots(), Vec3::Zero());
  for (ContactParticle &p : particles) p.impulse.setZero();
}

void ContactPairs::apply_impulse(const ContactPair &pair, const Vec3 &by)
{
  ContactParticle &p = particle_of(pair);
  p.impulse += by;
  p.touched = true;
  for (int q = 0; q < 3; q++) impulse[mesh.triangles[pair.triangle][q]] -= pair.weight[q] * by;
}

double ContactPairs::memory_usage() const
{
  return bytes_of(particles, pairs, impulse, velocity, active, entry, pairs_at, load_at);
}
