// SPDX-License-Identifier: GPL-2.0-or-later
// Variables in the place of numbers, see number_or_variable.h.

#include "lammps_util/number_or_variable.h"

#include "atom.h"
#include "compute.h"
#include "core/util/bytes.h"
#include "error.h"
#include "group.h"
#include "input.h"
#include "lammps.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/rank_error.h"
#include "modify.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

void NumberOrVariable::read(ArgReader &args, const std::string &what_, double low)
{
  what = what_;
  name.clear();
  number = 0.0;
  if (args.more() && utils::strmatch(args.peek(), "^v_"))
    name = args.word(what).substr(2);
  else
    number = std::isfinite(low) ? args.at_least(what, low) : args.number(what);
}

std::string NumberOrVariable::as_given() const
{
  return is_variable() ? "v_" + name : fmt::format("{:g}", number);
}

void NumberOrVariable::check(LAMMPS *lmp, const std::string &owner)
{
  if (!is_variable()) return;
  Variable *variables = lmp->input->variable;
  index = variables->find(name.c_str());
  const bool is_equal = index >= 0 && variables->equalstyle(index);
  per_atom = index >= 0 && allowed == Styles::EQUAL_OR_ATOM && variables->atomstyle(index);
  if (!is_equal && !per_atom)
    lmp->error->all(FLERR, "{}: {} is 'v_{}': define an {} variable of this name", owner, what,
                    name, allowed == Styles::EQUAL ? "equal-style" : "equal- or atom-style");
  if (per_atom) number = 0.0;
}

// Computes that a variable reads must know that they are asked again.  By Modify::addstep_compute()
// all of them would be asked, and energy and virial be summed in every step.

void NumberOrVariable::evaluate(LAMMPS *lmp, const std::string &owner, int igroup, Span of)
{
  const auto [begin, n] = of;
  if (std::none_of(begin, begin + n, [](const auto *one) { return one->is_variable(); })) return;
  lmp->modify->clearstep_compute();
  for (std::size_t k = 0; k < n; k++)
    if (begin[k]->is_variable()) begin[k]->evaluate(lmp, owner, igroup);
  for (Compute *compute : lmp->modify->get_compute_list())
    if (compute->timeflag && compute->invoked_flag) compute->addstep(lmp->update->ntimestep + 1);
}

void NumberOrVariable::evaluate(LAMMPS *lmp, const std::string &owner, int igroup)
{
  check(lmp, owner);    // variables may be deleted and defined between two steps
  const bigint step = lmp->update->ntimestep;
  const char *words = "{}: {} is '{}' at step {}: correct variable {}";
  if (!per_atom) {
    number = lmp->input->variable->compute_equal(index);
    if (!std::isfinite(number)) lmp->error->all(FLERR, words, owner, what, number, step, name);
    return;
  }
  const Atom *atom = lmp->atom;
  by_atom.resize(std::max(1, atom->nmax));
  lmp->input->variable->compute_atom(index, igroup, by_atom.data(), 1, 0);
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & lmp->group->bitmask[igroup] && !std::isfinite(by_atom[i]))
      rank_error(lmp, FLERR, words, owner, fmt::format("{} of atom {}", what, atom->tag[i]),
                 by_atom[i], step, name);
}

double NumberOrVariable::bytes() const { return sphcloth::bytes_of(by_atom); }
