// SPDX-License-Identifier: GPL-2.0-or-later
// Every rank gets the triangles of all, and looks up its own.

#include "air/wind_shade.h"

#include "air/air_mesh.h"
#include "comm.h"
#include "domain.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/lammps_version.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

// of the mean length of an edge in the picture: parts that moved less against each other leave
// what is in the lee as it is
static constexpr double MOVES = 0.5;

// The picture is that of the positions that are kept: nothing depends on when lists are built or a
// run begins.

void WindShade::find(const std::vector<AirMesh *> &meshes)
{
  const Vec3 direction = mean_direction(meshes);
  if (!is_known && !found_with.isZero(0.0)) find_shares(meshes);
  if (still_holds(meshes, direction)) return;
  found_with = direction;
  record(meshes);
  find_shares(meshes);
}

void WindShade::record(const std::vector<AirMesh *> &meshes)
{
  for (const AirMesh *mesh : meshes)
    for (int s = 0; s < mesh->halo.n_owned(); s++)
      for (int d = 0; d < 3; d++) columns[first + d][mesh->halo.atom_of(s)] = mesh->x[s][d];
}

// of an owned vertex since then; LAMMPS may have moved it by a period

WindShade::Vec3 WindShade::displacement(const AirMesh &mesh, int slot) const
{
  const int i = mesh.halo.atom_of(slot);
  Vec3 moved = mesh.x[slot] - Vec3(columns[first][i], columns[first + 1][i], columns[first + 2][i]);
  release::minimum_image(domain, moved.data());
  return moved;
}

void WindShade::find_shares(const std::vector<AirMesh *> &meshes)
{
  is_known = true;
  const bool blows = !found_with.isZero(0.0);
  if (blows) {
    gather(meshes);
    shadow.build(points, corners, found_with);
  }
  std::size_t n = 0;
  for (AirMesh *mesh : meshes)
    for (int t = 0; t < mesh->n_triangles_here(); t++)
      mesh->set_lee_share(t, blows ? shadow.lee_share(corners_here[n++]) : 0.0);
}

WindShade::Vec3 WindShade::mean_direction(const std::vector<AirMesh *> &meshes) const
{
  Vec3 here = Vec3::Zero(), sum;
  for (const AirMesh *mesh : meshes)
    for (int s = 0; s < mesh->halo.n_owned(); s++) here += mesh->wind[s];
  MPI_Allreduce(here.data(), sum.data(), 3, MPI_DOUBLE, MPI_SUM, world);
  return sum.normalized();
}

// A turn of the wind moves what is behind in the picture against what is in front.  Two vertices
// have moved against each other by no more than both have moved from the mean, which is the same
// whatever the axes.

bool WindShade::still_holds(const std::vector<AirMesh *> &meshes, const Vec3 &direction) const
{
  if (found_with.isZero(0.0)) return false;
  const double allowed = MOVES * shadow.mean_size();
  if ((direction - found_with).norm() * shadow.depth() > allowed) return false;
  Eigen::Vector4d here = Eigen::Vector4d::Zero(), sum;    // of displacements, and of vertices
  for (const AirMesh *mesh : meshes) {
    for (int s = 0; s < mesh->halo.n_owned(); s++) here.head<3>() += displacement(*mesh, s);
    here[3] += mesh->halo.n_owned();
  }
  MPI_Allreduce(here.data(), sum.data(), 4, MPI_DOUBLE, MPI_SUM, world);
  const Vec3 mean = sum.head<3>() / std::max(1.0, sum[3]);
  double mine_sq = 0.0, farthest_sq;
  for (const AirMesh *mesh : meshes)
    for (int s = 0; s < mesh->halo.n_owned(); s++)
      mine_sq = std::max(mine_sq, (displacement(*mesh, s) - mean).squaredNorm());
  MPI_Allreduce(&mine_sq, &farthest_sq, 1, MPI_DOUBLE, MPI_MAX, world);
  return 2.0 * std::sqrt(farthest_sq) <= allowed;
}

void WindShade::gather(const std::vector<AirMesh *> &meshes)
{
  points_here.clear();
  corners_here.clear();
  int before = 0, n_here = 0;    // vertices of other ranks, and of meshes
  for (const AirMesh *mesh : meshes) n_here += mesh->halo.n_slots();
  MPI_Exscan(&n_here, &before, 1, MPI_INT, MPI_SUM, world);
  if (comm->me == 0) before = 0;    // MPI leaves it undefined
  for (AirMesh *mesh : meshes) {
    const int number = before + static_cast<int>(points_here.size());
    seen.resize(mesh->halo.n_slots());
    for (int s = 0; s < mesh->halo.n_owned(); s++) seen[s] = mesh->x[s] - displacement(*mesh, s);
    mesh->forward_positions(seen);
    for (const Vec3 &at : seen) points_here.push_back({at[0], at[1], at[2]});
    for (int t = 0; t < mesh->n_triangles_here(); t++) {
      const std::array<int, 3> s = mesh->corners(t);
      corners_here.push_back({number + s[0], number + s[1], number + s[2]});
    }
  }
  allgather(points_here, points, comm->nprocs, world);
  allgather(corners_here, corners, comm->nprocs, world);
}
