// SPDX-License-Identifier: GPL-2.0-or-later
// The triangles of one mesh during a step: positions of their vertices at its start and end,
// inverse masses, and the same of the particles that are near them.
// All phases of contact share it; each of them moves `end`, and the atoms, in its turn.

#ifndef SPHCLOTH_CONTACT_MOVING_TRIANGLES_H
#define SPHCLOTH_CONTACT_MOVING_TRIANGLES_H

#include "atom.h"
#include "contact/contact_pair.h"
#include "contact/step_start.h"
#include "contact/triangle_set.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class MovingTriangles : public TriangleSet {
 public:
  // groupbits: of the atoms that collide with the mesh
  MovingTriangles(LAMMPS *, ContactMesh *, const std::string &label, int groupbits,
                  const ContactRules &, ContactCounts &, StepStart &);

  const int groupbits;
  const ContactRules &rules;
  ContactCounts &counts;
  std::vector<Vec3> start, end;    // of the step so far, by slot, those of particles too
  std::vector<double> w;    // inverse masses by slot, 0 of vertices that are held
  std::vector<double> w_solver;    // the same, but attached vertices take part
  // Velocity with which something that gives none has moved an owned vertex since the last step: in
  // the steps of its solver it is on that way as particles are.
  Vec3 drift_of(int slot) const { return any_drift ? drift[slot] : Vec3(Vec3::Zero()); }
  void forget_drift(int slot) { drift[slot].setZero(); }

  // after each list build; whole triangles are seen as far as this
  void rebuild(double max_distance);

  // start and end of the step from the atoms as they are, or of a step without motion
  void load_step();
  void load_positions();

  // before the solver moves vertices
  void find_drift(double dt);

  // of owned vertices in the step, from places by slot
  double max_displacement(const std::vector<Vec3> &from) const;

  // does an atom collide with this mesh?
  bool collides(int i) const { return atom->mask[i] & groupbits; }

  StepStart &step_start;
  sphcloth::Sweep sweep_of(int i) const { return step_start.sweep_of(i); }
  sphcloth::ClosestPoints closest_at_start(const Vec3 &p, int t) const
  {
    const auto &[a, b, c] = triangles[t];
    return closest_points(sphcloth::PairKind::POINT_TRIANGLE, {p, start[a], start[b], start[c]});
  }
  Vec3 normal_at_start(int t) const
  {
    const auto &[a, b, c] = triangles[t];
    return (start[b] - start[a]).cross(start[c] - start[a]).normalized();
  }

  // Particles that are near take slots behind those of the vertices, until they are forgotten: the
  // pair of an owned one and a triangle.
  ContactPair pair_of(int i, int t)
  {
    const auto &[a, b, c] = triangles[t];
    return {sphcloth::PairKind::POINT_TRIANGLE,
            {slot_of_particle(i), a, b, c},
            {-1, t},
            Meeting::PARTICLE};
  }
  void forget_particles();
  std::vector<int> particles;    // owned atoms, of those slots
  bool is_particle(int slot) const { return slot >= halo.n_slots(); }
  // by this rank: a vertex or a particle
  bool is_owned(int slot) const { return is_particle(slot) || !halo.is_ghost(slot); }
  int atom_of(int slot) const
  {
    return is_particle(slot) ? particles[slot - halo.n_slots()] : halo.atom_of(slot);
  }

  // Of a point at this vector from its nearest point in a triangle, which has these weights: how
  // far does the vector lean into other triangles at the same edge or vertex, as a cosine?  Above
  // SEAM the point is nearer to one of these.  Triangles of which it is a vertex do not count.
  // Above `enough` it may lean farther into others.
  double leaning_into_others(int t, const Vec3 &weight, const Vec3 &from_nearest, double enough,
                             int slot_of_point = -1) const;
  double leaning_into_others(int t, const sphcloth::ClosestPoints &at, double enough,
                             int slot_of_point = -1) const
  {
    return leaning_into_others(t, {-at.weight[1], -at.weight[2], -at.weight[3]}, at.vector, enough,
                               slot_of_point);
  }
  bool is_nearer_to_another(int t, const Vec3 &weight, const Vec3 &from_nearest) const
  {
    return leaning_into_others(t, weight, from_nearest, sphcloth::SEAM) > sphcloth::SEAM;
  }

  // a held vertex takes an impulse, which is counted
  void push_held(int atom, const Vec3 &impulse);

  double memory_usage() const;

 private:
  std::vector<int> entry;    // slot of an owned atom, or -1
  std::vector<Vec3> drift;
  bool any_drift = false;    // of this rank; most meshes have none, and read none

  int slot_of_particle(int i);
};

}    // namespace LAMMPS_NS

#endif
