// SPDX-License-Identifier: GPL-2.0-or-later
// Rows of particles on two faces at once.

#include "contact/contact_rows.h"

using namespace LAMMPS_NS;
using namespace sphcloth;

// of normals of one face: 8 degrees
static constexpr double COS_ONE_FACE = 0.99;

// The rows of a particle follow one another.

void ContactRows::find_corners()
{
  corners.clear();
  const ContactRules &of = rules.of(Meeting::PARTICLE);
  if (of.friction == 0.0 && of.restitution == 0.0) return;
  for (std::size_t begin = n_rows_of_cloth, end; begin < rows.size(); begin = end) {
    const ContactRow *first = nullptr;
    bool is_corner = false;
    for (end = begin; end < rows.size() && rows[end].slots[0] == rows[begin].slots[0]; end++) {
      if (rows[end].share == 0.0) continue;
      if (!first) first = &rows[end];
      is_corner = is_corner || first->normal.dot(rows[end].normal) < COS_ONE_FACE;
    }
    if (!is_corner) continue;
    corners.push_back({static_cast<int>(begin), static_cast<int>(end)});
    for (std::size_t k = begin; k < end; k++) rows[k].in_corner = true;
  }
}

// The mass of the particle over its rows, as far as they push one another: the larger the less they
// have in common, and all of it where they are at right angles.

static void split(ContactCorner &corner, const std::vector<ContactRow> &rows, double inverse_mass)
{
  for (ContactCorner::Row &of : corner.rows) {
    const ContactRow &row = rows[of.number];
    double shares = 0.0;
    for (const ContactCorner::Row &other : corner.rows)
      shares += rows[other.number].share * std::fabs(row.normal.dot(rows[other.number].normal));
    const double inverse = inverse_mass * shares + row.share * of.other_inverse_mass;
    of.mass = inverse > 0.0 ? row.share / inverse : 0.0;
  }
}

void ContactRows::project_corner(const Corner &which)
{
  const double inverse_mass = mesh.w_solver[rows[which.begin].slots[0]];
  corner.rows.clear();
  for (int k = which.begin; k < which.end; k++) {
    if (!rows[k].active && awake_from[k] > path_of(k)) continue;
    Vec3 vector;
    if (!measure(k, vector) && rows[k].share == 0.0) continue;
    corner.rows.push_back({k, vector, masses.inverse_of_others(rows[k], mesh.w_solver)});
  }
  split(corner, rows, inverse_mass);
  corner.repeat(inverse_mass, [this](ContactCorner::Row &of, const Vec3 &relative) -> Vec3 {
    ContactRow &row = rows[of.number];
    const double distance = relative.dot(row.normal);
    if (!row.pushes(distance)) return Vec3::Zero();
    if (!row.active) activate(of.number);
    return push(row, of.mass, distance) * row.normal;
  });
  for (const ContactCorner::Row &of : corner.rows) {
    const ContactRow &row = rows[of.number];
    if (row.active) count(row, of.before.dot(row.normal));
    masses.apply(row, of.impulse);
  }
}

void ContactRows::project_friction(const Corner &which)
{
  corner.rows.clear();
  for (int k = which.begin; k < which.end; k++)
    if (rows[k].active)
      corner.rows.push_back(
          {k, slip(rows[k]), masses.inverse_of_others_by_load(rows[k], mesh.w_solver)});
  corner.repeat(mesh.w_solver[rows[which.begin].slots[0]],
                [this](ContactCorner::Row &of, const Vec3 &relative) -> Vec3 {
                  return rub(of.number, relative);
                });
  for (const ContactCorner::Row &of : corner.rows) masses.apply(rows[of.number], of.impulse);
}

void ContactRows::solve_velocities(const Corner &which)
{
  corner.rows.clear();
  for (int k = which.begin; k < which.end; k++)
    if (rows[k].active && rows[k].normal_correction > 0.0)
      corner.rows.push_back({k, rows[k].relative(velocity),
                             masses.inverse_of_others_by_load(rows[k], mesh.w_solver),
                             exchanged_by(k)});
  corner.repeat(mesh.w_solver[rows[which.begin].slots[0]],
                [this](ContactCorner::Row &of, const Vec3 &relative) {
                  return velocity_impulse(of.number, relative, of.so_far);
                });
  for (const ContactCorner::Row &of : corner.rows) masses.apply(rows[of.number], of.impulse);
}
