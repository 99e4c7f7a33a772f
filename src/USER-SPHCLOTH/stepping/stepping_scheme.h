// SPDX-License-Identifier: GPL-2.0-or-later
// The stepping schemes, and what the cloth asks the styles that have them, without knowing these.

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

// run_style sph/adaptive

class HasSteppingScheme {
 public:
  virtual SteppingScheme scheme() const = 0;

 protected:
  ~HasSteppingScheme() = default;
};

// fix sph/integrate

class HasLongestStep {
 public:
  virtual double longest_step() const = 0;

 protected:
  ~HasLongestStep() = default;
};

}    // namespace LAMMPS_NS

#endif
