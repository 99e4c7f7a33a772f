// What fills the kernel of fluid particles beside other particles: pair_style sph/tait asks while it
// evaluates, in this order.

#ifndef SPHCLOTH_FLUID_FLUID_BOUNDARY_H
#define SPHCLOTH_FLUID_FLUID_BOUNDARY_H

namespace LAMMPS_NS {

class FluidBoundary {
 public:
  // where it is now
  virtual void begin() = 0;
  // adds to the density of an owned fluid particle
  virtual double density(int i) = 0;
  // the same to the rate of its density, where it was a time `back` ago
  virtual double density_rate(int i, double back) = 0;
  // the force on it; pressure_term = p/rho^2
  virtual void push(int i, double p_over_rho2) = 0;
  // Once more, for a particle with a step of its own: the force of another pressure term and `times`
  // the rest.  What was pushed before holds for energy, virial and rate.
  virtual void push_more(int i, double p_over_rho2, double times) = 0;
  // what was pushed so far is none of the forces on it in the coming step
  virtual void forget_pushes() = 0;
  // all that was pushed acts so many times as long; the forces on particles are seen to
  virtual void prolong(double times) = 0;

  // of the last evaluation: the speed at which a particle within reach comes nearer, or 0
  virtual double approach(int i) = 0;
  // does a part of it move that is within reach of the particle?
  virtual bool moves_beside(int i) = 0;

 protected:
  ~FluidBoundary() noexcept(false) = default;
};

}    // namespace LAMMPS_NS

#endif
