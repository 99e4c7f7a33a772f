// SPDX-License-Identifier: GPL-2.0-or-later
// Collects triangles of a rank, and exchanges motion and impulses of their vertices.

#include "air/air_mesh.h"

#include "atom.h"
#include "core/util/bytes.h"

#include <Eigen/Geometry>

#include <algorithm>

using namespace LAMMPS_NS;

static constexpr int ALL = 0;    // the only channel

AirMesh::AirMesh(LAMMPS *lmp_, ContactMesh *mesh_, const std::vector<tagint> &in_fix) :
    Pointers(lmp_), mesh(mesh_), halo(lmp_), n_triangles(mesh_->topology().n_vertices(), 0)
{
  const ClothTopology &cloth = mesh->topology();
  std::vector<bool> in_group;
  for (const tagint id : cloth.ids)
    in_group.push_back(std::binary_search(in_fix.begin(), in_fix.end(), id));
  for (const auto &t : cloth.triangles.vertices) {
    feels.push_back(in_group[t[0]] && in_group[t[1]] && in_group[t[2]]);
    if (!feels.back()) continue;
    n_felt++;
    for (const int vertex : t) n_triangles[vertex]++;
  }
}

void AirMesh::rebuild()
{
  const ClothTopology &cloth = mesh->topology();
  std::vector<int> owned, vertices;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!mesh->has_vertex(i)) continue;
    const int vertex = cloth.index_of(atom->tag[i]);
    if (vertex < 0 || n_triangles[vertex] == 0) continue;
    owned.push_back(i);
    vertices.push_back(vertex);
  }
  halo.reset(1, owned);
  for (std::vector<int> &slots : triangles.slot) slots.clear();
  const ClothElements<3> &all = cloth.triangles;
  for (std::size_t s = 0; s < owned.size(); s++)
    for (int k = all.first[vertices[s]]; k < all.first[vertices[s] + 1]; k++) {
      const std::array<int, 3> &t = all.vertices[all.incident[k]];
      if (!feels[all.incident[k]] || t[0] != vertices[s]) continue;
      triangles.slot[0].push_back(static_cast<int>(s));
      for (int q = 1; q < 3; q++)
        triangles.slot[q].push_back(halo.slot_of(cloth.image_here(t[q], owned[s])));
    }
  for (int s = halo.n_owned(); s < halo.n_slots(); s++) halo.need(s, ALL);
  halo.connect();
  for (std::vector<Vec3> *each : {&x, &v, &gain, &impulse})
    each->assign(halo.n_slots(), Vec3::Zero());
  find_inverse_mass();
}

void AirMesh::find_inverse_mass()
{
  const ClothTopology &cloth = mesh->topology();
  std::vector<double> of_vertex(halo.n_slots(), 0.0);
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    of_vertex[s] = n_triangles[cloth.index_of(atom->tag[i])] * mesh->inverse_mass(i) / 9.0;
  }
  halo.forward(ALL, of_vertex);
  triangles.inverse_mass.clear();
  for (int t = 0; t < triangles.size(); t++)
    triangles.inverse_mass.push_back(of_vertex[triangles.slot[0][t]] +
                                     of_vertex[triangles.slot[1][t]] +
                                     of_vertex[triangles.slot[2][t]]);
}

void AirMesh::forward_motion()
{
  halo.forward_positions(ALL, x.data());
  halo.forward_velocities(ALL, v.data());
  halo.forward(ALL, gain.data());
  if (wind.empty()) return;
  halo.forward(ALL, wind.data());
  triangles.lee_share.resize(triangles.size());
}

void AirMesh::forward_positions(std::vector<Vec3> &by_slot)
{
  halo.forward_positions(ALL, by_slot.data());
}

double AirMesh::add_loads(const sphcloth::AirDrag &drag, double dt)
{
  find_open_share();
  std::fill(impulse.begin(), impulse.end(), Vec3::Zero());
  const double area = add_air_impulses(triangles, {x.data(), v.data(), gain.data(), wind.data()},
                                       drag, dt, impulse.data());
  halo.reverse_add(ALL, impulse.data());
  return area;
}

// Each side has half of the force.  It has none where water fills as much of the space on that side
// as a layer of one spacing.  Of S, the share of space around a point, and G, the sum of directions
// times shares, the part on the side of n is (S + 2 G n) / 2 in water without a gap, whose mean
// cosine on its side is 1/2.

void AirMesh::find_open_share()
{
  constexpr double COVERS = 0.1;
  triangles.open_share.clear();
  if (water_side.empty()) return;
  halo.forward(ALL, water);
  halo.forward(ALL, water_side.data());
  for (int t = 0; t < triangles.size(); t++) {
    const int a = triangles.slot[0][t], b = triangles.slot[1][t], c = triangles.slot[2][t];
    const double share = (water[a] + water[b] + water[c]) / 3.0;
    double covered = 0.0;
    if (share > 0.0) {
      const Vec3 normal = (x[b] - x[a]).cross(x[c] - x[a]).normalized();
      const double along = 2.0 / 3.0 * normal.dot(water_side[a] + water_side[b] + water_side[c]);
      for (const double side : {share + along, share - along})
        covered += 0.5 * std::min(1.0, std::max(0.0, 0.5 * side) / COVERS);
    }
    triangles.open_share.push_back(1.0 - covered);
  }
}

void AirMesh::find_dry_areas(std::vector<Vec3> &area)
{
  area.assign(halo.n_slots(), Vec3::Zero());
  for (int t = 0; t < triangles.size(); t++) {
    const auto [a, b, c] = corners(t);
    const double dry = triangles.open_share.empty() ? 1.0 : triangles.open_share[t];
    const Vec3 third = dry / 6.0 * (x[b] - x[a]).cross(x[c] - x[a]);
    for (const std::vector<int> &slots : triangles.slot) area[slots[t]] += third;
  }
  halo.reverse_add(ALL, area.data());
}

double AirMesh::bytes() const
{
  using sphcloth::bytes_of;
  double sum =
      halo.memory_usage() + bytes_of(x, v, gain, wind, impulse, water, water_side, n_triangles);
  for (const std::vector<int> &slots : triangles.slot) sum += bytes_of(slots);
  return sum + bytes_of(triangles.inverse_mass, triangles.open_share, triangles.lee_share);
}
