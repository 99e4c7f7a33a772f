// SPDX-License-Identifier: GPL-2.0-or-later
// Finds the points of a mesh nearest to particles among the triangles that were near at the last
// list build.

#include "fluid/boundary_mesh.h"

#include "atom.h"
#include "core/contact/point_triangle.h"
#include "core/geometry/box_grid.h"

#include <algorithm>
#include <cmath>
#include <tuple>

using namespace LAMMPS_NS;
using namespace sphcloth;

// Triangles that are equally near, at an edge or a vertex, but for rounding.
static constexpr double TIE = 1e-9;
// Nearer to the border than this part of an edge the triangle says where the border is.
static constexpr double AT_BORDER = 1e-6;
// How far, in supports, is a border that is within one of the closest point?
static constexpr double FROM_BORDER = 1.4142136;

static Eigen::Vector3d position_of(const double *x) { return {x[0], x[1], x[2]}; }

// from the nearest point of the line from a to b to p

static Eigen::Vector3d gap_to_line(const Eigen::Vector3d &p, const Eigen::Vector3d &a,
                                   const Eigen::Vector3d &b)
{
  const Eigen::Vector3d displacement = b - a, gap = p - a;
  const double length_sq = displacement.squaredNorm();
  const double at = length_sq > 0.0 ? std::clamp(displacement.dot(gap) / length_sq, 0.0, 1.0) : 0.0;
  return gap - at * displacement;
}

Eigen::Vector3d BoundaryMesh::gap_to(const Vec3 &p, int t, Vec3 &weight) const
{
  const std::array<int, 3> &s = set->triangles[t];
  return distance_vector(p, positions[s[0]], positions[s[1]], positions[s[2]], weight);
}

// Fewer candidates have to be found anew more often.

double BoundaryMesh::margin() const
{
  constexpr double OF_SKIN = 0.2;
  return OF_SKIN * skin;
}

template <class OfVertex> void BoundaryMesh::find_positions(OfVertex of_vertex)
{
  double step_sq = 0.0, since_sq = 0.0;
  for (std::size_t s = 0; s < positions.size(); s++) {
    const Vec3 now = of_vertex(static_cast<int>(s));
    step_sq = std::max(step_sq, (now - positions[s]).squaredNorm());
    since_sq = std::max(since_sq, (now - list_positions[s]).squaredNorm());
    positions[s] = now;
  }
  path += std::sqrt(step_sq);
  displacement = std::sqrt(since_sq);
}

void BoundaryMesh::sort_triangles(double farthest)
{
  discs.resize(set->triangles.size());
  for (std::size_t t = 0; t < discs.size(); t++) {
    const auto &[a, b, c] = set->triangles[t];
    discs[t] = disc_around(positions[a], positions[b], positions[c]);
    if (part == Part::WATERTIGHT && set->is_porous(static_cast<int>(t))) discs[t].radius = -1.0;
  }
  grid.build(discs, farthest);
}

// Until the next build particle and triangle come nearer by the skin at most, or go away by it.

void BoundaryMesh::update_candidates(double list_skin, const std::function<double(int)> &reach)
{
  skin = list_skin;
  path = 0.0;
  forces.assign(set->halo.n_slots(), Vec3::Zero());
  wetting = stiffness = forces;
  positions.resize(forces.size());
  for (std::size_t s = 0; s < positions.size(); s++)
    positions[s] = set->position(static_cast<int>(s));
  list_positions = positions;
  candidates.clear();
  borders.clear();
  seekers.clear();
  double farthest = 0.0;
  for (int i = 0; i < atom->nlocal; i++) farthest = std::max(farthest, reach(i));
  if (farthest == 0.0 || set->triangles.empty()) return;

  sort_triangles(farthest);
  std::vector<Box> border_boxes;
  std::vector<std::array<int, 2>> edges;    // of the border
  for (std::size_t t = 0; t < set->triangles.size(); t++)
    for (int q = 0; q < 3; q++) {
      if (!set->is_border(set->element[t], q)) continue;
      const std::array<int, 3> &s = set->triangles[t];
      edges.push_back({s[(q + 1) % 3], s[(q + 2) % 3]});
      Box box(positions[edges.back()[0]]);
      box.extend(positions[edges.back()[1]]);
      box.min().array() -= FROM_BORDER * farthest + skin;
      box.max().array() += FROM_BORDER * farthest + skin;
      border_boxes.push_back(box);
    }
  BoxGrid border_grid;
  border_grid.build(border_boxes);
  for (int i = 0; i < atom->nlocal; i++) {
    const double support = reach(i);
    if (support == 0.0) continue;
    const Vec3 p = position_of(atom->x[i]);
    find_candidates(p, support + skin);
    if (near.empty()) continue;
    Seeker seeker{i, support, p, 0.0, 0, 0, borders.size(), 0};
    store_candidates(seeker, p);
    border_grid.query(Box(p), [&](int b) {
      const Vec3 gap = gap_to_line(p, positions[edges[b][0]], positions[edges[b][1]]);
      if (gap.norm() <= FROM_BORDER * support + skin) borders.push_back(edges[b]);
    });
    seeker.last_border = borders.size();
    seekers.push_back(seeker);
  }
}

// Of the triangles within a distance those that may become the nearest, sorted by their own
// distance.  Each is near the disc that it had at the list build.

void BoundaryMesh::find_candidates(const Vec3 &p, double within)
{
  near.clear();
  double nearest = within;
  const double slack = 2.0 * (margin() + displacement);
  grid.nearest(p, within + displacement, slack, [&](int t) {
    Vec3 weight;
    const double distance = gap_to(p, t, weight).norm();
    nearest = std::min(nearest, distance);
    near.push_back({t, distance});
  });
  const double cutoff = std::min(within, nearest + 2.0 * margin());
  near.erase(std::remove_if(near.begin(), near.end(),
                            [&](const Candidate &c) { return c.distance > cutoff; }),
             near.end());
  std::sort(near.begin(), near.end(), [](const Candidate &a, const Candidate &b) {
    return std::tie(a.distance, a.triangle) < std::tie(b.distance, b.triangle);
  });
}

void BoundaryMesh::store_candidates(Seeker &seeker, const Vec3 &p)
{
  seeker.at = p;
  seeker.path = path;
  seeker.first = candidates.size();
  candidates.insert(candidates.end(), near.begin(), near.end());
  seeker.last = candidates.size();
}

// Beyond the border there is fluid on both sides.  Of a vertex of the border some triangles have no
// edge there.

bool BoundaryMesh::is_beyond(const Vec3 &p, const Seeker &seeker, const ClosestPoint &closest) const
{
  if (seeker.first_border == seeker.last_border) return false;
  for (std::size_t k = seeker.first; k < seeker.last; k++) {
    Vec3 weight;
    const double distance = gap_to(p, candidates[k].triangle, weight).norm();
    if (distance > closest.distance * (1.0 + TIE)) continue;
    if (set->is_on_border(candidates[k].triangle, weight)) return true;
  }
  return false;
}

void BoundaryMesh::find_closest_points(int sheet, std::vector<ClosestPoint> &closest_points)
{
  find_closest_points_at(
      sheet, closest_points, [this](int s) { return set->position(s); },
      [this](int i) { return position_of(atom->x[i]); });
}

void BoundaryMesh::find_closest_points(int sheet, std::vector<ClosestPoint> &closest_points,
                                       const std::vector<Vec3> &of_vertices,
                                       const std::function<Vec3(int)> &of_particle)
{
  find_closest_points_at(
      sheet, closest_points, [&of_vertices](int s) { return of_vertices[s]; }, of_particle);
}

template <class OfVertex, class OfParticle>
void BoundaryMesh::find_closest_points_at(int sheet, std::vector<ClosestPoint> &closest_points,
                                          OfVertex of_vertex, OfParticle of_particle)
{
  if (seekers.empty()) return;
  find_positions(of_vertex);
  for (Seeker &seeker : seekers) {
    if (!(atom->mask[seeker.particle] & groupbit)) continue;
    const Vec3 p = of_particle(seeker.particle);
    double nearer = path - seeker.path + (p - seeker.at).norm();    // at most, than then
    if (nearer > margin()) {
      find_candidates(p, seeker.reach + skin);
      store_candidates(seeker, p);
      nearer = 0.0;
    }
    ClosestPoint closest;
    closest.distance = seeker.reach;
    Vec3 nearest = Vec3::Zero();
    int triangle = -1;
    for (std::size_t k = seeker.first; k < seeker.last; k++) {
      if (candidates[k].distance - nearer > closest.distance) break;
      Vec3 weight;
      const Vec3 gap = gap_to(p, candidates[k].triangle, weight);
      const double distance_sq = gap.squaredNorm();
      if (distance_sq >= closest.distance * closest.distance) continue;
      closest.distance = std::sqrt(distance_sq);
      closest.weight = weight;
      nearest = gap;
      triangle = candidates[k].triangle;
    }
    if (triangle < 0 || closest.distance == 0.0) continue;
    if (part == Part::WATERTIGHT && is_beyond(p, seeker, closest)) continue;
    closest.particle = seeker.particle;
    closest.sheet = sheet;
    closest.triangle = triangle;
    closest.vertices = set->triangles[triangle];
    closest.normal = nearest / closest.distance;
    find_border(p - nearest, seeker, closest);
    closest_points.push_back(closest);
  }
}

// Of the space behind the plane only what the sheet hides is filled: what is beyond its border is
// seen.

void BoundaryMesh::find_border(const Vec3 &at, const Seeker &seeker, ClosestPoint &closest) const
{
  closest.border_distance = seeker.reach;
  for (std::size_t b = seeker.first_border; b < seeker.last_border; b++) {
    const Vec3 gap = gap_to_line(at, positions[borders[b][0]], positions[borders[b][1]]);
    const double distance = gap.norm();
    if (distance >= closest.border_distance) continue;
    closest.border_distance = distance;
    const Vec3 &end = positions[borders[b][0]], edge = positions[borders[b][1]] - end;
    if (distance > AT_BORDER * edge.norm()) {
      closest.from_border = (gap - gap.dot(closest.normal) * closest.normal) / distance;
    } else {    // the difference of two points says nothing
      const auto &[u, v, w] = closest.vertices;
      const Vec3 center = (positions[u] + positions[v] + positions[w]) / 3.0;
      const Vec3 across = closest.normal.cross(edge).normalized();
      closest.from_border = std::copysign(1.0, across.dot(center - end)) * across;
    }
  }
}

Eigen::Vector3d BoundaryMesh::velocity_of(int slot) const
{
  return position_of(atom->v[set->halo.atom_of(slot)]);
}

Eigen::Vector3d BoundaryMesh::velocity_at(const ClosestPoint &closest) const
{
  Vec3 velocity = Vec3::Zero();
  for (int q = 0; q < 3; q++) velocity += closest.weight[q] * velocity_of(closest.vertices[q]);
  return velocity;
}

void BoundaryMesh::spread(const ClosestPoint &closest, const Vec3 &quantity,
                          std::vector<Vec3> &over)
{
  for (int q = 0; q < 3; q++) over[closest.vertices[q]] += closest.weight[q] * quantity;
}

void BoundaryMesh::sum_up(std::vector<Vec3> &quantities,
                          const std::function<void(int, const Vec3 &)> &take)
{
  set->halo.reverse_add(0, quantities.data());
  for (int s = 0; s < set->halo.n_owned(); s++)
    if (!quantities[s].isZero(0.0)) take(set->halo.atom_of(s), quantities[s]);
  std::fill(quantities.begin(), quantities.end(), Vec3::Zero());
}

void BoundaryMesh::complete_stiffness()
{
  set->halo.reverse_add(0, stiffness.data());
  for (int s = 0; s < set->halo.n_owned(); s++)
    stiffness[s] *= set->mesh->inverse_mass(set->halo.atom_of(s));
  set->halo.forward(0, stiffness.data());
}

Eigen::Vector3d BoundaryMesh::stiffness_at(const ClosestPoint &closest) const
{
  Vec3 found = Vec3::Zero();
  for (int q = 0; q < 3; q++) {
    const Vec3 &of = stiffness[closest.vertices[q]];
    found[0] += closest.weight[q] * of[0];
    found[1] = std::max(found[1], of[1]);
  }
  return found;
}
