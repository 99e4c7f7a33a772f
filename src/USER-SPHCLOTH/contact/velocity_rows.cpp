// SPDX-License-Identifier: GPL-2.0-or-later
// Removes what is left of an approach behind the solver.

#include "contact/velocity_rows.h"

#include "atom.h"
#include "contact/pass_changes.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

static constexpr int MAX_PASSES = 40;

void VelocityRows::solve()
{
  load_velocities();
  start_rows();
  const bool repeated = are_repeated();
  if (repeated) {
    pass_until_done(false, MAX_PASSES);
    load_velocities();
  }
  pass_until_done(true, repeated ? MAX_PASSES : 1);
  for (Pushed &pushed : rows) pushed.taken_back = slid_too_far(pushed);
  for (const Pushed &pushed : rows) take_back(pushed);
}

void VelocityRows::load_velocities()
{
  velocity.resize(mesh.start.size());
  for (int s = 0; s < static_cast<int>(velocity.size()); s++) {
    const double *v = atom->v[mesh.atom_of(s)];
    velocity[s] = Vec3(v[0], v[1], v[2]);
  }
  mesh.halo.forward_velocities(0, velocity.data());
}

void VelocityRows::start_rows()
{
  masses.begin(velocity.size());
  for (const Pushed &pushed : rows) masses.count(pushed.row);
  masses.share(mesh.halo);
  for (Pushed &pushed : rows) start(pushed);
}

void VelocityRows::start(Pushed &pushed) const
{
  const double restitution = rules.of(pushed.row.meeting).restitution,
               speed = pushed.row.relative(velocity).dot(pushed.row.normal);
  pushed.mass = masses.of(pushed.row, mesh.w);
  pushed.speed_before = speed;
  pushed.change =
      (1.0 + restitution) * (restitution > 0.0 ? -speed : std::min(-speed, pushed.max_approach));
}

// on all ranks, if on any

bool VelocityRows::are_repeated() const
{
  if (rules.max_friction() == 0.0 && rules.cloth.restitution == 0.0) return false;
  const int mine = std::any_of(rows.begin(), rows.end(), [this](const Pushed &pushed) {
    return masses.are_shared(pushed.row, mesh.w);
  });
  int any;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  return any;
}

void VelocityRows::pass_until_done(bool rubs, int max_passes)
{
  PassChanges changes;
  for (int n = 1;; n++) {
    const double change = pass(rubs);
    if (n == max_passes || changes.are_small(change, world)) return;
    load_velocities();
  }
}

// The largest change of a speed

double VelocityRows::pass(bool rubs)
{
  double largest = 0.0;
  masses.clear_impulses();
  for (Pushed &pushed : rows) largest = std::max(largest, push(pushed, rubs));
  apply_impulses();
  return largest;
}

double VelocityRows::push(Pushed &pushed, bool rubs)
{
  const ContactMotion motion{pushed.row.relative(velocity), pushed.row.normal, pushed.speed_before,
                             pushed.mass};
  const double so_far = motion.velocity.dot(motion.normal) - motion.speed_before,
               friction = rubs ? rules.of(pushed.row.meeting).friction : 0.0;
  const Vec3 impulse = impulse_for(pushed.change - so_far, motion, pushed.exchanged, friction);
  masses.apply(pushed.row, impulse);
  return pushed.mass > 0.0 ? impulse.norm() / pushed.mass : 0.0;
}

void VelocityRows::apply_impulses()
{
  mesh.halo.reverse_add(0, masses.impulse.data());
  for (int s = 0; s < static_cast<int>(velocity.size()); s++) {
    const Vec3 &impulse = masses.impulse[s];
    if (impulse.isZero(0.0) || !mesh.is_owned(s)) continue;
    const int i = mesh.atom_of(s);
    for (int d = 0; d < 3; d++) atom->v[i][d] += mesh.w[s] * impulse[d];
    if (mesh.w[s] == 0.0) mesh.push_held(i, impulse);
  }
}

// The velocity that friction removes was missing since the contact began.  It takes back no more
// than the sliding of this step, so that nothing gains energy.

VelocityRows::Vec3 VelocityRows::slid_too_far(const Pushed &pushed) const
{
  const ContactRow &row = pushed.row;
  const double friction = rules.of(row.meeting).friction;
  if (friction == 0.0 || pushed.too_near <= 0.0 || pushed.speed_before >= 0.0) return Vec3::Zero();
  const double dt = update->dt, duration = std::min(pushed.too_near / -pushed.speed_before, dt);
  const Vec3 way = row.relative(mesh.end) - row.relative(mesh.start),
             slid = way - way.dot(row.normal) * row.normal;
  return mesh.w[row.slots[0]] * duration *
      clamp_length(pushed.mass / dt * slid, friction * pushed.exchanged.normal);
}

void VelocityRows::take_back(const Pushed &pushed)
{
  if (pushed.taken_back.isZero(0.0)) return;
  const int s = pushed.row.slots[0];
  mesh.end[s] -= pushed.taken_back;
  double *x = atom->x[mesh.atom_of(s)];
  for (int d = 0; d < 3; d++) x[d] -= pushed.taken_back[d];
  mesh.step_start.atoms_moved();
}
