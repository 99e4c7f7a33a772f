// SPDX-License-Identifier: GPL-2.0-or-later
// Every rank gets the triangles of all, and looks up its own.

#include "air/wind_shade.h"

#include "air/air_mesh.h"
#include "comm.h"
#include "lammps_util/atom_tools.h"

using namespace LAMMPS_NS;

void WindShade::find(const std::vector<AirMesh *> &meshes)
{
  corners_here.clear();
  AirMesh::Vec3 here = AirMesh::Vec3::Zero(), wind;
  for (const AirMesh *mesh : meshes) {
    for (int s = 0; s < mesh->halo.n_owned(); s++) here += mesh->wind[s];
    for (int t = 0; t < mesh->n_triangles_here(); t++) {
      corners_here.emplace_back();
      for (int k = 0; k < 9; k++) corners_here.back()[k] = mesh->triangle(t)[k / 3][k % 3];
    }
  }
  MPI_Allreduce(here.data(), wind.data(), 3, MPI_DOUBLE, MPI_SUM, world);
  allgather(corners_here, corners, comm->nprocs, world);
  triangles.clear();
  for (const Corners &c : corners)
    triangles.push_back({AirMesh::Vec3(c[0], c[1], c[2]), AirMesh::Vec3(c[3], c[4], c[5]),
                         AirMesh::Vec3(c[6], c[7], c[8])});
  const bool blows = !wind.isZero(0.0);
  if (blows) shadow.build(triangles, wind);
  for (AirMesh *mesh : meshes)
    for (int t = 0; t < mesh->n_triangles_here(); t++)
      mesh->set_lee_share(t, blows ? shadow.lee_share(mesh->triangle(t)) : 0.0);
}
