// SPDX-License-Identifier: GPL-2.0-or-later
// Finds the points of meshes nearest to fluid particles, and exchanges forces with them.

#include "fluid/mesh_boundary.h"

#include "atom.h"
#include "error.h"
#include "fluid/fluid_stability.h"
#include "fluid/fluid_state.h"
#include "fluid/mesh_scaling.h"
#include "force.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/rank_error.h"
#include "neighbor.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace sphcloth;

static Eigen::Vector3d position_of(const double *x) { return {x[0], x[1], x[2]}; }

void MeshBoundary::init(FluidState *of_pair_style)
{
  fluid = of_pair_style;
  if (!fluid)
    error->all(
        FLERR,
        "{}: 'wall' fills the kernel of fluid, and there is none: use 'pair_style sph/tait', "
        "or 'wall no'",
        label);
  table = fluid->wall_table();
  adds = fluid->calibrates();
  profiles = fluid->lattices.wall_profiles(table, 1.0);
  sheets.clear();
  kinds.clear();
}

void MeshBoundary::add(const ContactMesh *mesh, TriangleSet *set, Mesh kind)
{
  for (int i = 0; i < atom->nlocal; i++)
    if (mesh->has_vertex(i) && fluid->is_boundary(atom->type[i]))
      rank_error(lmp, FLERR,
                 "{}: vertex {} is of type {}, a boundary type, and would press twice with 'wall': "
                 "use 'pair_coeff {} {} none', or 'wall no'",
                 label, atom->tag[i], atom->type[i], atom->type[i], atom->type[i]);
  sheets.emplace_back(lmp, set, groupbit);
  kinds.push_back(kind);
}

double MeshBoundary::reach() const
{
  double longest = 0.0;
  for (int t = 1; t <= atom->ntypes; t++)
    if (fluid->is_fluid(t)) longest = std::max(longest, fluid->support(t));
  return longest + neighbor->skin;
}

double MeshBoundary::support(int i) const { return fluid->support(atom->type[i]); }

void MeshBoundary::update_candidates()
{
  for (BoundaryMesh &sheet : sheets)
    sheet.update_candidates(neighbor->skin, [this](int i) {
      return fluid->is_fluid(atom->type[i]) ? support(i) : 0.0;
    });
}

void MeshBoundary::begin()
{
  lasts = 1.0;
  closest_points.clear();
  for (std::size_t k = 0; k < sheets.size(); k++)
    sheets[k].find_closest_points(static_cast<int>(k), closest_points);
  if (sheets.size() > 1)
    std::sort(closest_points.begin(), closest_points.end(),
              [](const ClosestPoint &a, const ClosestPoint &b) {
                if (a.particle != b.particle) return a.particle < b.particle;
                return a.distance != b.distance ? a.distance < b.distance : a.sheet < b.sheet;
              });
  first.assign(atom->nlocal, -1);
  for (std::size_t k = 0; k < closest_points.size(); k++) {
    ClosestPoint &closest = closest_points[k];
    closest.value = table(closest.distance / support(closest.particle));
    closest.beyond = table(closest.border_distance / support(closest.particle));
    int &begin = first[closest.particle];
    if (begin < 0) begin = static_cast<int>(k);
    for (std::size_t nearer = begin; nearer < k; nearer++)
      closest.share *= 1.0 - std::max(0.0, closest.normal.dot(closest_points[nearer].normal));
  }
  if (wetting_wanted) find_wetting();
}

// All fluid moves with the mesh, also what is not active in this evaluation.

void MeshBoundary::find_wetting()
{
  wetted_by.assign(atom->nlocal, Vec3::Zero());
  for (const ClosestPoint &closest : closest_points) {
    const int i = closest.particle;
    const double moves = 2.0 * atom_mass(atom, i) * covered(closest);
    const Wetting by = fluid->wetting_by(atom->type[i], fluid->type(atom->type[i]).nu);
    sheets[closest.sheet].wet(closest, moves * Vec3(1.0, by.sound_rate, by.viscous_rate));
  }
  for (BoundaryMesh &sheet : sheets)
    sheet.hand_over_wetting([this](int i, const Vec3 &quantity) { wetted_by[i] += quantity; });
}

template <class Do> void MeshBoundary::for_closest_points(int i, Do something)
{
  if (first[i] < 0) return;
  for (std::size_t k = first[i]; k < closest_points.size() && closest_points[k].particle == i; k++)
    something(closest_points[k]);
}

double MeshBoundary::density(int i, double of_particles)
{
  if (!adds) return of_particles * inverse_gamma(i);
  double added = 0.0;
  for_closest_points(i, [&](const ClosestPoint &closest) { added += profile(closest).lambda; });
  return of_particles + fluid->equation_of_state(atom->type[i]).rho0 * added;
}

double MeshBoundary::inverse_gamma(int i)
{
  if (adds) return 1.0;
  double gamma = 1.0;
  for_closest_points(i, [&](const ClosestPoint &closest) { gamma *= 1.0 - covered(closest); });
  return 1.0 / gamma;
}

double MeshBoundary::density_rate(int i, double of_particles, double back)
{
  double rate = 0.0;
  for_closest_points(i, [&](ClosestPoint closest) {
    const Vec3 velocity = velocity_from(closest);
    closest.value = table((closest.distance - back * velocity.dot(closest.normal)) / support(i));
    rate += rise(closest).dot(velocity);
  });
  return of_particles * inverse_gamma(i) + rate;
}

// the share of its kernel, behind the plane and not beyond the border

double MeshBoundary::covered(const ClosestPoint &closest)
{
  return closest.share * closest.value.lambda * (1.0 - closest.beyond.lambda);
}

// what that adds to its density over rho0, and the slope over the share

WallTable::Value MeshBoundary::profile(const ClosestPoint &closest) const
{
  return profiles[atom->type[closest.particle]]({covered(closest), 1.0, 0.0});
}

// the gradient of its density where it is moved

Eigen::Vector3d MeshBoundary::rise(const ClosestPoint &closest) const
{
  const int i = closest.particle;
  const Vec3 slope = closest.value.slope * (1.0 - closest.beyond.lambda) * closest.normal -
      closest.value.lambda * closest.beyond.slope * closest.from_border;
  if (!adds) {
    const double rho = fluid->lattices.density_of_position(i, atom->rho[i]);
    return rho * closest.share / (support(i) * (1.0 - covered(closest))) * slope;
  }
  const double rho0 = fluid->equation_of_state(atom->type[i]).rho0;
  return rho0 * profile(closest).slope * closest.share / support(i) * slope;
}

Eigen::Vector3d MeshBoundary::velocity_from(const ClosestPoint &closest) const
{
  return position_of(atom->v[closest.particle]) - sheets[closest.sheet].velocity_at(closest);
}

// Pressure, and friction as of a plane wall, fix wall/sph.  The mesh gets the opposite.

void MeshBoundary::push(int i, double p_over_rho2)
{
  push(i, p_over_rho2 / inverse_gamma(i), 1.0, true);
}

void MeshBoundary::push_more(int i, double p_over_rho2, double times)
{
  push(i, p_over_rho2 / inverse_gamma(i), times, false);
}

void MeshBoundary::push(int i, double p_over_rho2, double times, bool first_push)
{
  const double mass = atom_mass(atom, i);
  for_closest_points(i, [&](const ClosestPoint &closest) {
    const Vec3 velocity = velocity_from(closest);
    const double away = velocity.dot(closest.normal);
    const Vec3 accel = -p_over_rho2 * rise(closest) -
        times * friction(closest) * (velocity - away * closest.normal);
    const Vec3 force_on = mass / force->ftm2v * accel;
    for (int d = 0; d < 3; d++) atom->f[i][d] += force_on[d];
    sheets[closest.sheet].give(closest, -force_on);
    if (!first_push) return;
    atom->drho[i] += rise(closest).dot(velocity);
    fluid->add_virial(i, closest.distance * closest.normal, force_on);
  });
}

// rate at which it stops a particle

double MeshBoundary::friction(const ClosestPoint &closest) const
{
  const int i = closest.particle, type = atom->type[i];
  return fluid->type(type).nu * closest.share * 2.0 * fluid->equation_of_state(type).rho0 /
      atom->rho[i] * wall_friction(closest.value, closest.distance / support(i), support(i));
}

void MeshBoundary::add_stiffness(int i, Stiffness &s)
{
  if (first[i] < 0) return;
  const double scale = inverse_gamma(i);
  s.fluid *= scale * scale;
  Eigen::Map<Vec3> gradient(s.gradient);
  gradient *= scale;
  for_closest_points(i, [&](const ClosestPoint &closest) {
    gradient += rise(closest);
    s.friction += friction(closest);
  });
}

void MeshBoundary::find_vertex_stiffness(const FluidStability &stability)
{
  for (BoundaryMesh &sheet : sheets) sheet.forget_stiffness();
  for (const ClosestPoint &closest : closest_points) {
    const int i = closest.particle;
    sheets[closest.sheet].press(closest, stability.find_sound(i) * rise(closest).norm(),
                                atom_mass(atom, i) * friction(closest));
  }
  for (BoundaryMesh &sheet : sheets) sheet.complete_stiffness();
}

void MeshBoundary::add_row(int i, VertexRow &row)
{
  for_closest_points(i, [&](const ClosestPoint &closest) {
    const Vec3 of_vertices = sheets[closest.sheet].stiffness_at(closest);
    row.sum += rise(closest).norm() * of_vertices[0];
    row.friction = std::max(row.friction, of_vertices[1]);
  });
}

bool MeshBoundary::has_vertices() const
{
  return std::find(kinds.begin(), kinds.end(), Mesh::CLOTH) != kinds.end();
}

void MeshBoundary::add_gradients(int i, DirectionSums &sums)
{
  if (first[i] < 0) return;
  for (double *of : {&sums.xx, &sums.yy, &sums.zz, &sums.xy, &sums.xz, &sums.yz})
    *of *= inverse_gamma(i);
  for_closest_points(i, [&](const ClosestPoint &closest) {
    if (kinds[closest.sheet] != Mesh::CLOTH) return;
    const Vec3 gradient = rise(closest);
    const double size = gradient.norm();
    if (size > 0.0) sums.add(size, gradient[0] / size, gradient[1] / size, gradient[2] / size);
  });
}

// mesh by mesh

void MeshBoundary::add_springs(MeshScaling &springs, const std::vector<double> &strength)
{
  for (std::size_t k = 0; k < sheets.size(); k++) {
    if (kinds[k] != Mesh::CLOTH) continue;
    springs.begin_mesh(sheets[k]);
    for (const ClosestPoint &closest : closest_points) {
      if (closest.sheet != static_cast<int>(k) || !(strength[closest.particle] > 0.0)) continue;
      const Vec3 gradient = rise(closest);
      const double size = gradient.norm();
      if (size > 0.0)
        springs.add(closest, strength[closest.particle] * size, gradient / size,
                    position_of(atom->v[closest.particle]));
    }
  }
}

double MeshBoundary::approach(int i)
{
  double fastest = 0.0;
  for_closest_points(i, [&](const ClosestPoint &closest) {
    fastest = std::max(fastest, -velocity_from(closest).dot(closest.normal));
  });
  return fastest;
}

void MeshBoundary::defer(const Take &take)
{
  for (BoundaryMesh &sheet : sheets) sheet.hand_over(take);
}

void MeshBoundary::end()
{
  defer([this](int i, const Vec3 &on) {
    for (int d = 0; d < 3; d++) atom->f[i][d] += lasts * on[d];
  });
}

Wetting MeshBoundary::wetting(int i) const
{
  const Vec3 &sum = wetted_by[i];
  return sum[0] > 0.0 ? Wetting{sum[0], sum[1] / sum[0], sum[2] / sum[0]} : Wetting();
}
