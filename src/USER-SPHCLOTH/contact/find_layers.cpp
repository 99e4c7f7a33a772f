// SPDX-License-Identifier: GPL-2.0-or-later
// Each rank looks from a part of the triangles at all of them.

#include "contact/find_layers.h"

#include "comm.h"
#include "core/contact/sheet_layers.h"
#include "domain.h"
#include "lammps_util/lammps_version.h"

#include <vector>

using namespace LAMMPS_NS;
using namespace sphcloth;

bool LAMMPS_NS::have_layers(LAMMPS *lmp, const std::vector<const ClothTopology *> &sheets,
                            double distance)
{
  std::vector<SheetLayers::Triangle> triangles;
  std::vector<Disc> discs;
  for (const ClothTopology *sheet : sheets) {
    const std::vector<double> x = sheet->positions();
    for (const auto &[a, b, c] : sheet->triangles.vertices) {
      const Vec3 first = Eigen::Map<const Vec3>(&x[3 * a]);
      const auto image_of = [&](int vertex) -> Vec3 {
        Vec3 from_first = Eigen::Map<const Vec3>(&x[3 * vertex]) - first;
        release::minimum_image(lmp->domain, from_first.data());
        return first + from_first;
      };
      triangles.push_back({first, image_of(b), image_of(c)});
      discs.push_back(disc_around(first, triangles.back()[1], triangles.back()[2]));
    }
  }
  DiscGrid grid;
  grid.build(discs, distance);
  int mine = 0, any = 0;
  for (std::size_t t = lmp->comm->me; t < discs.size() && !mine; t += lmp->comm->nprocs)
    grid.within(discs[t].center, distance, [&, t](int other) {
      if (mine || static_cast<std::size_t>(other) == t) return;
      mine = is_another_layer(discs[t].center, discs[t].normal, triangles[other], 0.0);
    });
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, lmp->world);
  return any;
}
