// SPDX-License-Identifier: GPL-2.0-or-later
// Contact of cloth with particles, with cloth and with obstacles while it is solved: after each
// sweep over its constraints particles or vertices and triangles, and edges, that are nearer than
// the thickness are pushed apart.

#ifndef SPHCLOTH_CONTACT_CONTACT_ROWS_H
#define SPHCLOTH_CONTACT_CONTACT_ROWS_H

#include "cloth/solver_coupling.h"
#include "contact/candidate_pairs.h"
#include "contact/cloth_candidates.h"
#include "contact/contact_corner.h"
#include "contact/contact_points.h"
#include "contact/contact_row.h"
#include "core/util/simd.h"

#include <vector>

namespace LAMMPS_NS {

class ContactRows : public SolverCoupling, protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  ContactRows(LAMMPS *lmp_, MovingTriangles &mesh_, const MeshEdges &edges_,
              CandidatePairs &of_particles_, ClothCandidates &of_cloth_,
              const MeetingRules &rules_) :
      Pointers(lmp_), mesh(mesh_), edges(edges_), of_particles(of_particles_), of_cloth(of_cloth_),
      rules(rules_), points(mesh_)
  {
  }

  // after each list build
  void rebuild() { received.assign(mesh.halo.n_owned(), Vec3::Zero()); }

  bool begin_step(const sphcloth::Vertex *start, const sphcloth::Vertex *end, double dt) override;
  void begin_substep(const sphcloth::Vertex *start, const sphcloth::Vertex *v, double dt) override;
  void project(sphcloth::Vertex *displacement) override;
  void end_substep(sphcloth::Vertex *v, double dt) override;
  void end_step() override;
  Vec3 impulse_on(int slot) const override { return received[slot]; }

  double memory_usage() const;

 private:
  MovingTriangles &mesh;
  const MeshEdges &edges;
  CandidatePairs &of_particles;
  ClothCandidates &of_cloth;
  const MeetingRules rules;
  struct Detail {    // of a row
    std::array<int, 2> members;    // see ContactPair
    bool joined = false;
    double speed_before = 0.0;    // along the normal
    Vec3 friction_correction = Vec3::Zero();    // of this substep, mass times length
  };

  std::vector<ContactRow> rows;    // those of particles behind all others
  std::size_t n_rows_of_cloth = 0;
  std::vector<int> slot_of_particle;    // of those of particles
  std::vector<Detail> details;
  ContactPoints points;    // near particles
  std::vector<double> awake_from;    // of rows: path of both sides before which there is no contact
  std::vector<int> awake, active;    // rows in this pass, and those in contact in this substep
  SplitMasses masses;
  std::vector<Vec3> from, velocity;    // vertices at the start of the substep
  std::vector<Vec3> ghosts_before;
  std::vector<Vec3> received;    // by owned vertices in this step, mass times velocity
  struct Corner {    // rows of a particle on two faces
    int begin, end;
  };
  std::vector<Corner> corners;    // in this step
  ContactCorner corner;    // of those, the one that is solved
  const sphcloth::Vertex *substep_start = nullptr;
  int passes = 1, passes_of_active = 1;    // of a projection, in this step
  bool too_near = false;    // is some cloth to cloth, on any rank?
  double remaining = 0.0, substep_dt = 0.0;    // of the step, behind this substep
  double path = 0.0;    // longest of a vertex since the step began, beside what all move together
  Vec3 together = Vec3::Zero();    // that, in the substep before
  bool substep_begins = false;

  const ContactRules &rules_of(const ContactRow &row) const { return rules.of(row.meeting); }
  // of both sides of a row, in this step
  double path_of(std::size_t row) const
  {
    return row < n_rows_of_cloth ? 2.0 * path
                                 : path + points.path(slot_of_particle[row - n_rows_of_cloth]);
  }
  bool recovers_in_solver() const { return of_particles.none(); }
  void wake(bool only_active)
  {
    if (only_active) {
      awake = active;
      return;
    }
    awake.clear();
    for (std::size_t k = 0; k < rows.size(); k++)
      if (awake_from[k] <= path_of(k)) awake.push_back(static_cast<int>(k));
  }
  double find_rows_of_cloth();
  void find_rows_of_particles();
  void add_row(const ContactPair &, const sphcloth::ClosestPoints &at_start, double gap);
  void start_rows();
  double max_slide(const ContactRow &) const;
  // how far both sides may move before the row may push, or its closest points are found anew
  double asleep(const ContactRow &row, double distance, double slid) const
  {
    const double room = max_slide(row) - slid;
    return row.share > 0.0 ? std::min(room, distance - row.gap) : room;
  }
  // Those of obstacles are on their way already.
  void find_drift(double dt)
  {
    mesh.step_start.note_origins(dt);
    mesh.find_drift(dt);
    for (int s = 0; s < mesh.halo.n_owned(); s++)
      if (edges.is_obstacle(s)) mesh.forget_drift(s);
  }
  static Vec3 vector_of(const sphcloth::Vertex &p) { return {p.x, p.y, p.z}; }
  // of an owned vertex, where the solver has it so long before the end of the step
  Vec3 before(int slot, const sphcloth::Vertex &in_solver, double until_end) const
  {
    return vector_of(in_solver) - until_end * mesh.drift_of(slot);
  }
  Vec3 end_of(int slot, const sphcloth::Vertex *displacement) const
  {
    return before(slot, substep_start[slot], remaining) + vector_of(displacement[slot]);
  }
  void push_positions(sphcloth::Vertex *displacement);
  void push_velocities(sphcloth::Vertex *v);
  void load_positions(const sphcloth::Vertex *displacement);
  void load_ghosts(const Vec3 &aside);
  void load_velocities(const sphcloth::Vertex *v);
  // rows are fetched from memory some ahead
  template <class Visit> void for_ahead(const std::vector<int> &some, Visit visit) const
  {
    constexpr std::size_t AHEAD = 8;
    for (std::size_t n = 0; n < some.size(); n++) {
      if (n + AHEAD < some.size()) sphcloth::prefetch(rows[some[n + AHEAD]]);
      visit(some[n]);
    }
  }
  bool measure(int row, Vec3 &vector);    // from the second side to the first; does it push?
  void activate(int k)
  {
    ContactRow &row = rows[k];
    if (rules_of(row).restitution > 0.0)
      details[k].speed_before = row.relative(velocity).dot(row.normal);
    row.active = true;
    active.push_back(k);
  }
  // the impulse, mass times length
  double push(ContactRow &row, double mass, double distance)
  {
    const double step = std::max((row.gap - distance) * mass, -row.normal_correction);
    row.normal_correction += step;
    masses.add_load(row, step);
    return step;
  }
  void count(const ContactRow &row, double distance)
  {
    if (row.meeting == Meeting::PARTICLE) {
      mesh.counts.contacts++;
      mesh.counts.deepest = std::max(mesh.counts.deepest, row.gap - distance);
    } else
      mesh.counts.cloth_contacts++;
  }
  void project_normal(int k)
  {
    Vec3 vector;
    if (!measure(k, vector)) return;
    ContactRow &row = rows[k];
    const double distance = vector.dot(row.normal);
    if (!row.active) activate(k);
    count(row, distance);
    masses.apply(row, push(row, row.mass, distance) * row.normal);
  }
  // in this substep
  Vec3 slip(const ContactRow &row) const { return row.relative(mesh.end) - row.relative(from); }
  Vec3 rub(int row, const Vec3 &slipped);
  void find_corners();
  void project_corner(const Corner &);
  void project_friction(const Corner &);
  // against what is left of sliding when all push
  void project_friction()
  {
    masses.share_loads(mesh.halo);
    for_ahead(active, [this](int k) {
      if (!rows[k].in_corner) masses.apply(rows[k], rub(k, slip(rows[k])));
    });
    for (const Corner &which : corners) project_friction(which);
  }
  void solve_velocities(const Corner &);
  Vec3 find_closest_points(int row);
  Vec3 normal_of(const ContactRow &, const sphcloth::ClosestPoints &) const;
  double share(int row, const sphcloth::ClosestPoints &) const;
  // of a point into other triangles
  double leaning_of(int k, const sphcloth::ClosestPoints &at) const
  {
    return mesh.leaning_into_others(details[k].members[1], at, sphcloth::LEANS_AWAY,
                                    rows[k].slots[0]);
  }
  double leaning_beside(int edge, const Vec3 &from_nearest,
                        const std::array<int, 2> &other_side) const;
  // in this substep, by the projection
  sphcloth::ExchangedImpulse exchanged_by(int k) const
  {
    sphcloth::ExchangedImpulse so_far{rows[k].normal_correction / substep_dt};
    if (rules_of(rows[k]).friction > 0.0)
      so_far.friction = details[k].friction_correction / substep_dt;
    return so_far;
  }
  Vec3 velocity_impulse(int k, const Vec3 &relative, sphcloth::ExchangedImpulse &so_far) const
  {
    const ContactRow &row = rows[k];
    const ContactRules &of_row = rules_of(row);
    sphcloth::ContactMotion motion{relative, row.normal, 0.0, masses.by_load(row, mesh.w_solver)};
    if (of_row.restitution > 0.0) motion.speed_before = details[k].speed_before;
    return sphcloth::contact_impulse(motion, so_far, of_row.restitution, of_row.friction);
  }
  void release(int k)
  {
    ContactRow &row = rows[k];
    if (row.meeting == Meeting::PARTICLE && row.normal_correction > 0.0)
      mesh.counts.passed_on += row.normal_correction / substep_dt;
    row.active = false;
    row.normal_correction = 0.0;
    if (rules_of(row).friction > 0.0) details[k].friction_correction.setZero();
  }
  void push_held() const;
  void recover_gaps();
  void find_missing_gaps();
};

}    // namespace LAMMPS_NS

#endif
