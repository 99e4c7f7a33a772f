// The stepping schemes, and what the cloth asks the styles that have them, without knowing these.

#ifndef SPHCLOTH_STEPPING_STEPPING_SCHEME_H
#define SPHCLOTH_STEPPING_STEPPING_SCHEME_H

namespace LAMMPS_NS {

enum class SteppingScheme : int { CONSTANT, GLOBAL, INDIVIDUAL, BLOCK };

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
