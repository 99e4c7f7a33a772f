// SPDX-License-Identifier: GPL-2.0-or-later
// Reads and evaluates the velocity of the air.

#include "air/wind.h"

#include "atom.h"
#include "cloth/vertex_halo.h"
#include "core/util/bytes.h"
#include "domain.h"
#include "error.h"
#include "lammps_util/arg_reader.h"

#include <algorithm>

using namespace LAMMPS_NS;

static constexpr const char *AXES = "xyz";

void Wind::read_mean(ArgReader &args)
{
  for (int d = 0; d < 3; d++) {
    along[d].read(args, fmt::format("wind along {}", AXES[d]));
    along[d].check(lmp, owner);
  }
}

void Wind::read_gust(ArgReader &args)
{
  constexpr int MAX_SEED = 900000000;
  const double sigma = args.at_least("rms velocity of 'gust'", 0.0);
  const double length = args.positive("length of 'gust'");
  const int seed = args.integer("seed of 'gust'", 1, MAX_SEED);
  gust = sphcloth::GustField(sigma, length, static_cast<std::uint64_t>(seed));
}

void Wind::check()
{
  for (NumberOrVariable &one : along) one.check(lmp, owner);
  if (!gust.empty() &&
      std::any_of(along.begin(), along.end(), [](const auto &one) { return one.is_per_atom(); }))
    error->all(
        FLERR,
        "{}: 'gust' is carried by one wind for all, and that of 'wind' is a variable of style "
        "atom: use variables of style equal, or leave out 'gust'",
        owner);
}

void Wind::find(int igroup)
{
  NumberOrVariable::evaluate(lmp, owner, igroup, {&along[0], &along[1], &along[2]});
}

void Wind::add_to(const VertexHalo &halo, std::vector<Vec3> &velocities)
{
  const int n = halo.n_owned();
  const Vec3 of_all = mean();
  for (int s = 0; s < n; s++) velocities[s] += of_all;
  for (int d = 0; d < 3; d++)
    if (along[d].is_per_atom())
      for (int s = 0; s < n; s++) velocities[s][d] += along[d].of(halo.atom_of(s));
  if (gust.empty()) return;
  for (int d = 0; d < 3; d++) {
    point[d].resize(n);
    velocity[d].assign(n, 0.0);
  }
  for (int s = 0; s < n; s++) {
    double x[3];
    domain->unmap(atom->x[halo.atom_of(s)], atom->image[halo.atom_of(s)], x);
    for (int d = 0; d < 3; d++) point[d][s] = x[d] - carried[d];
  }
  const double *const from[3] = {point[0].data(), point[1].data(), point[2].data()};
  double *const to[3] = {velocity[0].data(), velocity[1].data(), velocity[2].data()};
  gust.add(n, from, to);
  for (int s = 0; s < n; s++) velocities[s] += Vec3(velocity[0][s], velocity[1][s], velocity[2][s]);
}

double Wind::bytes() const
{
  double sum = 0.0;
  for (int d = 0; d < 3; d++) sum += along[d].bytes() + sphcloth::bytes_of(point[d], velocity[d]);
  return sum;
}
