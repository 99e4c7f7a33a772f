// SPDX-License-Identifier: GPL-2.0-or-later
// The step that mass scaling bears, against the exact one of all particles together.

#include "core/sph/mass_scaling.h"

#include "water_and_sheet.h"

#include <boost/test/unit_test.hpp>

#include <string>

using namespace water_and_sheet;

namespace {

// Water beside a sheet whose vertices are scaled

class Scaled {
 public:
  explicit Scaled(const Scene &scene) : Scaled(scene, Eigen::VectorXd::Zero(3 * scene.x.size())) {}

  Scaled(const Scene &scene, const Eigen::VectorXd &velocities) : s(scene), v(velocities), of(s)
  {
    of.p.v = v.data();
    const std::size_t n = s.x.size();
    const std::vector<int> is_vertex{0, 0, 1};
    std::vector<VertexGradients> gradients(n);
    std::vector<Vector3d> normals(n);
    std::vector<double> strength(n, 0.0);
    std::vector<Stiffness> stiff(n);
    of.fluid->stiffness(of.p, of.fluid->active(), nullptr, stiff.data());
    of.fluid->vertex_gradients(of.p, is_vertex.data(), gradients.data());
    const double factor = lattice_factor(s);
    for (std::size_t i = 0; i < n; i++) {
      if (s.type[i] != WATER) continue;
      const double sound_sq = of.sound[i] * of.sound[i];
      strength[i] = sound_sq * gradients[i].trace();
      normals[i] = Vector3d(gradients[i].away).normalized();
      const double fluid_sq = sound_sq * stiff[i].largest(s.mass[i], factor);
      alone_sq = std::max(alone_sq, fluid_sq);
      bound_sq = std::max(
          bound_sq, MassScaling::frequency_sq(fluid_sq, strength[i], gradients[i], s.mass[i]));
    }
    of.fluid->vertex_pairs(of.p, is_vertex.data(), strength.data(), normals[0].data(), pairs);
  }

  // changes of velocity by these forces in a step; this part of the springs is new
  Eigen::VectorXd respond(const Eigen::VectorXd &forces, double dt, double new_part = 0.0) const
  {
    Eigen::VectorXd change = dt * forces;
    for (std::size_t i = 0; i < s.x.size(); i++) segment(change, i) /= s.mass[i];
    const Eigen::VectorXd kicks = change;
    const auto kick = [&](int fluid) -> FluidKick {
      return {kicks.segment<3>(3 * fluid), new_part};
    };
    for (int n = 0; n < pairs.size(); n++) {
      const int j = pairs.vertices[n];
      const MassScaling mass(stiffness_of(pairs, n), 1.0 / s.mass[j], dt);
      segment(change, j) =
          mass.scaled(kicks.segment<3>(3 * j), carried_by_fluid(pairs, n, dt, kick));
      give_to_fluid(pairs, n, dt, change.segment<3>(3 * j), 1.0, kick,
                    [&](int fluid, const Vector3d &impulse) {
                      segment(change, fluid) += impulse / s.mass[fluid];
                    });
    }
    return change;
  }

  // Leapfrog is stable where this is at most 4: the largest eigenvalue of R K dt, with velocities
  // that change by R times the forces
  double largest_growth(double dt) const
  {
    const MatrixXd b = density_gradients(s, of.scale, of.sound);
    MatrixXd responses(b.rows(), b.cols());
    for (int k = 0; k < b.rows(); k++)
      responses.row(k) = respond(b.row(k).transpose(), dt).transpose();
    const MatrixXd m = dt * b * responses.transpose();
    BOOST_TEST((m - m.transpose()).norm() < 1e-9 * m.norm());    // R is symmetric
    return Eigen::SelfAdjointEigenSolver<MatrixXd>(m, Eigen::EigenvaluesOnly)
        .eigenvalues()[b.rows() - 1];
  }

  // with these velocities, of what moves and of what is added
  double energy(const Eigen::VectorXd &velocities, double dt, double added) const
  {
    double twice = 0.0;
    for (std::size_t i = 0; i < s.x.size(); i++)
      twice += s.mass[i] * velocities.segment<3>(3 * static_cast<int>(i)).squaredNorm();
    for (int n = 0; n < pairs.size(); n++)
      for (const VertexPairs::Pair &pair : pairs.of(n)) {
        const Vector3d u =
            velocities.segment<3>(3 * pair.fluid) - velocities.segment<3>(3 * pairs.vertices[n]);
        twice += added * MassScaling::SHARE * dt * dt * pair.stiffness *
            std::pow(direction(pair).dot(u), 2);
      }
    return 0.5 * twice;
  }

  const Scene s;
  const Eigen::VectorXd v;
  Evaluation of;
  VertexPairs pairs;
  double alone_sq = 0.0, bound_sq = 0.0;    // largest frequencies of water, and of what is scaled

 private:
  static Eigen::VectorXd::FixedSegmentReturnType<3>::Type segment(Eigen::VectorXd &of,
                                                                  std::size_t i)
  {
    return of.segment<3>(3 * static_cast<int>(i));
  }
};

constexpr double STABILITY = 0.95;    // of the longest step, by default

}    // namespace

BOOST_AUTO_TEST_SUITE(mass_scaling)

BOOST_AUTO_TEST_CASE(the_step_does_not_depend_on_the_mass_of_vertices)
{
  for (const KernelName kernel : ALL_KERNELS)
    for (const double mesh : {0.5, 1.0, 2.0})
      for (const double disorder : {0.0, 0.1, 0.3})
        for (const double gap : {0.5, 1.0})
          for (const double areal : {50.0, 0.05}) {
            if (kernel != KernelName::WENDLAND_C2 && (mesh != 1.0 || areal != 0.05)) continue;
            Scene scene = lattice(3, 6, disorder, areal, gap, 7, mesh);
            scene.kernel = kernel;
            const Scaled s(scene);
            const std::string what = kernel_word(kernel) + " areal " + std::to_string(areal) +
                " mesh " + std::to_string(mesh) + " disorder " + std::to_string(disorder) +
                " gap " + std::to_string(gap);
            const double dt = STABILITY * 2.0 / std::sqrt(s.bound_sq);
            const double growth = s.largest_growth(dt);
            BOOST_TEST_MESSAGE(what << ": " << growth << ", step over that of water "
                                    << std::sqrt(s.alone_sq / s.bound_sq));
            BOOST_CHECK_MESSAGE(growth < 4.0, what << ": " << growth);
          }
}

// whatever the forces and velocities are

BOOST_AUTO_TEST_CASE(momentum_and_angular_momentum_are_exact)
{
  const Scene scene = lattice(3, 6, 0.2, 0.05, 0.5);
  Eigen::VectorXd velocities(3 * scene.x.size()), forces = velocities;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> component(-1.0, 1.0);
  for (double &f : forces) f = component(random);
  for (double &u : velocities) u = component(random);
  const Scaled s(scene, velocities);
  const double dt = 1.9 / std::sqrt(s.bound_sq);
  const Eigen::VectorXd change = s.respond(forces, dt, 0.7);
  Vector3d momentum = Vector3d::Zero(), angular = momentum;
  double moved = 0.0;
  for (std::size_t i = 0; i < s.s.x.size(); i++) {
    const int at = 3 * static_cast<int>(i);
    const Vector3d more = s.s.mass[i] * change.segment<3>(at) - dt * forces.segment<3>(at);
    momentum += more;
    angular += s.s.x[i].cross(more);
    moved += more.norm();
  }
  BOOST_TEST(moved > 0.1 * dt * forces.norm());
  BOOST_TEST(momentum.norm() < 1e-12 * moved);
  BOOST_TEST(angular.norm() < 1e-12 * moved);
}

// Water that moves past a sheet, across it or along it

Scaled passing(double areal, int axis)
{
  const Scene scene = lattice(3, 6, 0.2, areal, 0.5);
  Eigen::VectorXd velocities = Eigen::VectorXd::Zero(3 * scene.x.size());
  for (std::size_t i = 0; i < scene.x.size(); i++)
    if (scene.type[i] == WATER) velocities[3 * static_cast<int>(i) + axis] = -1.0;
  return Scaled(scene, velocities);
}

// energy before a step in which this part of the springs is new, with all masses, and after it

struct Energies {
  Energies(const Scaled &s, double new_part)
  {
    const double dt = STABILITY * 2.0 / std::sqrt(s.bound_sq);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(s.v.size());
    before = s.energy(s.v, dt, 1.0 - new_part);
    whole = s.energy(s.v, dt, 1.0);
    after = s.energy(s.v + s.respond(none, dt, new_part), dt, 1.0);
  }
  double before, whole, after;
};

constexpr double AREAL[] = {50.0, 0.05}, NEW_PARTS[] = {1.0, 0.3};

// the masses that come between water and a sheet that meet get their energy from both

BOOST_AUTO_TEST_CASE(new_masses_bring_no_energy)
{
  for (const double areal : AREAL)
    for (const double new_part : NEW_PARTS) {
      const Energies e(passing(areal, 0), new_part);
      BOOST_TEST(e.after <= e.before * (1.0 + 1e-12));
      BOOST_TEST(e.whole > 1.001 * e.before);
    }
}

BOOST_AUTO_TEST_CASE(what_flows_along_a_sheet_is_not_held)
{
  for (const double areal : AREAL)
    for (const double new_part : NEW_PARTS)
      for (const int axis : {1, 2}) {
        const Energies e(passing(areal, axis), new_part);
        BOOST_TEST(e.whole - e.after < 0.15 * (e.whole - e.before));
      }
}

// whatever the velocities are; vertices that are much lighter than water, too

BOOST_AUTO_TEST_CASE(what_new_masses_exchange_never_adds_energy)
{
  std::mt19937 random(11);
  std::uniform_real_distribution<double> component(-1.0, 1.0);
  for (const double areal : {50.0, 0.5, 0.05})
    for (int seed = 1; seed <= 5; seed++) {
      const Scene scene = lattice(3, 6, 0.3, areal, 0.5, seed);
      Eigen::VectorXd velocities(3 * scene.x.size());
      for (double &u : velocities) u = component(random);
      const Energies e(Scaled(scene, velocities), 1.0);
      BOOST_TEST(e.after < e.whole);
      BOOST_TEST(e.before < e.whole);
    }
}

BOOST_AUTO_TEST_CASE(only_what_grows_is_new)
{
  BOOST_TEST(FluidKick::new_part_of(0.0, 2.0) == 1.0);
  BOOST_TEST(FluidKick::new_part_of(0.5, 2.0) == 0.75);
  BOOST_TEST(FluidKick::new_part_of(2.0, 2.0) == 0.0);
  BOOST_TEST(FluidKick::new_part_of(2.0, 0.5) == 0.0);
  BOOST_TEST(FluidKick::new_part_of(0.0, 0.0) == 0.0);
}

BOOST_AUTO_TEST_CASE(what_is_added_grows_with_the_square_of_the_step)
{
  Eigen::Matrix3d stiffness = Eigen::Vector3d(3.0, 1.0, 0.0).asDiagonal();
  const Vector3d change(1.0, 1.0, 1.0);
  for (const double dt : {0.0, 0.5, 1.0, 2.0}) {
    const Vector3d scaled = MassScaling(stiffness, 0.25, dt).scaled(change);
    for (int d = 0; d < 3; d++)
      BOOST_TEST(scaled[d] == 4.0 / (4.0 + 0.5 * dt * dt * stiffness(d, d)),
                 boost::test_tools::tolerance(1e-14));
  }
}

BOOST_AUTO_TEST_SUITE_END()
