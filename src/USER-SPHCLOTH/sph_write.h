// SPDX-License-Identifier: GPL-2.0-or-later
// sph_write: tables of a kernel or of an equation of state, as the pair style uses them.

#ifdef COMMAND_CLASS
// clang-format off
CommandStyle(sph_write,SPHWrite);
// clang-format on
#else

#ifndef LMP_SPH_WRITE_H
#define LMP_SPH_WRITE_H

#include "command.h"

#include <string>

namespace LAMMPS_NS {

class ArgReader;
class FluidState;

class SPHWrite : public Command {
 public:
  SPHWrite(class LAMMPS *lmp_) : Command(lmp_), fluid(nullptr) {}
  void command(int, char **) override;

 private:
  FluidState *fluid;

  void write_kernel(ArgReader &);
  void write_state(ArgReader &);
  int read_type(ArgReader &, const std::string &) const;
  void append(const std::string &file, const std::string &table) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
