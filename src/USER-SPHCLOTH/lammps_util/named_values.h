// SPDX-License-Identifier: GPL-2.0-or-later
// A compute that gives values of a fix by keyword: what f_ID and f_ID[n] are, without counting.

#ifndef SPHCLOTH_LAMMPS_UTIL_NAMED_VALUES_H
#define SPHCLOTH_LAMMPS_UTIL_NAMED_VALUES_H

#include "compute.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;
class Fix;

struct NamedValue {
  enum Kind { INTENSIVE, EXTENSIVE };
  std::string name;
  int number;    // n of f_ID[n], 0: the scalar f_ID
  Kind kind;
};

class NamedValues : public Compute {
 public:
  // compute ID group style keyword ...; fix_style: of the fix that knows the values
  NamedValues(class LAMMPS *, int narg, char **arg, const std::string &fix_style,
              const std::vector<NamedValue> &known);
  ~NamedValues() override;
  void init() override;
  double compute_scalar() override;
  void compute_vector() override;
  double memory_usage() override;

 private:
  std::string label, fix_style, fix_id;    // no ID: the only fix of the style
  std::vector<NamedValue> values;          // in the user's order

  void read_keyword(ArgReader &, const std::vector<NamedValue> &known);
  void set_flags();
  Fix &find_fix() const;
};

}    // namespace LAMMPS_NS

#endif
