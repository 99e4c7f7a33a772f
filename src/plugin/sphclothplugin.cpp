// SPDX-License-Identifier: GPL-2.0-or-later
// What LAMMPS calls when it loads the plugin: every style is registered under its name.

#include "lammpsplugin.h"

#include "lammps.h"
#include "library.h"

#include "bond_pbd.h"
#include "compute_cloth_contact.h"
#include "compute_pbd_atom.h"
#include "compute_pbd_cloth.h"
#include "compute_pbd_local.h"
#include "compute_sph_atom.h"
#include "compute_sph_step.h"
#include "create_cloth.h"
#include "dihedral_pbd.h"
#include "fix_cloth_air.h"
#include "fix_cloth_contact.h"
#include "fix_cloth_gas.h"
#include "fix_cloth_pores.h"
#include "fix_pbd_cloth.h"
#include "fix_sph_drain.h"
#include "fix_sph_emit.h"
#include "fix_sph_integrate.h"
#include "fix_sph_shift.h"
#include "fix_sph_watch.h"
#include "fix_wall_sph.h"
#include "lammps_util/lammps_version.h"
#include "pair_sph_tait.h"
#include "sph_adaptive.h"
#include "sph_write.h"

#include <cstdio>
#include <string>

#if defined(SPHCLOTH_CXX11_ABI) && SPHCLOTH_CXX11_ABI != _GLIBCXX_USE_CXX11_ABI
#error "this compiler has no strings of LAMMPS's ABI (_GLIBCXX_USE_CXX11_ABI): use LAMMPS's"
#endif

using namespace LAMMPS_NS;

#define SPHCLOTH_EXPORT extern "C" __attribute__((visibility("default")))

// release of LAMMPS whose headers this was compiled with, yyyymmdd
SPHCLOTH_EXPORT int sphcloth_lammps_version;
int sphcloth_lammps_version = release::VERSION;

// size of an atom ID: 4 with LAMMPS_SMALLBIG, 8 with LAMMPS_BIGBIG
SPHCLOTH_EXPORT int sphcloth_tagint_bytes;
int sphcloth_tagint_bytes = sizeof(tagint);

namespace {

template <class Style> void *create(void *lmp) { return new Style(static_cast<LAMMPS *>(lmp)); }

template <class Style> void *create_with_args(void *lmp, int narg, char **arg)
{
  return new Style(static_cast<LAMMPS *>(lmp), narg, arg);
}

// Classes of another release, or with integers of other sizes, may be laid out differently: nothing
// but these two facts may be asked.

void refuse(void *lmp, const std::string &built_for, const std::string &running)
{
  if (lammps_extract_setting(lmp, "world_rank") != 0) return;
  std::fprintf(stderr,
               "ERROR: sphcloth was built for LAMMPS %s, this is %s: none of its styles is loaded. "
               "'sphcloth doctor' names what fits\n",
               built_for.c_str(), running.c_str());
}

bool fits(void *lmp)
{
  const int running = lammps_version(lmp);
  if (running != sphcloth_lammps_version) {
    refuse(lmp, "release " + std::to_string(sphcloth_lammps_version), std::to_string(running));
    return false;
  }
  const int bytes = lammps_extract_setting(lmp, "tagint");
  if (bytes != sphcloth_tagint_bytes) {
    const auto sizes = [](int n) { return n == 4 ? "LAMMPS_SMALLBIG" : "LAMMPS_BIGBIG"; };
    refuse(lmp, std::string("with ") + sizes(sphcloth_tagint_bytes), sizes(bytes));
    return false;
  }
  return true;
}

}    // namespace

SPHCLOTH_EXPORT void lammpsplugin_init(void *lmp, void *handle, void *regfunc)
{
  if (!fits(lmp)) return;
  const auto register_style = reinterpret_cast<lammpsplugin_regfunc>(regfunc);

  lammpsplugin_t plugin = {};
  plugin.version = static_cast<LAMMPS *>(lmp)->version;
  plugin.author = "The SPHCLOTH developers";
  plugin.handle = handle;
  const auto add = [&](const char *style, const char *name, const char *info) {
    plugin.style = style;
    plugin.name = name;
    plugin.info = info;
    register_style(&plugin, lmp);
    release::add_to_each_instance(static_cast<LAMMPS *>(lmp), plugin);
  };

  plugin.creator.v1 = &create<PairSPHTait>;
  add("pair", "sph/tait", "weakly compressible SPH, Tait equation of state");
  plugin.creator.v1 = &create<BondPBD>;
  add("bond", "pbd", "distance constraints of cloth");
  plugin.creator.v1 = &create<DihedralPBD>;
  add("dihedral", "pbd", "hinge constraints of cloth");
  plugin.creator.v2 = &create_with_args<FixPBDCloth>;
  add("fix", "pbd/cloth", "position-based dynamics of cloth");
  plugin.creator.v2 = &create_with_args<FixClothContact>;
  add("fix", "cloth/contact", "contact of particles with cloth");
  plugin.creator.v2 = &create_with_args<FixClothAir>;
  add("fix", "cloth/air", "wind and drag on cloth");
  plugin.creator.v2 = &create_with_args<FixSPHIntegrate>;
  add("fix", "sph/integrate", "time stepping of SPH particles");
  plugin.creator.v2 = &create_with_args<FixClothGas>;
  add("fix", "cloth/gas", "gas in chambers of cloth");
  plugin.creator.v2 = &create_with_args<FixClothPores>;
  add("fix", "cloth/pores", "fluid that goes through cloth");
  plugin.creator.v2 = &create_with_args<FixSPHEmit>;
  add("fix", "sph/emit", "source of SPH particles");
  plugin.creator.v2 = &create_with_args<FixSPHDrain>;
  add("fix", "sph/drain", "outflow of SPH particles");
  plugin.creator.v2 = &create_with_args<FixSPHShift>;
  add("fix", "sph/shift", "particle shifting");
  plugin.creator.v2 = &create_with_args<FixSPHWatch>;
  add("fix", "sph/watch", "limits at which a run ends");
  plugin.creator.v2 = &create_with_args<FixWallSPH>;
  add("fix", "wall/sph", "plane walls without particles");
  plugin.creator.v2 = &create_with_args<ComputeClothContact>;
  add("compute", "cloth/contact", "counts, impulses and forces of contact with cloth");
  plugin.creator.v2 = &create_with_args<ComputePBDAtom>;
  add("compute", "pbd/atom", "strain, curvature and holding forces of cloth by vertex");
  plugin.creator.v2 = &create_with_args<ComputePBDCloth>;
  add("compute", "pbd/cloth", "strain, residual, energy and holding force of cloth");
  plugin.creator.v2 = &create_with_args<ComputePBDLocal>;
  add("compute", "pbd/local", "strain of edges and angles of hinges of cloth");
  plugin.creator.v2 = &create_with_args<ComputeSPHAtom>;
  add("compute", "sph/atom", "per-atom quantities of SPH particles");
  plugin.creator.v2 = &create_with_args<ComputeSPHStep>;
  add("compute", "sph/step", "limits and updates of the time steps of SPH particles");
  plugin.creator.v1 = &create<SPHWrite>;
  add("command", "sph_write", "tables of a kernel or an equation of state");
  plugin.creator.v1 = &create<CreateCloth>;
  add("command", "create_cloth", "sheet of vertices, bonds, triangles and hinges");
  if (release::LOADS_RUN_STYLES) {
    plugin.creator.v2 = &create_with_args<SPHAdaptive>;
    add("run", "sph/adaptive", "adaptive time steps");
  } else
    release::add_run_style<SPHAdaptive>(static_cast<LAMMPS *>(lmp), "sph/adaptive");
}
