// SPDX-License-Identifier: GPL-2.0-or-later
// Arguments of a style, read one after the other.  Every error names the style, the keyword, the
// value and the remedy; those of utils::numeric() and its like name the value alone.

#ifndef SPHCLOTH_LAMMPS_UTIL_ARG_READER_H
#define SPHCLOTH_LAMMPS_UTIL_ARG_READER_H

#include "error.h"
#include "pointers.h"
#include "utils.h"

#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

class ArgReader : protected Pointers {
 public:
  // style: as the user typed it, for example "fix sph/emit"; first: index of the next argument

  ArgReader(LAMMPS *lmp_, std::string style_, int narg_, char **arg_, int first = 0) :
      Pointers(lmp_), style(std::move(style_)), narg(narg_), arg(arg_), next(first)
  {
  }

  bool more() const { return next < narg; }
  int position() const { return next; }
  const char *peek() const { return arg[next]; }

  std::string word(const std::string &what)
  {
    if (next >= narg)
      error->all(FLERR,
                 "{}: {} is missing at the end of the command; see its doc page for the syntax",
                 style, what);
    return arg[next++];
  }

  double number(const std::string &what)
  {
    const std::string text = word(what);
    const double value = std::strtod(text.c_str(), nullptr);    // stod throws at 1e400 and 1e-310
    if (!utils::is_double(text) || !std::isfinite(value)) fail(what, text, "give a finite number");
    return value;
  }

  double at_least(const std::string &what, double low)
  {
    const double value = number(what);
    if (value < low) fail(what, arg[next - 1], fmt::format("give a number >= {}", low));
    return value;
  }

  double positive(const std::string &what)
  {
    const double value = number(what);
    if (!(value > 0.0)) fail(what, arg[next - 1], "give a number > 0");
    return value;
  }

  double fraction(const std::string &what)
  {
    const double value = number(what);
    if (value < 0.0 || value > 1.0) fail(what, arg[next - 1], "give a number from 0 to 1");
    return value;
  }

  int integer(const std::string &what, int low, int high)
  {
    const std::string text = word(what);
    if (!utils::is_integer(text) || text.size() > 10 || std::stoll(text) < low ||
        std::stoll(text) > high)
      fail(what, text, fmt::format("give a whole number from {} to {}", low, high));
    return std::stoi(text);
  }

  // first and last of the types 1 to n that a number, or a range with an asterisk, names
  std::pair<int, int> range(const std::string &what, int n)
  {
    const std::string text = word(what);
    const auto star = text.find('*');
    const auto end = [star](const std::string &digits, int open) {
      if (digits.empty() && star != std::string::npos) return open;
      return utils::is_integer(digits) && digits.size() < 10 ? std::stoi(digits) : 0;
    };
    const int low = end(text.substr(0, star), 1);
    const int high = star == std::string::npos ? low : end(text.substr(star + 1), n);
    if (low < 1 || high > n || low > high)
      fail(what, text, fmt::format("give a number from 1 to {}, or a range as in * or 1*{}", n, n));
    return {low, high};
  }

  // nothing may be left
  void end()
  {
    if (more()) error->all(FLERR, "{}: '{}' is one word too many: remove it", style, peek());
  }

  // index of the word among those that are allowed
  int choice(const std::string &what, const std::vector<std::string> &allowed)
  {
    const std::string text = word(what);
    std::string known;
    for (std::size_t k = 0; k < allowed.size(); k++) {
      if (text == allowed[k]) return static_cast<int>(k);
      known += (k ? " or " : "") + allowed[k];
    }
    fail(what, text, "use " + known);
  }

  [[noreturn]] void fail(const std::string &what, const std::string &value,
                         const std::string &remedy)
  {
    error->all(FLERR, "{}: {} is '{}': {}", style, what, value, remedy);
  }

  [[noreturn]] void unknown(const std::string &keyword, const std::string &known)
  {
    error->all(FLERR, "{}: unknown keyword '{}': use one of {}", style, keyword, known);
  }

 private:
  std::string style;
  int narg;
  char **arg;
  int next;
};

}    // namespace LAMMPS_NS

#endif
