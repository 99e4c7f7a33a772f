// SPDX-License-Identifier: GPL-2.0-or-later
// Particles and triangles in contact, and the impulses that they exchange.
// Simultaneous contacts are solved together by splitting the mass of a vertex, or of a particle,
// over its contacts, which keeps momentum and always converges: Tonge, Benevolenski & Voroshilov,
// ACM Trans. Graph. 31 (2012) 105.

#ifndef SPHCLOTH_CONTACT_CONTACT_PAIRS_H
#define SPHCLOTH_CONTACT_CONTACT_PAIRS_H

#include "contact/moving_triangles.h"

#include <vector>

namespace LAMMPS_NS {

// a particle in contact

struct ContactParticle {
  using Vec3 = Eigen::Vector3d;

  int atom = -1;
  double w = 0.0;
  int contacts = 0;
  bool touched = false;    // in this substep
  double path = 0.0;    // how far it went in this step, from sweep to sweep
  double load = 0.0;    // sum of the normal corrections of its pairs
  Vec3 start = Vec3::Zero(), end = Vec3::Zero();    // of the step so far
  Vec3 from = Vec3::Zero(),
       displacement = Vec3::Zero();    // at the start of the substep, and since then
  Vec3 velocity = Vec3::Zero(), velocity_before = Vec3::Zero();
  Vec3 impulse = Vec3::Zero();    // of one pass
};

// a particle and a triangle

struct ContactPair {
  using Vec3 = Eigen::Vector3d;

  int particle = 0, triangle = 0;
  sphcloth::ContactStart start;    // of the step
  double awake_from = 0.0;    // path of particle and vertices before which there is no contact
  bool in_contact = false;    // in this substep: the next three are known
  Vec3 weight = Vec3::Zero(), normal = Vec3::Zero();
  double gap = 0.0;    // to be kept
  double normal_correction = 0.0;    // of this substep, mass times length
  Vec3 friction_correction = Vec3::Zero();    // the same along the triangle
  double speed_before = 0.0;    // of the particle relative to the triangle, along the normal
  double max_approach = 0.0;    // behind the solver: at most this much of the approach is removed
};

class ContactPairs : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  ContactPairs(LAMMPS *lmp_, MovingTriangles &mesh_) : Pointers(lmp_), mesh(mesh_) {}

  std::vector<ContactParticle> particles;
  std::vector<ContactPair> pairs;
  std::vector<Vec3> impulse;    // on vertices in one pass, by slot
  std::vector<Vec3> velocity;    // of vertices, by slot

  void clear();
  ContactPair &add(int atom, int triangle, const sphcloth::ContactResult &);
  ContactParticle &particle_of(const ContactPair &pair) { return particles[pair.particle]; }
  const ContactParticle &particle_of(const ContactPair &pair) const
  {
    return particles[pair.particle];
  }

  // What the masses are split by, see below: collective.  Evenly: over all pairs, as long as these
  // are the same.  By load: over active ones.
  void share_evenly();
  void share_by_load();

  // effective mass of a pair: masses split evenly over all pairs, or as pairs push, so that one
  // that hardly pushes hardly counts
  double split_mass(const ContactPair &, const std::vector<double> &inverse_mass) const;
  double loaded_mass(const ContactPair &) const;

  // of the particle relative to the triangle
  Vec3 relative_velocity(const ContactPair &) const;

  // the pairs that are in contact in this substep
  std::vector<int> active;

  // on the particle, and the opposite on the triangle; clear before each pass
  void clear_impulses();
  void apply_impulse(const ContactPair &, const Vec3 &);

  double memory_usage() const;

 private:
  MovingTriangles &mesh;
  std::vector<int> entry;    // of an atom among the particles, or -1
  std::vector<Vec3> pairs_at, load_at;    // of a vertex: how many; what they push, in [0]

  void sum_of_images(std::vector<Vec3> &sums);
};

}    // namespace LAMMPS_NS

#endif
