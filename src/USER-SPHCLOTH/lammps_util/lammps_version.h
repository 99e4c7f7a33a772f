// SPDX-License-Identifier: GPL-2.0-or-later
// What LAMMPS's releases do differently.  The only place that asks which release is compiled for,
// SPHCLOTH_LAMMPS_VERSION, its date as yyyymmdd; see "Releases of LAMMPS" in CONTRIBUTING.md.

#ifndef SPHCLOTH_LAMMPS_UTIL_LAMMPS_VERSION_H
#define SPHCLOTH_LAMMPS_UTIL_LAMMPS_VERSION_H

#include "comm.h"
#include "domain.h"
#include "force.h"
#include "input.h"
#include "lammps.h"
#include "modify.h"
#include "pair.h"
#include "pointers.h"
#include "update.h"

#include <cstdio>
#include <string>
#include <type_traits>
#include <utility>

#ifndef SPHCLOTH_LAMMPS_VERSION
#error "SPHCLOTH_LAMMPS_VERSION, LAMMPS's release date yyyymmdd, comes from cmake or Install.sh"
#elif SPHCLOTH_LAMMPS_VERSION < 20240829
#error "SPHCLOTH needs LAMMPS 29 Aug 2024 or newer"
#endif

namespace LAMMPS_NS::release {

constexpr int VERSION = SPHCLOTH_LAMMPS_VERSION;

// Since 12 Jun 2025 LAMMPS is told where it is called from.

inline void minimum_image(const Domain *domain, double *delta)
{
#if SPHCLOTH_LAMMPS_VERSION >= 20250612
  domain->minimum_image(FLERR, delta);
#else
  domain->minimum_image(delta);
#endif
}

// Before 12 Jun 2025 fix adapt knows no dihedrals, and not all releases have the flag.

template <class DihedralStyle> void not_for_fix_adapt([[maybe_unused]] DihedralStyle *style)
{
#if SPHCLOTH_LAMMPS_VERSION >= 20250612
  style->reinitflag = 0;
#endif
}

// Values per particle that are fewer than comm_forward.  Before 4 Feb 2025 a pair style could not
// name their number.

inline void forward_comm(Comm *comm, Pair *pair, int size)
{
#if SPHCLOTH_LAMMPS_VERSION >= 20250204
  comm->forward_comm(pair, size);
#else
  const int largest = std::exchange(pair->comm_forward, size);
  comm->forward_comm(pair);
  pair->comm_forward = largest;
#endif
}

// LAMMPS has utils::print() since 4 Feb 2025.

template <typename... Args>
void print(std::FILE *fp, fmt::format_string<Args...> format, Args &&...args)
{
  std::fputs(fmt::format(format, std::forward<Args>(args)...).c_str(), fp);
}

// Before 22 Jul 2025 LAMMPS loads no run styles from plugins, but it creates those that it finds in
// its map.

constexpr bool LOADS_RUN_STYLES = VERSION >= 20250722;

template <class RunStyle> void add_run_style(LAMMPS *lmp, const char *name)
{
  (*lmp->update->integrate_map)[name] = [](LAMMPS *lammps, int narg, char **arg) -> Integrate * {
    return new RunStyle(lammps, narg, arg);
  };
}

// Before 22 Jul 2025 LAMMPS registers the styles of a plugin in the first instance that loads it,
// not in others of the same process, but each instance creates those that it finds in its maps.

template <class Plugin> void add_to_each_instance(LAMMPS *lmp, const Plugin &plugin)
{
  if (VERSION >= 20250722) return;
  const std::string style = plugin.style, name = plugin.name;
  const auto add = [&name](auto *map, auto create) {
    using Creator = typename std::remove_pointer_t<decltype(map)>::mapped_type;
    (*map)[name] = reinterpret_cast<Creator>(create);
  };
  if (style == "pair") add(lmp->force->pair_map, plugin.creator.v1);
  if (style == "bond") add(lmp->force->bond_map, plugin.creator.v1);
  if (style == "dihedral") add(lmp->force->dihedral_map, plugin.creator.v1);
  if (style == "fix") add(lmp->modify->fix_map, plugin.creator.v2);
  if (style == "compute") add(lmp->modify->compute_map, plugin.creator.v2);
  if (style == "command") add(lmp->input->command_map, plugin.creator.v1);
}

}    // namespace LAMMPS_NS::release

#endif
