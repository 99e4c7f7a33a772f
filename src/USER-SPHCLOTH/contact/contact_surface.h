// The triangles of one cloth that are within reach of a rank, and the particles near them.
//
// While the cloth is solved, every particle near a triangle keeps a constraint with it, projected
// after each sweep over the edges and hinges: mass-weighted, both ways, and only pushing.
// Simultaneous contacts are solved together by splitting the mass of a vertex, or of a particle,
// over its contacts, which keeps momentum and always converges: Tonge, Benevolenski & Voroshilov,
// ACM Trans. Graph. 31 (2012) 105.

#ifndef SPHCLOTH_CONTACT_CONTACT_SURFACE_H
#define SPHCLOTH_CONTACT_CONTACT_SURFACE_H

#include "cloth/solver_coupling.h"
#include "contact/triangle_set.h"
#include "core/contact/point_triangle.h"
#include "core/contact/sheet_sides.h"
#include "core/geometry/disc_grid.h"
#include "platform.h"

#include <array>
#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// what the user asked for, and what is counted

struct ContactRules {
  double thickness = 0.0;
  double friction = 0.0;       // Coulomb's coefficient
  double restitution = 0.0;    // part of the approaching speed that comes back
  bool sides = true;           // fluids above and below do not feel each other
};

// wall time, added up where a block ends

class Clock {
 public:
  explicit Clock(double &sum_) : sum(sum_), begin(platform::walltime()) {}
  ~Clock() { sum += platform::walltime() - begin; }

 private:
  double &sum;
  const double begin;
};

struct ContactCounts {
  double contacts = 0.0;    // impulses that were exchanged
  double stops = 0.0;       // particles that were put back to their side behind the solver
  double frozen = 0.0;      // particles that were caught between triangles and moved with them
  double deepest = 0.0;     // largest missing gap before it was closed
  double seconds = 0.0;     // of wall time
  double impulse[3] = {0.0, 0.0, 0.0};    // on held vertices
};

// Sets of atoms that move as one, the same on every rank

class ContactZones {
 public:
  // groups of four IDs that belong together; false if that was known of all of them
  bool join(const std::vector<tagint> &groups)
  {
    bool any_new = false;
    for (std::size_t k = 0; k < groups.size(); k += 4)
      for (int q = 0; q < 4; q++) {
        parent.try_emplace(groups[k + q], groups[k + q]);
        any_new = any_new || root(groups[k + q]) != root(groups[k]);
        parent[root(groups[k + q])] = root(groups[k]);
      }
    number.clear();
    for (const auto &[id, ignored] : parent) number.try_emplace(root(id), number.size());
    return any_new;
  }
  int size() const { return static_cast<int>(number.size()); }
  int of(tagint id) const    // -1: in none
  {
    return parent.count(id) ? number.at(root(id)) : -1;
  }

 private:
  std::map<tagint, tagint> parent;
  std::map<tagint, int> number;
  tagint root(tagint id) const
  {
    while (parent.at(id) != id) id = parent.at(id);
    return id;
  }
};

Eigen::Vector3d at_most(const Eigen::Vector3d &, double most);

class ContactSurface : public SolverCoupling, public TriangleSet {
 public:
  // contact: the fix that asks; meets: groups of the atoms that meet the mesh
  ContactSurface(LAMMPS *, ContactMesh *, Fix *contact, int meets, const ContactRules *,
                 ContactCounts *);

  // after each list build; whole triangles are seen as far as this
  void rebuild(double far);

  // of every atom at the end of the last step
  void set_last_places(double **places) { last_places = places; }

  bool begin_step(const sphcloth::Vertex *start, const sphcloth::Vertex *end, double dt) override;
  void begin_substep(const sphcloth::Vertex *start, const sphcloth::Vertex *v, double dt) override;
  void project(sphcloth::Vertex *displacement) override;
  void end_substep(sphcloth::Vertex *v, double dt) override;
  void end_step() override;
  Vec3 impulse_on(int slot) const override { return received[slot]; }

  // above or below this sheet, for particles nearer than `reach`: adds to what is there.  Own atoms.
  void find_sides(double reach, int sheet, std::vector<sphcloth::Sides> &);

  // Behind the solver: what still goes wrong on the way from the last step's places to the present
  // ones, to round-off.  Collective; was there anything?
  bool settle();

  // now: how many are nearer than the thickness, and one of them, or 0.  Collective.
  bigint count_too_near(tagint &one);

  // for the vertices of another mesh: the triangles near them in this step, on their way up to a part of
  // the step, and what a triangle gets, mass times velocity
  void look_around();
  template <class Visit> void for_triangles_near(const sphcloth::Sweep &sweep, Visit visit)
  {
    sphcloth::Box box(sweep.start);
    box.extend(sweep.end);
    grid.query(box, [&](int t) {
      if (boxes[t].intersects(box)) visit(t);
    });
  }
  bool is_deeper(const sphcloth::ContactResult &, int t, const sphcloth::ContactResult &than,
                 int than_t) const;
  std::array<sphcloth::Sweep, 3> triangle_until(int t, double part) const;
  Vec3 displacement_of(int t, const Vec3 &weight) const;
  void push_triangle(int t, const Vec3 &weight, const Vec3 &impulse);
  void hand_over_pushes();

  // own particles that contact has moved in this step, some of them more than once
  const std::vector<int> &met() const { return moved; }
  void begin() { moved.clear(); }

  // a mesh whose vertices meet this one: those that are held do not give way
  void meet_vertices_of(const ContactMesh *other) { others.push_back(other); }

  double memory_usage() const;

 private:
  // a particle near the cloth
  struct Particle {
    int atom = -1;
    double w = 0.0;
    int contacts = 0;
    bool touched = false;
    double load = 0.0;    // sum of the pushes of its pairs
    Vec3 start = Vec3::Zero(), end = Vec3::Zero();    // of the step so far
    Vec3 from = Vec3::Zero(),
         displacement = Vec3::Zero();    // at the start of the substep, and since then
    Vec3 velocity = Vec3::Zero(), velocity_before = Vec3::Zero(), change = Vec3::Zero();
  };

  // a particle and a triangle that may meet in this step
  struct Pair {
    int particle = 0, triangle = 0;
    bool met = false;    // in this substep: the next three are known
    Vec3 weight = Vec3::Zero(), normal = Vec3::Zero();
    double kept = 0.0;
    double push = 0.0;    // of this substep, mass times length
    Vec3 rub = Vec3::Zero();    // the same along the triangle
    double speed_before = 0.0;    // of the particle from the triangle
    double approach = 0.0;    // behind the solver: the most that is taken of it
  };

  std::vector<const ContactMesh *> others;
  int meets;
  const ContactRules *rules;
  ContactCounts *counts;
  double **last_places;
  double substep_dt, remaining;    // of the step, behind this substep
  std::vector<Vec3> start, end, change;    // by slot: of the step so far, and of one pass
  const sphcloth::Vertex *substep_start = nullptr;    // by owned slot
  std::vector<Vec3> from;    // the same by slot, with friction
  std::vector<Vec3> now;    // by slot: velocities
  std::vector<double> w;    // inverse masses by slot, 0 of vertices that are held
  std::vector<double> w_solver;    // the same, but for attached vertices, which take part
  std::vector<Vec3> shares;    // contacts of each slot
  std::vector<Vec3> received;    // by owned slot
  std::vector<sphcloth::Box> boxes, swept;    // of the ways of triangles
  std::vector<char> swept_for;    // which of the latter are known
  sphcloth::BoxGrid grid;
  std::vector<sphcloth::Disc> discs;    // around triangles, with room for the way back
  sphcloth::DiscGrid disc_grid;
  std::vector<std::array<int, 2>> near;    // atom and triangle that may meet before the next look
  std::vector<Vec3> found_at;    // of each atom, when they were found
  std::vector<Vec3> start_then, end_then;    // by slot, the same
  std::vector<Particle> particles;
  std::vector<int> moved;
  std::vector<int> entry;    // of an atom among them, or -1
  std::vector<Pair> pairs;

  sphcloth::Sweep sweep_of(int atom) const;
  std::array<sphcloth::Sweep, 3> sweep_of_triangle(int t) const;
  void find_near();
  bool near_holds() const;
  double room_to_move() const;
  double farthest_sq() const;
  double farthest_vertex_sq() const;
  sphcloth::Box box_of_way(int t) const;
  const sphcloth::Box &swept_box(int t);
  void bound();
  // those of the near ones whose ways overlap in this step
  template <class Visit> void for_overlapping(Visit visit)
  {
    int last = -1;
    sphcloth::Sweep sweep;
    sphcloth::Box box;
    for (const auto &[i, t] : near) {
      if (i != last) {
        sweep = sweep_of(i);
        box = sphcloth::Box(sweep.start);
        box.extend(sweep.end);
        last = i;
      }
      if (swept_box(t).intersects(box)) visit(i, t, sweep);
    }
  }
  void set_discs(double reach);
  int side_at(const Vec3 &p, double reach);
  void meet();
  // the sum of what each pair asks of the mass of its vertices
  template <class Part> void share_out(Part part)
  {
    shares.assign(halo.n_slots(), Vec3::Zero());
    for (const Pair &pair : pairs)
      for (int q = 0; q < 3; q++) shares[triangles[pair.triangle][q]][0] += part(pair, q);
    halo.reverse_add(0, shares.data());
    halo.forward(0, shares.data());
  }
  Vec3 velocity_from(const Pair &) const;
  void part(const Pair &, double dt);
  void load_velocities(const sphcloth::Vertex *v);
  double split_mass(const Pair &, const std::vector<double> &inverse_mass) const;
  double loaded_mass(const Pair &) const;
  void forget_pairs();
  void remember(int atom, int triangle, const sphcloth::ContactResult &);
  void give(const Pair &, const Vec3 &by);
  void press(Pair &);
  void rub(Pair &);
  bool stop(bool recover);
  bool give_room(sphcloth::ContactResult &, const Vec3 &p, int t) const;
  void stop_approach();
  void take_velocities();
  void take_held(int atom, const Vec3 &impulse);
  void load_sweeps();
  bool may_move(int atom) const;
  void freeze();
  void move_zones(const ContactZones &);
};

}    // namespace LAMMPS_NS

#endif
