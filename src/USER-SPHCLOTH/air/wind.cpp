// SPDX-License-Identifier: GPL-2.0-or-later
// Reads and evaluates the velocity of the air.

#include "air/wind.h"

#include "atom.h"
#include "cloth/vertex_halo.h"
#include "core/util/bytes.h"
#include "domain.h"
#include "error.h"
#include "input.h"
#include "lammps_util/arg_reader.h"
#include "modify.h"
#include "update.h"
#include "variable.h"

#include <algorithm>

using namespace LAMMPS_NS;

static constexpr const char *AXES = "xyz";

void Wind::read_mean(ArgReader &args)
{
  for (int d = 0; d < 3; d++) {
    const std::string what = fmt::format("wind along {}", AXES[d]);
    variable[d].clear();
    if (args.more() && utils::strmatch(args.peek(), "^v_")) {
      variable[d] = args.word(what).substr(2);
      mean[d] = 0.0;
      if (input->variable->find(variable[d].c_str()) < 0)
        args.fail(what, "v_" + variable[d],
                  "define this variable before the fix, or give a number");
    } else
      mean[d] = args.number(what);
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

bool Wind::varies() const
{
  return std::any_of(variable.begin(), variable.end(), [](const auto &v) { return !v.empty(); });
}

void Wind::check()
{
  for (int d = 0; d < 3; d++)
    if (!variable[d].empty()) check_variable(d);
  if (!gust.empty() && std::any_of(per_atom.begin(), per_atom.end(), [](bool b) { return b; }))
    error->all(
        FLERR,
        "{}: 'gust' is carried by one wind for all, and that of 'wind' is a variable of style "
        "atom: use variables of style equal, or leave out 'gust'",
        owner);
}

void Wind::check_variable(int d)
{
  const char *name = variable[d].c_str();
  index[d] = input->variable->find(const_cast<char *>(name));
  if (index[d] < 0)
    error->all(FLERR, "{}: wind along {} is 'v_{}': this variable is gone, define it again", owner,
               AXES[d], name);
  per_atom[d] = input->variable->atomstyle(index[d]);
  if (!per_atom[d] && !input->variable->equalstyle(index[d]))
    error->all(
        FLERR,
        "{}: wind along {} is 'v_{}': this variable has another style, use one of style equal "
        "or atom",
        owner, AXES[d], name);
  if (!per_atom[d]) of_atom[d].clear();
}

void Wind::find(int igroup)
{
  if (!varies()) return;
  modify->clearstep_compute();
  for (int d = 0; d < 3; d++) {
    if (variable[d].empty()) continue;
    if (!per_atom[d]) {
      mean[d] = input->variable->compute_equal(index[d]);
      continue;
    }
    of_atom[d].resize(std::max(1, atom->nmax));
    input->variable->compute_atom(index[d], igroup, of_atom[d].data(), 1, 0);
  }
  modify->addstep_compute(update->ntimestep + 1);
}

void Wind::add_to(const VertexHalo &halo, std::vector<Vec3> &velocities)
{
  const int n = halo.n_owned();
  for (int s = 0; s < n; s++) velocities[s] += mean;
  for (int d = 0; d < 3; d++)
    if (per_atom[d])
      for (int s = 0; s < n; s++) velocities[s][d] += of_atom[d][halo.atom_of(s)];
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
  for (int d = 0; d < 3; d++) sum += sphcloth::bytes_of(of_atom[d], point[d], velocity[d]);
  return sum;
}
