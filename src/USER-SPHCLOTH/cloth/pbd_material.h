// SPDX-License-Identifier: GPL-2.0-or-later
// What bond_coeff and dihedral_coeff say of a constraint, and the springs it is made of.

#ifndef SPHCLOTH_CLOTH_PBD_MATERIAL_H
#define SPHCLOTH_CLOTH_PBD_MATERIAL_H

#include "comm.h"
#include "core/pbd/constraints.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/lammps_version.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

namespace LAMMPS_NS {

struct PBDMaterial {    // plain and without gaps, for the restart file
  int compliant = 0;    // k or compliance?
  int no_rest = 0;      // rest length or angle 0, whatever the rest positions say
  double k = 0.0;
  double compliance = 0.0;
  double compress = 1.0;    // stiffness in compression over that in tension, of a bond
  double limit = -1.0;      // largest strain of a bond, < 0: none

  // N k keyword value ..., or N compliance A keyword value ...; of_bond: all keywords are known

  static PBDMaterial read(ArgReader &args, bool of_bond)
  {
    PBDMaterial m;
    if (args.more() && std::string(args.peek()) == "compliance") {
      args.word("compliance");
      m.compliant = 1;
      m.compliance = args.at_least("compliance", 0.0);
    } else
      m.k = args.fraction("stiffness k");
    while (args.more()) {
      const std::string keyword = args.word("keyword");
      if (keyword == "rest")
        m.no_rest = args.choice(keyword, {"model", of_bond ? "zero" : "flat"});
      else if (of_bond && keyword == "compress")
        m.read_compress(args);
      else if (of_bond && keyword == "limit")
        m.limit = args.at_least(keyword, 0.0);
      else
        args.unknown(keyword, of_bond ? "compress, limit, rest" : "rest");
    }
    return m;
  }

  // the constraints that act together, with n sweeps to do what (9) says
  std::vector<sphcloth::Spring> springs(double rest, int n) const
  {
    constexpr double PULLS_AND_PUSHES = std::numeric_limits<double>::infinity(), PULLS = 0.0;
    constexpr double SOFTEST =
        1e200;    // does nothing, and is still finite over a time step squared
    std::vector<sphcloth::Spring> all;
    if (no_rest) rest = 0.0;
    const auto add = [&](double share, double max_lambda) {
      if (compliant)
        all.push_back({rest, 1.0, std::min(compliance / share, SOFTEST), max_lambda});
      else
        all.push_back({rest, sphcloth::stiffness_per_iteration(k, n), 0.0, max_lambda});
    };
    // two parallel springs: one of them slack in compression
    if (compliant || k > 0.0) {
      if (compress > 0.0) add(compress, PULLS_AND_PUSHES);
      if (compress < 1.0) add(1.0 - compress, PULLS);
    }
    if (limit >= 0.0) all.push_back({(1.0 + limit) * rest, 1.0, 0.0, PULLS});
    return all;
  }
  int n_springs() const { return static_cast<int>(springs(1.0, 1).size()); }

  // as the user would write it, every digit
  std::string words(bool of_bond) const
  {
    std::string text = compliant ? fmt::format("compliance {}", compliance) : fmt::format("{}", k);
    if (compress != 1.0) text += fmt::format(" compress {}", compress);
    if (limit >= 0.0) text += fmt::format(" limit {}", limit);
    if (no_rest) text += of_bond ? " rest zero" : " rest flat";
    return text;
  }

 private:
  void read_compress(ArgReader &args)
  {
    compress = args.fraction("compress");
    if (compress > 0.0 && compress < 1.0 && compliance == 0.0)
      args.fail("compress", std::to_string(compress),
                "only a compliance > 0 has a stiffness to take a share of: use 0 or 1");
  }
};

static_assert(sizeof(PBDMaterial) == 2 * sizeof(int) + 4 * sizeof(double),
              "what lies in gaps would go to the restart file");

// a style that has materials of types: bond_style pbd, dihedral_style pbd

class HasPBDMaterials {
 public:
  virtual bool owns(int type) const = 0;    // or is it another style's, of a hybrid one?
  virtual const PBDMaterial &material(int type) const = 0;

 protected:
  ~HasPBDMaterials() noexcept(false) = default;
};

// of all types, as these store them

class PBDMaterials {
 public:
  void allocate(int n_types) { of.assign(n_types + 1, PBDMaterial()); }
  PBDMaterial &operator[](int type) { return of[type]; }
  const PBDMaterial &operator[](int type) const { return of[type]; }

  void write_restart(FILE *fp) const { fwrite(&of[1], sizeof(PBDMaterial), of.size() - 1, fp); }
  void read_restart(FILE *fp, Comm *comm, Error *error, MPI_Comm world)
  {
    if (comm->me == 0)
      utils::sfread(FLERR, &of[1], sizeof(PBDMaterial), of.size() - 1, fp, nullptr, error);
    MPI_Bcast(&of[1], static_cast<int>(sizeof(PBDMaterial) * (of.size() - 1)), MPI_BYTE, 0, world);
  }
  void write_data(FILE *fp, bool of_bond) const
  {
    for (std::size_t t = 1; t < of.size(); t++)
      release::print(fp, "{} {}\n", t, of[t].words(of_bond));
  }

 private:
  std::vector<PBDMaterial> of;
};

}    // namespace LAMMPS_NS

#endif
