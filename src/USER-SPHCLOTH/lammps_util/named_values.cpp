// SPDX-License-Identifier: GPL-2.0-or-later
// Values of a fix by keyword, see named_values.h.

#include "lammps_util/named_values.h"

#include "error.h"
#include "fix.h"
#include "lammps_util/arg_reader.h"
#include "memory.h"
#include "modify.h"
#include "update.h"

using namespace LAMMPS_NS;

static double value_of(Fix &fix, int number)
{
  return number == 0 ? fix.compute_scalar() : fix.compute_vector(number - 1);
}

NamedValues::NamedValues(LAMMPS *lmp_, int narg, char **arg, const std::string &fix_style_,
                         const std::vector<NamedValue> &known) :
    Compute(lmp_, narg, arg), label(fmt::format("compute {} {}", id, style)), fix_style(fix_style_)
{
  extlist = nullptr;
  ArgReader args(lmp, label, narg, arg, 3);
  do read_keyword(args, known);
  while (args.more() || values.empty());
  set_flags();
}

NamedValues::~NamedValues()
{
  memory->destroy(vector);
  delete[] extlist;
}

// A name, or all names that begin as a word that ends with an asterisk.

void NamedValues::read_keyword(ArgReader &args, const std::vector<NamedValue> &known)
{
  const std::string word = args.word("keyword");
  if (word == "fix") {
    fix_id = args.word("fix");
    return;
  }
  const bool begins = !word.empty() && word.back() == '*';
  const auto star = begins ? word.size() - 1 : std::string::npos;
  const auto before = values.size();
  std::string names = "fix";
  for (const NamedValue &value : known) {
    names += ", " + value.name;
    if (value.name.substr(0, star) == word.substr(0, star)) values.push_back(value);
  }
  if (values.size() == before) args.unknown(word, names);
}

// a scalar for one value, a vector for several

void NamedValues::set_flags()
{
  if (values.size() == 1) {
    scalar_flag = 1;
    extscalar = values[0].kind;
    return;
  }
  vector_flag = 1;
  size_vector = static_cast<int>(values.size());
  extvector = -1;
  extlist = new int[size_vector];
  for (int k = 0; k < size_vector; k++) extlist[k] = values[k].kind;
  memory->create(vector, size_vector, "named_values:vector");
}

// Commands such as write_data may come before the fix.

void NamedValues::init()
{
  if (update->whichflag != 0) find_fix();
}

// Before every use: the user may have replaced the fix since init().

Fix &NamedValues::find_fix() const
{
  const auto fixes = modify->get_fix_by_style("^" + fix_style + "$");
  std::string ids;
  for (Fix *fix : fixes) {
    if (fix_id == fix->id || (fix_id.empty() && fixes.size() == 1)) return *fix;
    ids += (ids.empty() ? "" : ", ") + std::string(fix->id);
  }
  if (fixes.empty())
    error->all(FLERR, "{}: there is no fix {}, which knows the values: define one", label,
               fix_style);
  if (fix_id.empty())
    error->all(FLERR, "{}: there are several fixes {}: give the keyword fix and one of {}", label,
               fix_style, ids);
  error->all(FLERR, "{}: fix is '{}': give the ID of a fix {}: {}", label, fix_id, fix_style, ids);
}

double NamedValues::compute_scalar()
{
  invoked_scalar = update->ntimestep;
  return scalar = value_of(find_fix(), values[0].number);
}

void NamedValues::compute_vector()
{
  invoked_vector = update->ntimestep;
  Fix &fix = find_fix();
  for (int k = 0; k < size_vector; k++) vector[k] = value_of(fix, values[k].number);
}

double NamedValues::memory_usage() { return sizeof(double) * static_cast<double>(values.size()); }
