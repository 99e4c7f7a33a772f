// SPDX-License-Identifier: GPL-2.0-or-later
// Cubes of water on both sides of a sheet, and the gradients of their densities from kernels alone.

#ifndef SPHCLOTH_TESTS_CORE_WATER_AND_SHEET_H
#define SPHCLOTH_TESTS_CORE_WATER_AND_SHEET_H

#include "core/sph/fluid.h"
#include "core/sph/lattice_modes.h"

#include <Eigen/Dense>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace water_and_sheet {

using namespace sphcloth;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr int WATER = 1, SHEET = 2;
constexpr double RHO0 = 1000.0, SOUND = 20.0, SPACING = 0.05;

struct Scene {
  int dim = 3;
  KernelName kernel = KernelName::WENDLAND_C2;
  Precision precision = Precision::DOUBLE;
  double support = 2.0 * SPACING;
  std::vector<Vector3d> x;
  std::vector<int> type;
  std::vector<double> mass;    // of vertices, too
  double volume = 0.0;    // of a vertex

  double water_mass() const { return RHO0 * std::pow(SPACING, dim); }
  void add(int t, const Vector3d &at, double m)
  {
    x.push_back(at);
    type.push_back(t);
    mass.push_back(m);
  }
  void remove(int i)
  {
    x.erase(x.begin() + i);
    type.erase(type.begin() + i);
    mass.erase(mass.begin() + i);
  }
};

// cubes of water on both sides of a sheet, or without one, each particle moved by a random
// share of the spacing; edges of the sheet are so many spacings long

inline Scene lattice(int dim, int n, double disorder, double areal = 0.0, double gap = 0.5,
                     int seed = 7, double mesh = 1.0)
{
  Scene s;
  s.dim = dim;
  s.volume = std::pow(SPACING, dim);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-disorder * SPACING, disorder * SPACING);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++)
      for (int k = 0; k < (dim == 3 ? n : 1); k++) {
        Vector3d at = SPACING * Vector3d(i, j, k);
        for (double &coordinate : at) coordinate += off(random);    // in this order
        if (dim == 2) at[2] = 0.0;
        if (areal > 0.0) at[0] += (i < n / 2 ? -gap : gap - 1.0) * SPACING;
        s.add(WATER, at, s.water_mass());
      }
  if (areal == 0.0) return s;
  const int m = static_cast<int>(n / mesh);
  s.volume = std::pow(mesh * SPACING, dim - 1) * SPACING;
  for (int j = 0; j < m; j++)
    for (int k = 0; k < (dim == 3 ? m : 1); k++)
      s.add(SHEET, SPACING * Vector3d(n / 2 - 1, mesh * j, mesh * k),
            areal * std::pow(mesh * SPACING, dim - 1));
  return s;
}

// square of the fastest motion of a lattice of water, over what one of its particles sees alone

inline double lattice_factor(const Scene &s)
{
  return with_kernel(s.kernel, [&](auto kernel) {
    return lattice_modes<decltype(kernel)>(s.support / SPACING, s.dim).sound;
  });
}

// Row k: s_k times the gradient of the density of fluid k over the positions of all

inline MatrixXd density_gradients(const Scene &s, const KernelScale &scale,
                                  const std::vector<double> &sound)
{
  const int n = static_cast<int>(s.x.size());
  int fluid = 0;
  while (fluid < n && s.type[fluid] == WATER) fluid++;
  MatrixXd b = MatrixXd::Zero(fluid, 3 * n);
  for (int k = 0; k < fluid; k++)
    for (int j = 0; j < n; j++) {
      if (j == k) continue;
      const Vector3d r = s.x[k] - s.x[j];
      const double q = r.norm() * scale.inv_support;
      if (q >= 1.0) continue;
      const double each = s.type[j] == WATER ? s.mass[j] : RHO0 * s.volume;
      const double slope =
          with_kernel(s.kernel, [&](auto kernel) { return decltype(kernel)::slope_over_q(q); });
      const Vector3d gradient = sound[k] * each * scale.f * slope * r;
      b.block<1, 3>(k, 3 * k) += gradient.transpose();
      b.block<1, 3>(k, 3 * j) -= gradient.transpose();
    }
  return b;
}

// Densities are summed.

class Evaluation {
 public:
  explicit Evaluation(const Scene &s) :
      scale(with_kernel(
          s.kernel, [&](auto kernel) { return kernel_scale<decltype(kernel)>(s.support, s.dim); })),
      fluid(Fluid::create(s.kernel, s.precision)), rho(s.x.size(), RHO0), sound(s.x.size(), 0.0)
  {
    const int n = static_cast<int>(s.x.size());
    PairTerms terms;
    terms.kernel = scale;
    terms.rho0 = RHO0;
    FluidModel &model = fluid->model;
    model.dimension = s.dim;
    model.n_types = 2;
    model.role = {Role::NONE, Role::FLUID, Role::BOUNDARY};
    model.mass = {0.0, s.water_mass(), 0.0};
    model.pressure_scale.assign(3, 1.0);
    model.terms.assign(9, terms);
    for (int i = 0; i < n; i++) {
      for (int d = 0; d < 3; d++) x.push_back(s.x[i][d]);
      felt.push_back(s.type[i] == WATER ? s.mass[i] : s.volume);
    }
    v.assign(3 * n, 0.0);
    p.n_owned = p.n_all = n;
    p.type = s.type.data();
    p.x = x.data();
    p.v = v.data();
    p.mass_or_volume = felt.data();
    p.rho = rho.data();
    std::vector<double> reach(9, s.support);
    reach[0] = reach[1] = reach[2] = reach[3] = reach[6] = reach[8] = 0.0;
    Motion motion;
    motion.dimension = s.dim;
    motion.v = v.data();
    motion.interval.assign(3, 1.0);
    motion.step = 1e-4;
    fluid->list(p, reach.data(), 0.1 * s.support, motion);
    fluid->select(p);
    fluid->record_positions(p, {{-1.0, -1.0, -1.0}, {3.0, 3.0, 3.0}, 0.2});
    fluid->gather(p, true);
    for (int i = 0; i < n; i++)
      if (s.type[i] == WATER)
        sound[i] = SOUND * std::pow(rho[i] / RHO0, 3) * std::sqrt(s.mass[i]) / rho[i];
  }
  Evaluation(const Evaluation &) = delete;
  Evaluation &operator=(const Evaluation &) = delete;

  const KernelScale scale;
  std::unique_ptr<Fluid> fluid;
  Particles p;
  std::vector<double> rho, sound;    // s_k, 0 of vertices

 private:
  std::vector<double> x, v, felt;
};

}    // namespace water_and_sheet

#endif
