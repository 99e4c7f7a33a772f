// SPDX-License-Identifier: GPL-2.0-or-later
// What an evaluation of the fluid sends to ghosts, and gets from them.

#include "fluid/fluid_evaluation.h"

using namespace LAMMPS_NS;

int FluidEvaluation::ghost_size(GhostData what)
{
  switch (what) {
    case GhostData::MASS_OR_VOLUME:
    case GhostData::VISCOSITY:
    case GhostData::SHARE:
    case GhostData::SINCE:
    case GhostData::CHANGE: return 1;
    case GhostData::DENSITY: return 2;
    case GhostData::GRADIENT: return 3;
    case GhostData::TURN: return 4;
    case GhostData::STIFFNESS: return FluidStability::GHOST_SIZE;
    default: return ScaledMass::ghost_size(what);
  }
}

double *FluidEvaluation::pack(GhostData what, int i, double *buf) const
{
  switch (what) {
    case GhostData::MASS_OR_VOLUME: *buf = mass_or_volume[i]; return buf + 1;
    case GhostData::VISCOSITY: *buf = viscosity_shares[i]; return buf + 1;
    case GhostData::DENSITY:
      buf[0] = atom->rho[i];
      buf[1] = p_over_rho2[i];
      return buf + 2;
    case GhostData::SINCE:
    case GhostData::CHANGE:
    case GhostData::GRADIENT: return integrated.pack(what, i, buf);
    case GhostData::TURN: return surface.pack(i, buf);
    case GhostData::STIFFNESS: return stability.pack(i, buf);
    case GhostData::SHARE: *buf = stability.share(i); return buf + 1;
    default: return buf + scaled.pack(what, i, buf);
  }
}

int FluidEvaluation::pack(GhostData what, int n, const int *list, double *buf) const
{
  double *end = buf;
  for (int k = 0; k < n; k++) end = pack(what, list[k], end);
  return static_cast<int>(end - buf);
}

void FluidEvaluation::unpack(GhostData what, int n, int first, const double *buf)
{
  for (int i = first; i < first + n; i++) {
    switch (what) {
      case GhostData::MASS_OR_VOLUME: mass_or_volume[i] = *buf++; break;
      case GhostData::VISCOSITY: viscosity_shares[i] = *buf++; break;
      case GhostData::DENSITY:
        atom->rho[i] = *buf++;
        p_over_rho2[i] = *buf++;
        break;
      case GhostData::SINCE:
      case GhostData::GRADIENT: buf = integrated.unpack(what, i, buf); break;
      case GhostData::TURN: buf = surface.unpack(i, buf); break;
      case GhostData::STIFFNESS: buf = stability.unpack(i, buf); break;
      case GhostData::SHARE: stability.set_share(i, *buf++); break;
      default: buf += scaled.unpack(what, i, buf);
    }
  }
}

int FluidEvaluation::pack_reverse(GhostData what, int n, int first, double *buf) const
{
  double *end = buf;
  for (int i = first; i < first + n; i++) end = pack(what, i, end);
  return static_cast<int>(end - buf);
}

void FluidEvaluation::add(GhostData what, int n, const int *list, const double *buf)
{
  for (int k = 0; k < n; k++) {
    if (what == GhostData::CHANGE)
      integrated.add(list[k], buf[k]);
    else
      scaled.add(list[k], buf + 3 * k);
  }
}
