// SPDX-License-Identifier: GPL-2.0-or-later
// Copies vertices of cloths to those of all of them, and back.

#include "contact/joined_cloths.h"

#include "core/util/bytes.h"

using namespace LAMMPS_NS;
using sphcloth::Vertex;

SolverCoupling *JoinedCoupling::add_part(const ContactMesh *cloth)
{
  parts.push_back(std::make_unique<Part>(*this, cloth, parts.empty()));
  return parts.back().get();
}

// Owned vertices of each are in the order of atoms.

void JoinedCoupling::rebuild()
{
  for (auto &part : parts) {
    part->slots.clear();
    for (int s = 0; s < halo.n_owned(); s++)
      if (part->cloth->has_vertex(halo.atom_of(s))) part->slots.push_back(s);
  }
  start.resize(halo.n_owned());
  other.resize(halo.n_owned());
}

void JoinedCoupling::scatter()
{
  for (auto &part : parts)
    for (std::size_t s = 0; s < part->slots.size(); s++) {
      const double w = part->target[s].w;
      part->target[s] = other[part->slots[s]];
      part->target[s].w = w;
    }
}

void JoinedCoupling::Part::gather(const Vertex *from, std::vector<Vertex> &to) const
{
  for (std::size_t s = 0; s < slots.size(); s++) to[slots[s]] = from[s];
}

bool JoinedCoupling::Part::begin_step(const Vertex *from, const Vertex *end, double dt)
{
  gather(from, whole.start);
  gather(end, whole.other);
  if (is_last())
    whole.present = whole.all.begin_step(whole.start.data(), whole.other.data(), dt);
  return true;
}

void JoinedCoupling::Part::begin_substep(const Vertex *from, const Vertex *v, double dt)
{
  if (!whole.present) return;
  gather(from, whole.start);
  gather(v, whole.other);
  if (is_last()) whole.all.begin_substep(whole.start.data(), whole.other.data(), dt);
}

void JoinedCoupling::Part::project(Vertex *displacement)
{
  if (!whole.present) return;
  target = displacement;
  gather(displacement, whole.other);
  if (!is_last()) return;
  whole.all.project(whole.other.data());
  whole.scatter();
}

void JoinedCoupling::Part::end_substep(Vertex *v, double dt)
{
  if (!whole.present) return;
  target = v;
  gather(v, whole.other);
  if (!is_last()) return;
  whole.all.end_substep(whole.other.data(), dt);
  whole.scatter();
}

void JoinedCoupling::Part::end_step()
{
  if (whole.present && is_last()) whole.all.end_step();
}

Eigen::Vector3d JoinedCoupling::Part::impulse_on(int slot) const
{
  return whole.present ? whole.all.impulse_on(slots[slot]) : Eigen::Vector3d::Zero();
}

double JoinedCoupling::memory_usage() const { return sphcloth::bytes_of(start, other); }
