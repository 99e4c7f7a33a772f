#include "fluid/mesh_boundary.h"

#include "atom.h"
#include "lammps_util/atom_tools.h"
#include "core/contact/point_triangle.h"
#include "error.h"
#include "force.h"
#include "neighbor.h"
#include "pair_sph_tait.h"
#include "lammps_util/rank_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

using namespace LAMMPS_NS;
using namespace sphcloth;

// Triangles that are equally near, at an edge or a vertex, but for rounding.
static constexpr double TIE = 1e-9;

static Eigen::Vector3d place_of(const double *x) { return {x[0], x[1], x[2]}; }

// from the nearest point of the line from a to b to p

static Eigen::Vector3d gap_to_line(const Eigen::Vector3d &p, const Eigen::Vector3d &a,
                                   const Eigen::Vector3d &b)
{
  const Eigen::Vector3d way = b - a, gap = p - a;
  const double length_sq = way.squaredNorm();
  const double at = length_sq > 0.0 ? std::clamp(way.dot(gap) / length_sq, 0.0, 1.0) : 0.0;
  return gap - at * way;
}

Eigen::Vector3d SheetWall::gap_to(const Vec3 &p, int t, Vec3 &weight) const
{
  const std::array<int, 3> &s = set->triangles[t];
  return distance_vector(p, places[s[0]], places[s[1]], places[s[2]], weight);
}

void SheetWall::find_places()
{
  for (std::size_t s = 0; s < places.size(); s++) places[s] = set->place(static_cast<int>(s));
}

// Until the next build particle and triangle come nearer by the skin at most, or go away by it.  Who is
// beyond the border sees the fluid on both sides until then, and nothing is filled.

void SheetWall::look(double list_skin, const std::function<double(int)> &reach)
{
  skin = list_skin;
  forces.assign(set->halo.n_slots(), Vec3::Zero());
  wetting = forces;
  places.resize(forces.size());
  find_places();
  places_then = places;
  candidates.clear();
  borders.clear();
  seekers.clear();
  double farthest = 0.0;
  for (int i = 0; i < atom->nlocal; i++) farthest = std::max(farthest, reach(i));
  if (farthest == 0.0 || set->triangles.empty()) return;

  std::vector<Box> boxes(set->triangles.size()), wide = boxes, border_boxes;
  std::vector<std::array<int, 2>> edges;    // of the border
  const auto box_of = [&](const auto &slots) {
    Box box;
    for (int s : slots) box.extend(places[s]);
    return box;
  };
  const auto widened = [&](Box box) {
    box.min().array() -= farthest + skin;
    box.max().array() += farthest + skin;
    return box;
  };
  for (std::size_t t = 0; t < boxes.size(); t++) {
    const std::array<int, 3> &s = set->triangles[t];
    boxes[t] = box_of(s);
    wide[t] = widened(boxes[t]);
    for (int q = 0; q < 3; q++) {
      if (!set->is_border(set->element[t], q)) continue;
      edges.push_back({s[(q + 1) % 3], s[(q + 2) % 3]});
      border_boxes.push_back(widened(box_of(edges.back())));
    }
  }
  BoxGrid grid, border_grid;
  grid.build(wide);
  border_grid.build(border_boxes);
  std::vector<Candidate> near;
  for (int i = 0; i < atom->nlocal; i++) {
    const double own = reach(i);
    if (own == 0.0) continue;
    const Vec3 p = place_of(atom->x[i]);
    near.clear();
    grid.query(Box(p), [&](int t) {
      if (const double bound = boxes[t].exteriorDistance(p); bound <= own + skin)
        near.push_back({t, bound});
    });
    keep_nearest(p, own + skin, near);
    if (near.empty() || is_beyond(p, near)) continue;
    Seeker seeker{i, own, p, candidates.size(), 0, borders.size(), 0};
    candidates.insert(candidates.end(), near.begin(), near.end());
    border_grid.query(Box(p), [&](int b) {
      if (gap_to_line(p, places[edges[b][0]], places[edges[b][1]]).norm() <= own + skin)
        borders.push_back(edges[b]);
    });
    seeker.last = candidates.size();
    seeker.last_border = borders.size();
    seekers.push_back(seeker);
  }
}

// Of triangles with the distance of their boxes those that are within reach and may become the nearest,
// sorted by their own distance.  The one with the nearest box tells most about the others.

void SheetWall::keep_nearest(const Vec3 &p, double within, std::vector<Candidate> &near) const
{
  if (near.empty()) return;
  const auto nearer = [](const Candidate &a, const Candidate &b) {
    return std::tie(a.distance, a.triangle) < std::tie(b.distance, b.triangle);
  };
  Vec3 weight;
  const int likely = std::min_element(near.begin(), near.end(), nearer)->triangle;
  double nearest = gap_to(p, likely, weight).norm();
  for (Candidate &c : near) {
    if (c.distance > nearest + 2.0 * skin) continue;
    c.distance = gap_to(p, c.triangle, weight).norm();
    nearest = std::min(nearest, c.distance);
  }
  const double most = nearest > within ? -1.0 : nearest + 2.0 * skin;
  near.erase(std::remove_if(near.begin(), near.end(),
                            [&](const Candidate &c) { return c.distance > most; }),
             near.end());
  std::sort(near.begin(), near.end(), nearer);
}

bool SheetWall::is_beyond(const Vec3 &p, const std::vector<Candidate> &nearest_first) const
{
  for (const Candidate &c : nearest_first) {
    if (c.distance > nearest_first[0].distance * (1.0 + TIE)) break;
    Vec3 weight;
    gap_to(p, c.triangle, weight);
    if (set->is_on_border(c.triangle, weight)) return true;
  }
  return false;
}

void SheetWall::find_feet(int sheet, std::vector<Foot> &feet)
{
  if (seekers.empty()) return;
  find_places();
  double moved_sq = 0.0;
  for (std::size_t s = 0; s < places.size(); s++)
    moved_sq = std::max(moved_sq, (places[s] - places_then[s]).squaredNorm());
  const double moved = std::sqrt(moved_sq);
  for (const Seeker &seeker : seekers) {
    const Vec3 p = place_of(atom->x[seeker.particle]);
    const double nearer = moved + (p - seeker.at).norm();    // at most, than at the list build
    Foot foot;
    foot.distance = seeker.reach;
    Vec3 nearest = Vec3::Zero();
    int triangle = -1;
    for (std::size_t k = seeker.first; k < seeker.last; k++) {
      if (candidates[k].distance - nearer > foot.distance) break;
      Vec3 weight;
      const Vec3 gap = gap_to(p, candidates[k].triangle, weight);
      const double distance_sq = gap.squaredNorm();
      if (distance_sq >= foot.distance * foot.distance) continue;
      foot.distance = std::sqrt(distance_sq);
      foot.weight = weight;
      nearest = gap;
      triangle = candidates[k].triangle;
    }
    if (triangle < 0 || foot.distance == 0.0) continue;
    foot.particle = seeker.particle;
    foot.sheet = sheet;
    foot.vertices = set->triangles[triangle];
    foot.normal = nearest / foot.distance;
    find_border(p - nearest, seeker, foot);
    feet.push_back(foot);
  }
}

// Of the space behind the plane only what the sheet hides is filled: what is beyond its border is seen.

void SheetWall::find_border(const Vec3 &at, const Seeker &seeker, Foot &foot) const
{
  foot.border_distance = seeker.reach;
  for (std::size_t b = seeker.first_border; b < seeker.last_border; b++) {
    const Vec3 gap = gap_to_line(at, places[borders[b][0]], places[borders[b][1]]);
    const double distance = gap.norm();
    if (distance >= foot.border_distance) continue;
    foot.border_distance = distance;
    const Vec3 in_plane = gap - gap.dot(foot.normal) * foot.normal;
    foot.from_border = distance > 0.0 ? Vec3(in_plane / distance) : Vec3::Zero();
  }
}

Eigen::Vector3d SheetWall::velocity_at(const Foot &foot) const
{
  Vec3 velocity = Vec3::Zero();
  for (int q = 0; q < 3; q++)
    velocity += foot.weight[q] * place_of(atom->v[set->halo.atom_of(foot.vertices[q])]);
  return velocity;
}

void SheetWall::spread(const Foot &foot, const Vec3 &amount, std::vector<Vec3> &over)
{
  for (int q = 0; q < 3; q++) over[foot.vertices[q]] += foot.weight[q] * amount;
}

void SheetWall::sum_up(std::vector<Vec3> &amounts,
                       const std::function<void(int, const Vec3 &)> &take)
{
  set->halo.reverse_add(0, amounts.data());
  for (int s = 0; s < set->halo.n_owned(); s++)
    if (!amounts[s].isZero(0.0)) take(set->halo.atom_of(s), amounts[s]);
  std::fill(amounts.begin(), amounts.end(), Vec3::Zero());
}

/* ----------------------------------------------------------------------
   all meshes
------------------------------------------------------------------------- */

void SheetWalls::init(PairSPHTait *fluid)
{
  pair = fluid;
  if (!pair)
    error->all(
        FLERR,
        "{}: 'wall' fills the kernel of fluid, and there is none: use 'pair_style sph/tait', "
        "or 'wall no'",
        label);
  table = pair->wall_table();
  sheets.clear();
}

void SheetWalls::add(const ContactMesh *mesh, TriangleSet *set)
{
  for (int i = 0; i < atom->nlocal; i++)
    if (mesh->has_vertex(i) && pair->is_boundary(atom->type[i]))
      rank_error(lmp, FLERR,
                 "{}: vertex {} is of type {}, a boundary type, and would press twice with 'wall': "
                 "use 'pair_coeff {} {} none', or 'wall no'",
                 label, atom->tag[i], atom->type[i], atom->type[i], atom->type[i]);
  sheets.emplace_back(lmp, set);
}

double SheetWalls::reach() const
{
  double longest = 0.0;
  for (int t = 1; t <= atom->ntypes; t++)
    if (pair->is_fluid(t)) longest = std::max(longest, pair->support(t));
  return longest + neighbor->skin;
}

double SheetWalls::support(int i) const { return pair->support(atom->type[i]); }

void SheetWalls::look()
{
  for (SheetWall &sheet : sheets)
    sheet.look(neighbor->skin, [this](int i) {
      return atom->mask[i] & groupbit && pair->is_fluid(atom->type[i]) ? support(i) : 0.0;
    });
}

void SheetWalls::begin()
{
  lasts = 1.0;
  feet.clear();
  for (std::size_t k = 0; k < sheets.size(); k++) sheets[k].find_feet(static_cast<int>(k), feet);
  if (sheets.size() > 1)
    std::sort(feet.begin(), feet.end(), [](const Foot &a, const Foot &b) {
      if (a.particle != b.particle) return a.particle < b.particle;
      return a.distance != b.distance ? a.distance < b.distance : a.sheet < b.sheet;
    });
  first.assign(atom->nlocal, -1);
  if (wetting_wanted) wetting.assign(atom->nlocal, Vec3::Zero());
  for (std::size_t k = 0; k < feet.size(); k++) {
    Foot &foot = feet[k];
    foot.value = table(foot.distance / support(foot.particle));
    foot.beyond = table(foot.border_distance / support(foot.particle));
    int &begin = first[foot.particle];
    if (begin < 0) begin = static_cast<int>(k);
    for (std::size_t nearer = begin; nearer < k; nearer++)
      foot.share *= 1.0 - std::max(0.0, foot.normal.dot(feet[nearer].normal));
  }
}

template <class Do> void SheetWalls::for_feet(int i, Do something)
{
  if (first[i] < 0) return;
  for (std::size_t k = first[i]; k < feet.size() && feet[k].particle == i; k++) something(feet[k]);
}

double SheetWalls::stretch(int i)
{
  double gamma = 1.0;
  for_feet(i, [&](const Foot &foot) { gamma *= 1.0 - covered(foot); });
  return 1.0 / gamma;
}

double SheetWalls::density_rate(int i, double back)
{
  double rate = 0.0;
  for_feet(i, [&](Foot foot) {
    const Vec3 velocity = velocity_from(foot);
    foot.value = table((foot.distance - back * velocity.dot(foot.normal)) / support(i));
    rate += rise(foot).dot(velocity);
  });
  return rate;
}

// the share of its kernel, behind the plane and not beyond the border

double SheetWalls::covered(const Foot &foot)
{
  return foot.share * foot.value.lambda * (1.0 - foot.beyond.lambda);
}

// the gradient of its density where it is moved

Eigen::Vector3d SheetWalls::rise(const Foot &foot) const
{
  const int i = foot.particle;
  const Vec3 slope = foot.value.slope * (1.0 - foot.beyond.lambda) * foot.normal -
      foot.value.lambda * foot.beyond.slope * foot.from_border;
  return atom->rho[i] * foot.share / (support(i) * (1.0 - covered(foot))) * slope;
}

Eigen::Vector3d SheetWalls::velocity_from(const Foot &foot) const
{
  return place_of(atom->v[foot.particle]) - sheets[foot.sheet].velocity_at(foot);
}

// Pressure, and friction as of a plane wall, fix wall/sph.  The mesh gets the opposite.

void SheetWalls::push(int i, double pressure_term) { push(i, pressure_term, 1.0, true); }

void SheetWalls::push_more(int i, double pressure_term, double times)
{
  push(i, pressure_term, times, false);
}

void SheetWalls::push(int i, double pressure_term, double times, bool first_push)
{
  const int type = atom->type[i];
  const Tait &eos = pair->equation_of_state(type);
  const double mass = atom_mass(atom, i), nu = pair->laminar_viscosity(type);
  for_feet(i, [&](const Foot &foot) {
    const Vec3 velocity = velocity_from(foot);
    const double away = velocity.dot(foot.normal);
    const double friction = nu * foot.share * 2.0 * eos.rho0 / atom->rho[i] *
        wall_friction(foot.value, foot.distance / support(i), support(i));
    const Vec3 accel =
        -pressure_term * rise(foot) - times * friction * (velocity - away * foot.normal);
    const Vec3 force_on = mass / force->ftm2v * accel;
    for (int d = 0; d < 3; d++) atom->f[i][d] += force_on[d];
    sheets[foot.sheet].give(foot, -force_on);
    if (!first_push) return;
    atom->drho[i] += rise(foot).dot(velocity);
    pair->add_virial(i, foot.distance * foot.normal, force_on);
    if (wetting_wanted) {
      const double moves = 2.0 * mass * covered(foot);
      sheets[foot.sheet].wet(foot, Vec3(moves, moves * eos.sound_speed(), 0.0));
    }
  });
}

double SheetWalls::approach(int i)
{
  double fastest = 0.0;
  for_feet(i, [&](const Foot &foot) {
    fastest = std::max(fastest, -velocity_from(foot).dot(foot.normal));
  });
  return fastest;
}

void SheetWalls::hand_over(const std::function<void(int, const Vec3 &)> &take)
{
  for (SheetWall &sheet : sheets) sheet.hand_over(take);
}

void SheetWalls::end()
{
  hand_over([this](int i, const Vec3 &on) {
    for (int d = 0; d < 3; d++) atom->f[i][d] += lasts * on[d];
  });
  if (!wetting_wanted) return;
  for (SheetWall &sheet : sheets)
    sheet.hand_over_wetting([this](int i, const Vec3 &amount) { wetting[i] += amount; });
}
