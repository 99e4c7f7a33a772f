// SPDX-License-Identifier: GPL-2.0-or-later
// Sums over the springs of fluid and meshes.

#include "fluid/mesh_scaling.h"

#include "core/util/bytes.h"

using namespace LAMMPS_NS;
using namespace sphcloth;

void MeshScaling::begin()
{
  springs.clear();
  n_meshes = 0;
}

void MeshScaling::begin_mesh(BoundaryMesh &mesh)
{
  if (n_meshes == meshes.size()) meshes.emplace_back();
  meshes[n_meshes++].of = &mesh;
}

void MeshScaling::add(const ClosestPoint &at, double stiffness, const Vec3 &direction,
                      const Vec3 &velocity)
{
  const int mesh = static_cast<int>(n_meshes) - 1;
  std::array<double, 3> motion;
  for (int q = 0; q < 3; q++)
    motion[q] = direction.dot(velocity - meshes[mesh].of->velocity_of(at.vertices[q]));
  springs.push_back({at.particle, mesh, at.vertices, at.weight, direction, stiffness, motion});
}

void MeshScaling::clear_sums()
{
  for (std::size_t m = 0; m < n_meshes; m++)
    meshes[m].sums.assign(meshes[m].of->halo().n_slots(), Vec3::Zero());
}

void MeshScaling::sum_stiffness(const std::function<void(int, const Mat3 &)> &take)
{
  clear_sums();
  for (std::size_t m = 0; m < n_meshes; m++) meshes[m].mixed = meshes[m].sums;
  for (const Spring &s : springs) {
    const Vec3 &e = s.direction, squares = s.stiffness * e.cwiseProduct(e),
               mixed = s.stiffness * Vec3(e[0] * e[1], e[0] * e[2], e[1] * e[2]);
    for (int q = 0; q < 3; q++) {
      meshes[s.mesh].sums[s.vertices[q]] += s.weight[q] * squares;
      meshes[s.mesh].mixed[s.vertices[q]] += s.weight[q] * mixed;
    }
  }
  for (std::size_t m = 0; m < n_meshes; m++) {
    Mesh &mesh = meshes[m];
    VertexHalo &halo = mesh.of->halo();
    halo.reverse_add(0, mesh.sums.data());
    halo.reverse_add(0, mesh.mixed.data());
    for (int s = 0; s < halo.n_owned(); s++) {
      const Vec3 &a = mesh.sums[s], &b = mesh.mixed[s];
      if (a.isZero(0.0)) continue;
      Mat3 stiffness;
      stiffness << a[0], b[0], b[1], b[0], a[1], b[2], b[1], b[2], a[2];
      take(halo.atom_of(s), stiffness);
    }
  }
}

void MeshScaling::carry(double dt, const OfFluid &kick, const Take &take)
{
  clear_sums();
  for (const Spring &s : springs) {
    const FluidKick &of_fluid = kick(s.fluid);
    for (int q = 0; q < 3; q++) {
      const double mass = MassScaling::SHARE * dt * dt * s.weight[q] * s.stiffness;
      meshes[s.mesh].sums[s.vertices[q]] +=
          mass * of_fluid.along(s.direction, s.motion[q]) * s.direction;
    }
  }
  for (std::size_t m = 0; m < n_meshes; m++) meshes[m].of->sum_up(meshes[m].sums, take);
}

void MeshScaling::give(double dt, const OfFluid &kick,
                       const std::function<VertexChange(int)> &change,
                       const std::function<void(int, const Vec3 &)> &give)
{
  clear_sums();
  for (std::size_t m = 0; m < n_meshes; m++) {
    Mesh &mesh = meshes[m];
    VertexHalo &halo = mesh.of->halo();
    mesh.parts.assign(halo.n_slots(), 0.0);
    for (int s = 0; s < halo.n_owned(); s++) {
      const VertexChange of_vertex = change(halo.atom_of(s));
      mesh.sums[s] = of_vertex.velocity;
      mesh.parts[s] = of_vertex.part_of_step;
    }
    halo.forward(0, mesh.sums.data());
    halo.forward(0, mesh.parts);
  }
  for (const Spring &s : springs) {
    const Mesh &mesh = meshes[s.mesh];
    const FluidKick &of_fluid = kick(s.fluid);
    double impulse = 0.0;
    for (int q = 0; q < 3; q++)
      if (const int v = s.vertices[q]; mesh.parts[v] != 0.0)
        impulse += s.weight[q] *
            (s.direction.dot(mesh.sums[v]) -
             mesh.parts[v] * of_fluid.along(s.direction, s.motion[q]));
    if (impulse == 0.0) continue;
    give(s.fluid, MassScaling::SHARE * dt * dt * s.stiffness * impulse * s.direction);
  }
}

double MeshScaling::bytes() const
{
  double sum = bytes_of(springs);
  for (const Mesh &mesh : meshes) sum += bytes_of(mesh.sums, mesh.mixed, mesh.parts);
  return sum;
}
