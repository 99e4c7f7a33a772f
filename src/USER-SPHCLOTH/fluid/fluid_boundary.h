// SPDX-License-Identifier: GPL-2.0-or-later
// What completes the kernel of fluid particles beside other particles: the planes of fix wall/sph
// and the meshes of fix cloth/contact.  pair_style sph/tait calls these functions in this order
// while it evaluates.

#ifndef SPHCLOTH_FLUID_FLUID_BOUNDARY_H
#define SPHCLOTH_FLUID_FLUID_BOUNDARY_H

#include "core/sph/stiffness.h"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <vector>

namespace LAMMPS_NS {

class FluidStability;
class MeshScaling;
class Modify;

// Of an owned vertex or boundary particle that fluid touched in the last evaluation: the mass of
// the fluid that moves with it; the sound speed of that fluid over its smoothing length, and its
// viscosity over the square of that.  All are 0 if it is dry.

struct Wetting {
  double fluid_mass = 0.0, sound_rate = 0.0, viscous_rate = 0.0;
};

class FluidBoundary {
 public:
  // name of a fix's extract() for the boundary that it owns
  static constexpr const char *EXTRACT = "fluid_boundary";

  // a number that changes with what a command says of it
  virtual std::uint64_t settings() const { return 0; }

  // positions are those of this evaluation
  virtual void begin() = 0;

  // the density of an owned fluid particle, from its sum over particles
  virtual double density(int i, double of_particles) = 0;
  // the same for the rate of its density, where it was a time `back` ago
  virtual double density_rate(int i, double of_particles, double back) = 0;
  // Factor 1/gamma by which density() renormalizes the sum; 1 where it adds.  Those that add come
  // before those that renormalize.
  virtual bool renormalizes() const { return false; }
  virtual double inverse_gamma(int) { return 1.0; }

  // the force on it; p_over_rho2 is renormalized as its density is
  virtual void push(int i, double p_over_rho2) = 0;
  // Once more, for a particle with a time step of its own: the force of another p/rho^2 and `times`
  // the rest.  What was pushed before holds for energy, virial and rate.
  virtual void push_more(int i, double p_over_rho2, double times) = 0;
  // What was pushed so far is not among the forces of the coming step: take(owned vertex, force)
  // gets it, if the boundary has vertices.
  using Take = std::function<void(int, const Eigen::Vector3d &)>;
  virtual void defer(const Take &take) = 0;
  // All that was pushed acts so many times as long.  Forces on fluid particles are scaled
  // elsewhere.
  virtual void prolong(double times) = 0;

  // For densities that are completed at free surfaces (core/sph/surface.h): can it do the
  // following?  The gradient of what it adds to a density sum, as it would be without a surface,
  // is added to that over particles; a particle's turn T pushes it.
  virtual bool knows_gradients() const { return false; }
  virtual void complete_gradient(int, double *) {}
  virtual void push_turn(int, const Eigen::Vector3d &) {}

  // all particles have been pushed
  virtual void end() {}

  // of the last evaluation: the approach speed of a particle within reach, or 0
  virtual double approach(int i) = 0;
  // does a part of it within reach of the particle move?
  virtual bool moves_beside(int i) = 0;
  // is a vertex of it within reach?
  virtual bool has_vertices_beside(int) { return false; }
  // of an owned vertex, if wanted
  virtual void want_wetting() {}
  virtual Wetting wetting(int) const { return {}; }

  // For the limit of stability: what it adds to an owned fluid particle; then, collective, to its
  // own vertices, with the weights of the fluid; and what these add to the row of a particle
  virtual void add_stiffness(int i, sphcloth::Stiffness &) = 0;
  virtual void find_vertex_stiffness(const FluidStability &) {}
  virtual void add_row(int, sphcloth::VertexRow &) {}

  // For mass scaling: has it vertices that fluid can move?  The same on all ranks.
  virtual bool has_vertices() const { return false; }
  // gradients of the density of an owned fluid particle over them, added to those over particles
  virtual void add_gradients(int, sphcloth::DirectionSums &) {}
  // their springs with fluid of these strengths
  virtual void add_springs(MeshScaling &, const std::vector<double> &) {}

 protected:
  ~FluidBoundary() noexcept(false) = default;
};

// all of a scene
std::vector<FluidBoundary *> find_fluid_boundaries(Modify *);
// the order of an evaluation, once all fixes have been initialized; returns the last ones
std::vector<FluidBoundary *> put_renormalizing_last(std::vector<FluidBoundary *> &);

// of all boundaries together
bool have_vertices(const std::vector<FluidBoundary *> &);
bool have_vertices_beside(const std::vector<FluidBoundary *> &, int i);

}    // namespace LAMMPS_NS

#endif
