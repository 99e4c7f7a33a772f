// SPDX-License-Identifier: GPL-2.0-or-later
// Which fixes replace forces, of which particles, along which axes.

#include "lammps_util/held_particles.h"

#include "fix_setforce.h"
#include "modify.h"
#include "region.h"
#include "utils.h"

using namespace LAMMPS_NS;

static constexpr int ALL_AXES = 7;

namespace {

// what LAMMPS shows to classes that derive from the fix

struct SetForce : FixSetForce {
  static int axes(const FixSetForce &fix)
  {
    return has(fix, &SetForce::xstr, &SetForce::xstyle) |
        has(fix, &SetForce::ystr, &SetForce::ystyle) << 1 |
        has(fix, &SetForce::zstr, &SetForce::zstyle) << 2;
  }
  static Region *const *where(const FixSetForce &fix) { return &(fix.*(&SetForce::region)); }

 private:
  // by a variable, whose style is not known before the fix is initialized, or a number; else NULL
  static bool has(const FixSetForce &fix, char *FixSetForce::*variable, int FixSetForce::*style)
  {
    return fix.*variable || fix.*style != 0;
  }
};

}    // namespace

void HeldParticles::begin_run(Modify *modify)
{
  holders.clear();
  for (const Fix *fix : modify->get_fix_list()) {
    const auto *setforce = dynamic_cast<const FixSetForce *>(fix);
    if (setforce && SetForce::axes(*setforce))
      holders.push_back({fix->groupbit, SetForce::axes(*setforce), SetForce::where(*setforce)});
    else if (utils::strmatch(fix->style, "^freeze"))
      holders.push_back({fix->groupbit, ALL_AXES, nullptr});
  }
}

// Regions that move are where the fix has seen them last.

int HeldParticles::axes(int mask, const double *x, const double *f) const
{
  int axes = 0;
  for (const Holder &holder : holders) {
    if (!(mask & holder.groupbit)) continue;
    Region *region = holder.region ? *holder.region : nullptr;
    if (!region || region->match(x[0], x[1], x[2])) axes |= holder.axes;
  }
  for (int d = 0; d < 3; d++)
    if (f[d] != 0.0) axes &= ~(1 << d);
  return axes;
}
