// SPDX-License-Identifier: GPL-2.0-or-later
// The stepping schemes, and which one is in force, for styles that do not know those that have it.

#ifndef SPHCLOTH_STEPPING_STEPPING_SCHEME_H
#define SPHCLOTH_STEPPING_STEPPING_SCHEME_H

namespace LAMMPS_NS {

enum class SteppingScheme : int { CONSTANT, GLOBAL, INDIVIDUAL, BLOCK };

inline const char *scheme_name(SteppingScheme scheme)
{
  switch (scheme) {
    case SteppingScheme::CONSTANT: return "constant";
    case SteppingScheme::GLOBAL: return "global";
    case SteppingScheme::INDIVIDUAL: return "individual";
    case SteppingScheme::BLOCK: return "block";
  }
  return "";
}

// run_style sph/adaptive, and fix sph/integrate from its init() on

class HasSteppingScheme {
 public:
  virtual SteppingScheme stepping_scheme() const = 0;

 protected:
  ~HasSteppingScheme() = default;
};

}    // namespace LAMMPS_NS

#endif
