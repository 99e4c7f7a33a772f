// SPDX-License-Identifier: GPL-2.0-or-later
// Impulses by source against a sum over pairs, written out.

#include "core/sph/force_loops.h"

#include "water_and_sheet.h"

#include <boost/test/unit_test.hpp>

#include <algorithm>

using namespace water_and_sheet;

namespace {

constexpr double NU = 0.02, MONAGHAN = 0.3, SOFT = 1e-4;

// Water on both sides of a sheet in disordered motion, of which one particle in `every` gives

struct Giving {
  Scene scene;
  Evaluation of;
  Particles p;
  std::vector<double> v, pressure, force, rate, pressure_time, span, row, share;
  std::vector<double *> rows;
  std::vector<int> giving, asleep;
  std::vector<double> given;

  Giving(Precision precision, int every, bool sleepers, double areal = 4.0, bool switched = false) :
      scene(make(precision, areal)), of(scene), p(of.p)
  {
    const std::size_t n = scene.x.size();
    std::mt19937 random(11);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    asleep.assign(n, 0);
    for (std::size_t i = 0; i < n; i++) {
      for (int d = 0; d < 3; d++) v.push_back(any(random));
      pressure.push_back(1.0 + any(random));
      pressure_time.push_back(3.0 * any(random));
      span.push_back(1.5 + any(random));
      share.push_back(switched ? std::fabs(any(random)) : 1.0);
      const bool water = scene.type[i] == WATER;
      row.push_back(water && i % every == 0);
      if (row.back() != 0.0) giving.push_back(static_cast<int>(i));
      if (water && sleepers && i % 7 == 3) asleep[i] = 1;
    }
    for (double &each : row) rows.push_back(&each);
    force.assign(3 * n, 0.0);
    rate.assign(n, 0.0);
    given.assign(Impulses::STRIDE * n, 0.0);
    FluidModel &model = of.fluid->model;
    model.friction = switched ? Friction::SWITCHED : Friction::ANY;
    model.outputs = Outputs::RATE;
    for (PairTerms &terms : model.terms) {
      terms.nu = NU;
      terms.monaghan = MONAGHAN;
      terms.soft = SOFT;
    }
    p.v = v.data();
    p.p_over_rho2 = pressure.data();
    p.f = force.data();
    p.drho = rate.data();
    p.active = rows.data();
    of.fluid->select(p);
    of.fluid->record_positions(p, {{-1.0, -1.0, -1.0}, {3.0, 3.0, 3.0}, 0.2});
    of.fluid->gather(p, false);
    of.fluid->record(p);
    of.fluid->record_viscosity_shares(p, share.data());
    of.fluid->impulses(p,
                       {&giving, pressure_time.data(), span.data(),
                        sleepers ? asleep.data() : nullptr, given.data(), true});
  }

  static Scene make(Precision precision, double areal)
  {
    Scene s = lattice(3, 8, 0.2, areal);
    s.precision = precision;
    return s;
  }
  Vector3d at(std::size_t i) const { return Eigen::Map<const Vector3d>(&v[3 * i]); }
  Vector3d got(std::size_t i) const
  {
    return Eigen::Map<const Vector3d>(&given[Impulses::STRIDE * i]);
  }

  // what i gives j
  Vector3d impulse(int i, int j) const
  {
    const Vector3d r = scene.x[i] - scene.x[j], u = at(i) - at(j);
    const double q = r.norm() * of.scale.inv_support;
    if (i == j || q >= 1.0) return Vector3d::Zero();
    const bool water = scene.type[j] == WATER;
    const double slope = of.scale.f * WendlandC2::slope_over_q(q);
    const double shared = water && !asleep[j] ? 0.5 * span[i] : span[i];
    const double of_partner = water && !asleep[j] ? 0.0 : span[i] * pressure[j];
    const double approach = share[i] * std::min(u.dot(r), 0.0) / (r.squaredNorm() + SOFT);
    if (water) {
      const double rho = of.rho[i] + of.rho[j];
      const double along = pressure_time[i] + of_partner - shared * 2.0 * MONAGHAN * approach / rho;
      const double drag = shared * NU * rho / (of.rho[i] * of.rho[j]);
      return scene.mass[i] * scene.mass[j] * slope * (along * r - drag * u);
    }
    const double along = pressure_time[i] + of_partner - shared * MONAGHAN * approach / of.rho[i];
    const double drag = shared * NU * 2.0 / of.rho[i];
    return scene.mass[i] * scene.volume * RHO0 * slope * (along * r - drag * u);
  }
};

void check_against_pairs(const Giving &g, double tolerance)
{
  const std::size_t n = g.scene.x.size();
  std::vector<Vector3d> expected(n, Vector3d::Zero());
  double largest = 0.0;
  for (const int i : g.giving)
    for (std::size_t j = 0; j < n; j++) {
      const Vector3d to = g.impulse(i, static_cast<int>(j));
      expected[i] -= to;
      if (!g.asleep[j]) expected[j] += to;
      largest = std::max(largest, to.norm());
    }
  BOOST_REQUIRE(largest > 0.0);
  for (std::size_t i = 0; i < n; i++)
    BOOST_CHECK((g.got(i) - expected[i]).norm() < tolerance * largest);
}

}    // namespace

BOOST_AUTO_TEST_SUITE(force_loops)

BOOST_AUTO_TEST_CASE(every_particle_gives_its_own_terms_to_its_neighbors)
{
  check_against_pairs({Precision::DOUBLE, 1, false}, 1e-12);
  check_against_pairs({Precision::DOUBLE, 3, true}, 1e-12);
  check_against_pairs({Precision::MIXED, 3, true}, 1e-4);
}

BOOST_AUTO_TEST_CASE(artificial_viscosity_that_is_switched_is_given_by_shares)
{
  check_against_pairs({Precision::DOUBLE, 2, true, 4.0, true}, 1e-12);
  check_against_pairs({Precision::MIXED, 3, false, 4.0, true}, 1e-4);
}

// What all give to one another in one time, each with its own share, are forces with the mean.

BOOST_AUTO_TEST_CASE(forces_between_water_have_the_mean_of_both_shares)
{
  Giving g(Precision::DOUBLE, 1, false, 0.0, true);
  std::fill(g.given.begin(), g.given.end(), 0.0);
  std::fill(g.span.begin(), g.span.end(), 1.0);
  g.of.fluid->impulses(
      g.p, {&g.giving, g.pressure.data(), g.span.data(), nullptr, g.given.data(), false});
  std::vector<double> force(g.force.size(), 0.0);
  g.p.f = force.data();
  g.of.fluid->forces(g.p, Target::FLUID);
  double largest = 0.0;
  for (std::size_t i = 0; i < g.scene.x.size(); i++) largest = std::max(largest, g.got(i).norm());
  for (std::size_t i = 0; i < g.scene.x.size(); i++)
    BOOST_CHECK((g.got(i) - Eigen::Map<Vector3d>(&force[3 * i])).norm() < 1e-12 * largest);
}

BOOST_AUTO_TEST_CASE(few_particles_give_the_same)
{
  const Giving few(Precision::DOUBLE, 90, false, 0.0);
  BOOST_REQUIRE(few.of.fluid->touched() != nullptr);
  check_against_pairs(few, 1e-12);
}

BOOST_AUTO_TEST_CASE(momentum_is_exact_in_both_precisions)
{
  for (const Precision precision : {Precision::DOUBLE, Precision::MIXED}) {
    const Giving g(precision, 2, false);
    Vector3d sum = Vector3d::Zero();
    double sizes = 0.0;
    for (std::size_t i = 0; i < g.scene.x.size(); i++) {
      sum += g.got(i);
      sizes += g.got(i).norm();
    }
    BOOST_CHECK(sum.norm() < 1e-14 * sizes);
  }
}

BOOST_AUTO_TEST_CASE(the_forces_beside_them_are_those_of_the_force_loops)
{
  const Giving g(Precision::DOUBLE, 2, false);
  std::vector<double> force(g.force.size(), 0.0), rate(g.rate.size(), 0.0);
  Particles p = g.p;
  p.f = force.data();
  p.drho = rate.data();
  g.of.fluid->forces(p, Target::FLUID);
  BOOST_CHECK(force == g.force);
  BOOST_CHECK(rate == g.rate);
}

// Nobody else is touched, and where most give, nobody is left out.

BOOST_AUTO_TEST_CASE(touched_particles_are_all_that_get_something)
{
  const Giving many(Precision::DOUBLE, 2, false);
  BOOST_CHECK(many.of.fluid->touched() == nullptr);
  const Giving few(Precision::DOUBLE, 90, false, 0.0);
  const std::vector<int> *touched = few.of.fluid->touched();
  BOOST_REQUIRE(touched != nullptr);
  std::size_t n_got = 0;
  for (std::size_t i = 0; i < few.scene.x.size(); i++) {
    if (few.got(i).norm() == 0.0) continue;
    n_got++;
    BOOST_CHECK(std::count(touched->begin(), touched->end(), static_cast<int>(i)) == 1);
  }
  BOOST_CHECK(n_got > few.giving.size());
  BOOST_CHECK(touched->size() < few.scene.x.size());
}

BOOST_AUTO_TEST_SUITE_END()
