// SPDX-License-Identifier: GPL-2.0-or-later
// Raises the ghost cutoff of LAMMPS.

#include "lammps_util/ghost_reach.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "neighbor.h"
#include "pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;

// so that a mesh that stretches slowly does not ask at every list build
static constexpr double ROOM = 1.1;

// Each atom has fewer images than this, before there is no memory for them.
static constexpr double MAX_IMAGES = 1e4;

static constexpr int TILED = 1;    // of Comm::style

bool GhostReach::matters() const
{
  return comm->nprocs > 1 || domain->xperiodic || domain->yperiodic || domain->zperiodic;
}

// as LAMMPS will find it, which at init() has not yet been

double GhostReach::reach() const
{
  if (!force->pair) return comm->get_comm_cutoff();
  double longest_sq = 0.0;
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++)
      longest_sq = std::max(longest_sq, force->pair->cutsq[i][j]);
  const double listed = longest_sq > 0.0 ? std::sqrt(longest_sq) + neighbor->skin : 0.0;
  return std::max(comm->cutghostuser, listed);
}

std::array<double, 3> GhostReach::periods() const
{
  const double *h_inv = domain->h_inv;
  std::array<double, 3> length{1.0 / std::hypot(h_inv[0], h_inv[5], h_inv[4]),
                               1.0 / std::hypot(h_inv[1], h_inv[3]), 1.0 / h_inv[2]};
  for (int d = 0; d < 3; d++)
    if (!domain->periodicity[d] || d >= domain->dimension)
      length[d] = std::numeric_limits<double>::infinity();
  return length;
}

double GhostReach::shortest_period() const
{
  const auto all = periods();
  return *std::min_element(all.begin(), all.end());
}

double GhostReach::images(double reach) const
{
  double product = 1.0;
  for (const double period : periods()) product *= 1.0 + 2.0 * reach / period;
  return product;
}

void GhostReach::require(double needed, double wanted) { raise(needed, wanted); }

void GhostReach::require_in_run(double needed, double wanted)
{
  if (!raise(needed, wanted)) return;
  comm->setup();
  if (neighbor->style) neighbor->setup_bins();
}

double GhostReach::size_of_box() const
{
  const double period = shortest_period();
  return std::isfinite(period) ? period
                               : std::hypot(domain->prd[0], domain->prd[1], domain->prd[2]);
}

bool GhostReach::raise(double needed, double wanted)
{
  if (!matters() || comm->mode != Comm::SINGLE) return false;
  if (!(images(needed) < MAX_IMAGES))
    error->all(FLERR,
               "{}: needs ghosts as far as {:.6g}, {:.3g} images of each atom in a periodic box: "
               "use a larger box, shorter edges or a smaller thickness",
               owner, needed, images(needed));
  const double now = reach();
  const double goal = images(wanted) < MAX_IMAGES ? std::max(needed, wanted) : needed;
  if (!(goal > now)) return false;
  double raised = ROOM * goal;
  if (comm->style == TILED) {
    const double period = shortest_period();
    if (needed > period)
      error->all(FLERR,
                 "{}: needs ghosts as far as {:.6g}, and comm_style tiled allows {:.6g}, the size "
                 "of the periodic box: use 'comm_style brick', or a larger box",
                 owner, needed, period);
    raised = std::max(now, std::min(raised, period));
  }
  if (raised == now) return false;
  comm->cutghostuser = raised;
  if (comm->me == 0)
    utils::logmesg(lmp, "{}: ghost cutoff raised from {:.6g} to {:.6g}\n", owner, now, raised);
  return true;
}
