// SPDX-License-Identifier: GPL-2.0-or-later
// An argument that is a number, or a variable that is evaluated in each step.

#ifndef SPHCLOTH_LAMMPS_UTIL_NUMBER_OR_VARIABLE_H
#define SPHCLOTH_LAMMPS_UTIL_NUMBER_OR_VARIABLE_H

#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

class ArgReader;
class LAMMPS;

class NumberOrVariable {
 public:
  enum class Styles { EQUAL, EQUAL_OR_ATOM };

  NumberOrVariable() = default;
  explicit NumberOrVariable(Styles allowed_) : allowed(allowed_) {}

  // what: it is, for errors; low: the least that a number may be
  void read(ArgReader &, const std::string &what,
            double low = -std::numeric_limits<double>::infinity());

  bool is_variable() const { return !name.empty(); }
  bool is_per_atom() const { return per_atom; }

  // Does the variable exist, in a style that is allowed?  owner: the style, for errors.
  void check(LAMMPS *, const std::string &owner);

  // Those of several that are variables, once a step; collective.  igroup: the group whose atoms
  // have values.
  using Span = std::pair<NumberOrVariable *const *, std::size_t>;
  static void evaluate(LAMMPS *, const std::string &owner, int igroup, Span);
  static void evaluate(LAMMPS *lmp, const std::string &owner, int igroup,
                       std::initializer_list<NumberOrVariable *> of)
  {
    evaluate(lmp, owner, igroup, {of.begin(), of.size()});
  }

  std::string as_given() const;    // for errors: the number, or v_ and the name
  double value() const { return number; }    // 0 if atoms have values of their own
  double of(int atom_index) const { return per_atom ? by_atom[atom_index] : number; }

  double bytes() const;

 private:
  Styles allowed = Styles::EQUAL;
  std::string what, name;    // no name: a number
  int index = -1;
  bool per_atom = false;
  double number = 0.0;
  std::vector<double> by_atom;

  void evaluate(LAMMPS *, const std::string &owner, int igroup);
};

}    // namespace LAMMPS_NS

#endif
