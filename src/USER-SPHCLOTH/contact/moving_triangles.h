// SPDX-License-Identifier: GPL-2.0-or-later
// The triangles of one mesh during a step: positions of their vertices at its start and end,
// inverse masses, and the sweeps of the particles that may collide with them.
// All phases of contact share it; each of them moves `end`, and the atoms, in its turn.

#ifndef SPHCLOTH_CONTACT_MOVING_TRIANGLES_H
#define SPHCLOTH_CONTACT_MOVING_TRIANGLES_H

#include "atom.h"
#include "contact/contact_rules.h"
#include "contact/triangle_set.h"
#include "core/contact/point_triangle.h"
#include "lammps_util/particle_columns.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class MovingTriangles : public TriangleSet {
 public:
  // groupbits: of the atoms that collide with the mesh; last_positions: x, y, z of all owned atoms
  // at the end of the last step
  MovingTriangles(LAMMPS *, ContactMesh *, const std::string &label, int groupbits,
                  const ContactRules &, ContactCounts &, const ParticleColumns &last_positions);

  const int groupbits;
  const ContactRules &rules;
  ContactCounts &counts;
  std::vector<Vec3> start, end;    // of the step so far, by slot
  std::vector<double> w;    // inverse masses by slot, 0 of vertices that are held
  std::vector<double> w_solver;    // the same, but attached vertices take part
  std::vector<int> moved;    // own particles that contact moved in this step, some repeated

  // after each list build; whole triangles are seen as far as this
  void rebuild(double max_distance);

  // start and end of the step from the atoms as they are, or of a step without motion
  void load_step();
  void load_positions();

  // does an atom collide with this mesh?
  bool collides(int i) const { return atom->mask[i] & groupbits; }

  const ParticleColumns &last_positions;    // of owned atoms, at the start of the step
  sphcloth::Sweep sweep_of(int atom) const;
  std::array<sphcloth::Sweep, 3> sweep_of_triangle(int t) const;
  // Contact with a point whose start is that of the step.  One that is nearer to another triangle
  // at the same edge or vertex only counts if it passes through: the normal of a surface is that of
  // the triangle that is nearest.
  sphcloth::ContactResult contact(const sphcloth::Sweep &, int t, double slack) const;
  // The same where the start of the step is known, for iterations within it: without slack, a
  // distance, and the whole step only for a point that ends on the other side of the triangle's
  // plane.  Passing through twice is not seen.
  sphcloth::ContactResult contact_since(const sphcloth::ContactStart &, const sphcloth::Sweep &,
                                        int t) const;
  sphcloth::ContactStart contact_start(const Vec3 &p, int t) const
  {
    const auto &[a, b, c] = triangles[t];
    return sphcloth::contact_start({p, start[a], start[b], start[c]});
  }
  // Of a point at this vector from its nearest point in a triangle, which has these weights: how
  // far does the vector lean into other triangles at the same edge or vertex, as a cosine?  Above
  // SEAM the point is nearer to one of these.  Triangles of which it is a vertex do not count.
  double leaning_into_others(int t, const Vec3 &weight, const Vec3 &from_nearest,
                             int slot_of_point = -1) const;
  bool is_nearer_to_another(int t, const Vec3 &weight, const Vec3 &from_nearest) const
  {
    return leaning_into_others(t, weight, from_nearest) > sphcloth::SEAM;
  }

  // Does the first contact go deeper?  Two triangles may be hit alike, on an edge: then all ranks
  // take the same one.
  bool is_deeper(const sphcloth::ContactResult &, int t, const sphcloth::ContactResult &than,
                 int than_t) const;

  // a held vertex takes an impulse, which is counted
  void push_held(int atom, const Vec3 &impulse);

  double memory_usage() const;

 private:
  sphcloth::ContactResult of_nearest(const sphcloth::ContactResult &, const Vec3 &p, int t) const;
};

}    // namespace LAMMPS_NS

#endif
