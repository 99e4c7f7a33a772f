// SPDX-License-Identifier: GPL-2.0-or-later
// The volume of a surface that hangs together in space is the flow through it of x/3, whose
// divergence is 1.  Where it hangs together with its periodic image, as a tube does, x/2 without
// its part along the tube has the same divergence, and that flow is the volume of one period.

#include "cloth/gas_chambers.h"

#include "atom.h"
#include "comm.h"
#include "core/geometry/buckets.h"
#include "core/util/bytes.h"
#include "domain.h"
#include "error.h"
#include "lammps_util/lammps_version.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using sphcloth::OrientedSurface;

using Periods = std::array<int, 3>;

/* ----------------------------------------------------------------------
   the chambers, the same on all ranks
------------------------------------------------------------------------- */

void GasChambers::gather(int groupbit, bool warns)
{
  mesh.gather(groupbit, ClothTopology::Leaving::LEFT_OUT);
  if (!mesh.triangles.size())
    error->all(FLERR,
               "{}: no triangle has all its vertices in the group: give a group of a mesh with "
               "triangles (LAMMPS angles), of create_cloth or sphcloth mesh",
               owner);
  surface = OrientedSurface(mesh.triangles.vertices);
  std::vector<Vec3> x = unwrapped();
  unwrap(x);
  check_surface(warns);
  find_members();
  find_frames(x);
}

void GasChambers::check_surface(bool warns) const
{
  const auto &edge = surface.flawed_edge;
  if (surface.flaw == OrientedSurface::Flaw::BRANCHED)
    error->all(FLERR,
               "{}: more than two triangles meet at the edge of atoms {} and {}: give each chamber "
               "a group and a fix of its own",
               owner, mesh.ids[edge[0]], mesh.ids[edge[1]]);
  if (surface.flaw == OrientedSurface::Flaw::ONE_SIDED)
    error->all(FLERR,
               "{}: the surface is one-sided, as is seen at the edge of atoms {} and {}: gas needs "
               "an inside, take triangles out of the group",
               owner, mesh.ids[edge[0]], mesh.ids[edge[1]]);
  if (!options.needs_volume) return;
  for (int c = 0; c < surface.parts(); c++) {
    const tagint id = mesh.ids[surface.first[c]];
    if (wraps[c].several || (wraps[c].any() && options.closes_holes))
      error->all(FLERR,
                 "{}: the mesh of atom {} hangs together with its periodic images and encloses no "
                 "volume: use a larger box, or a constant 'pressure'",
                 owner, id);
    if (surface.is_closed(c)) continue;
    const std::string holes = holes_in_words(c);
    if (!options.closes_holes)
      error->all(FLERR,
                 "{}: the mesh of atom {} is open, {}: close it, add 'close yes' to close holes by "
                 "lids that weigh nothing, or use a constant 'pressure'",
                 owner, id, holes);
    if (warns && comm->me == 0)
      error->warning(FLERR, "{}: the mesh of atom {} is open, {}: lids that weigh nothing close it",
                     owner, id, holes);
  }
}

std::string GasChambers::holes_in_words(int chamber) const
{
  constexpr std::size_t MAX_HOLES = 5, MAX_IDS = 12;
  std::string words;
  std::size_t n = 0;
  for (const auto &hole : surface.holes) {
    if (hole.part != chamber || n++ >= MAX_HOLES) continue;
    words += n > 1 ? ";" : "";
    for (std::size_t k = 0; k < std::min(hole.loop.size(), MAX_IDS); k++)
      words += fmt::format(" {}", mesh.ids[hole.loop[k]]);
    if (hole.loop.size() > MAX_IDS) words += fmt::format(" ... ({} atoms)", hole.loop.size());
  }
  if (n > MAX_HOLES) words += "; ...";
  return fmt::format("{} {} bounded by atoms{}", n, n == 1 ? "hole" : "holes", words);
}

std::vector<Eigen::Vector3d> GasChambers::unwrapped() const
{
  std::vector<double> mine(3 * mesh.ids.size(), 0.0), all(mine.size());
  for (int i = 0; i < atom->nlocal; i++)
    if (const int vertex = mesh.index_of(atom->tag[i]); vertex >= 0)
      domain->unmap(atom->x[i], atom->image[i], &mine[3 * vertex]);
  MPI_Allreduce(mine.data(), all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, world);
  std::vector<Vec3> x;
  for (std::size_t k = 0; k < all.size(); k += 3) x.emplace_back(all[k], all[k + 1], all[k + 2]);
  return x;
}

// From vertex to vertex along the edges, each by the nearest image.  Image counts of LAMMPS go on
// with the atoms, so that the shifts stay what they are during a run.

void GasChambers::unwrap(std::vector<Vec3> &x)
{
  std::vector<int> first, incident;
  const auto for_each = [&](auto add) {
    for (std::size_t m = 0; m < surface.triangles.size(); m++)
      for (const int v : surface.triangles[m])
        add(static_cast<std::size_t>(v), static_cast<int>(m));
  };
  sphcloth::sort_into_buckets(x.size(), for_each, first, incident);

  const double *to_periods = domain->h_inv;
  const auto periods_to = [&](int a, int b) {    // from where b is to its image nearest to a
    const Vec3 apart = x[b] - x[a];
    Vec3 nearest = apart;
    release::minimum_image(domain, nearest.data());
    const Vec3 d = nearest - apart;
    return Periods{static_cast<int>(std::lround(to_periods[0] * d[0] + to_periods[5] * d[1] +
                                                to_periods[4] * d[2])),
                   static_cast<int>(std::lround(to_periods[1] * d[1] + to_periods[3] * d[2])),
                   static_cast<int>(std::lround(to_periods[2] * d[2]))};
  };

  shifts.assign(x.size(), {});
  wraps.assign(surface.parts(), {});
  std::vector<char> known(x.size(), 0);
  for (std::size_t start = 0; start < x.size(); start++) {
    if (known[start]) continue;
    std::vector<int> found{static_cast<int>(start)};
    known[start] = 1;
    for (std::size_t k = 0; k < found.size(); k++) {
      const int a = found[k];
      for (int m = first[a]; m < first[a + 1]; m++)
        for (const int b : surface.triangles[incident[m]]) {
          if (b == a) continue;
          const Periods by = periods_to(a, b);
          if (!known[b]) {
            known[b] = 1;
            shifts[b] = by;
            x[b] += lattice(by);
            found.push_back(b);
            continue;
          }
          if (by == Periods{}) continue;
          Wrap &wrap = wraps[surface.part[incident[m]]];
          if (!wrap.any()) wrap.along = by;
          const auto &w = wrap.along;
          wrap.several = wrap.several || w[1] * by[2] != w[2] * by[1] ||
              w[2] * by[0] != w[0] * by[2] || w[0] * by[1] != w[1] * by[0];
        }
    }
  }
}

Eigen::Vector3d GasChambers::lattice(const Periods &n) const
{
  const double *h = domain->h;
  return {h[0] * n[0] + h[5] * n[1] + h[4] * n[2], h[1] * n[1] + h[3] * n[2], h[2] * n[2]};
}

// Volumes are measured from the middle of the rims, so that a flat sheet has none, or of all
// vertices.

void GasChambers::find_frames(const std::vector<Vec3> &x)
{
  const int n = surface.parts();
  std::vector<Vec3> rim(n, Vec3::Zero()), all(n, Vec3::Zero()), area(n, Vec3::Zero());
  std::vector<double> n_rim(n, 0.0), n_all(n, 0.0), volume(n, 0.0);
  for (const auto &hole : surface.holes)
    for (const int v : hole.loop) {
      rim[hole.part] += x[v];
      n_rim[hole.part] += 1.0;
    }
  for (std::size_t m = 0; m < surface.triangles.size(); m++)
    for (const int v : surface.triangles[m]) {
      all[surface.part[m]] += x[v];
      n_all[surface.part[m]] += 1.0;
    }
  frames.clear();
  for (int c = 0; c < n; c++) {
    const Vec3 origin = n_rim[c] > 0.0 ? Vec3(rim[c] / n_rim[c]) : Vec3(all[c] / n_all[c]);
    frames.push_back({{origin[0], origin[1], origin[2]}, 1.0});
  }
  for (std::size_t m = 0; m < surface.triangles.size(); m++) {
    const auto &t = surface.triangles[m];
    const int c = surface.part[m];
    // by the images that are next to the first vertex
    Vec3 a = x[t[1]] - x[t[0]], b = x[t[2]] - x[t[0]];
    release::minimum_image(domain, a.data());
    release::minimum_image(domain, b.data());
    const Vec3 of_triangle = 0.5 * a.cross(b), origin(frames[c].origin);
    const Vec3 along = lattice(wraps[c].along).normalized();
    Vec3 middle = x[t[0]] + (a + b) / 3.0 - origin;
    if (wraps[c].any()) middle -= middle.dot(along) * along;
    volume[c] += middle.dot(of_triangle);
    area[c] += of_triangle;
  }
  for (int c = 0; c < n; c++) {
    const bool encloses = surface.is_closed(c) || options.closes_holes;
    const double outward = encloses ? volume[c] : area[c].dot(options.toward);
    if (outward < 0.0) frames[c].side = -1.0;
  }
}

void GasChambers::require_ghosts()
{
  if (!ghosts.matters()) return;
  mesh.measure_triangles();
  ghosts.require(mesh.longest_edge(), mesh.longest_edge());
}

void GasChambers::require_ghosts_in_run()
{
  if (!ghosts.matters()) return;
  mesh.measure_triangles();
  ghosts.require_in_run(mesh.longest_edge(), mesh.longest_edge());
}

/* ----------------------------------------------------------------------
   this rank's triangles: those with a vertex that it owns
------------------------------------------------------------------------- */

int GasChambers::owned(int vertex) const
{
  const int i = atom->map(mesh.ids[vertex]);
  return i >= 0 && i < atom->nlocal ? i : -1;
}

int GasChambers::member(int chamber, int vertex) const
{
  const auto it = std::lower_bound(members.begin(), members.end(), Member{chamber, vertex});
  return static_cast<int>(it - members.begin());
}

void GasChambers::find_members()
{
  members.clear();
  for (std::size_t m = 0; m < surface.triangles.size(); m++)
    for (const int v : surface.triangles[m]) members.push_back({surface.part[m], v});
  std::sort(members.begin(), members.end());
  members.erase(std::unique(members.begin(), members.end()), members.end());
  corners.clear();
  for (std::size_t m = 0; m < surface.triangles.size(); m++) {
    const auto &[a, b, c] = surface.triangles[m];
    const int part = surface.part[m];
    corners.push_back({member(part, a), member(part, b), member(part, c)});
  }
}

void GasChambers::collect(const std::function<double(int)> &inverse_mass)
{
  slots.clear();
  slot_of_member.clear();
  for (const auto &[chamber, vertex] : members) {
    const int mine = owned(vertex);
    slot_of_member.push_back(mine < 0 ? -1 : static_cast<int>(slots.size()));
    if (mine >= 0) slots.push_back({chamber, mine, inverse_mass(mine)});
  }
  gradient.resize(slots.size());
  triangles.clear();
  for (std::size_t m = 0; m < surface.triangles.size(); m++) {
    const std::array<int, 3> &t = surface.triangles[m];
    Triangle here{};
    int first = 0;    // of its vertices that this rank owns
    for (int k = 2; k >= 0; k--) {
      here.slot[k] = slot_of_member[corners[m][k]];
      if (here.slot[k] >= 0) first = k;
    }
    here.counted = here.slot[0] >= 0;
    std::rotate(here.slot, here.slot + first, here.slot + 3);
    if (here.slot[0] < 0) continue;
    const int i = slots[here.slot[0]].atom;
    here.chamber = surface.part[m];
    here.shift = &shifts[t[first]];
    const Vec3 offset = position(i, *here.shift) - Vec3(atom->x[i]);
    std::copy(offset.data(), offset.data() + 3, here.offset);
    here.atom[0] = i;
    for (int k = 1; k < 3; k++) here.atom[k] = mesh.image_here(t[(first + k) % 3], i);
    triangles.push_back(here);
  }
  lid_slots.clear();
  if (!options.closes_holes) return;
  for (const auto &hole : surface.holes)
    for (const int v : hole.loop) lid_slots.push_back(slot_of_member[member(hole.part, v)]);
}

/* ----------------------------------------------------------------------
   volumes and their gradients
------------------------------------------------------------------------- */

Eigen::Vector3d GasChambers::position(int i, const Periods &shift) const
{
  Vec3 x;
  domain->unmap(atom->x[i], atom->image[i], x.data());
  return x + lattice(shift);
}

std::vector<GasChambers::Volume> GasChambers::measure(const std::vector<Frame> &at)
{
  constexpr int N = sizeof(Volume) / sizeof(double);
  std::vector<double> mine(static_cast<std::size_t>(N * count()), 0.0), all(mine.size());
  std::fill(gradient.begin(), gradient.end(), Vec3::Zero());
  std::vector<Vec3> along;
  for (const Wrap &wrap : wraps) along.push_back(lattice(wrap.along).normalized());
  for (const Triangle &t : triangles)
    mine[N * t.chamber] += add_triangle(t, at[t.chamber], along[t.chamber]);
  if (options.closes_holes && any_open()) {
    std::vector<double> lids(count(), 0.0);
    add_lids(at, lids.data());
    for (int c = 0; comm->me == 0 && c < count(); c++) mine[N * c] += lids[c];
  }
  for (std::size_t s = 0; s < slots.size(); s++) {
    const int i = slots[s].atom;
    const double *v = atom->v[i];
    double *sums = &mine[N * slots[s].chamber];
    sums[1] += gradient[s].dot(Vec3(v[0], v[1], v[2]));
    sums[2] += slots[s].inverse_mass * gradient[s].squaredNorm();
  }
  MPI_Allreduce(mine.data(), all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, world);
  std::vector<Volume> volumes;
  for (int c = 0; c < count(); c++) volumes.push_back({all[N * c], all[N * c + 1], all[N * c + 2]});
  return volumes;
}

// its part of the volume, where it is counted

double GasChambers::add_triangle(const Triangle &t, const Frame &at, const Vec3 &along)
{
  const double *const *x = atom->x;
  const Vec3 first(x[t.atom[0]]);
  const Vec3 a = Vec3(x[t.atom[1]]) - first, b = Vec3(x[t.atom[2]]) - first;
  const Vec3 area = 0.5 * at.side * a.cross(b);
  for (const int slot : t.slot)
    if (slot >= 0) gradient[slot] += area / 3.0;
  if (!t.counted) return 0.0;
  const Vec3 here = domain->box_change ? position(t.atom[0], *t.shift) : first + Vec3(t.offset);
  const Vec3 middle = here - Vec3(at.origin) + (a + b) / 3.0;
  if (!wraps[t.chamber].any()) return middle.dot(area) / 3.0;
  return (middle - middle.dot(along) * along).dot(area) / 2.0;
}

// A lid has its middle vertex where the mean of its rim is: what pushes that pushes the rim, all
// its vertices alike.  All ranks find the same.

void GasChambers::add_lids(const std::vector<Frame> &at, double *volumes)
{
  std::vector<double> mine(3 * lid_slots.size(), 0.0), all(mine.size());
  std::size_t k = 0;
  for (const auto &hole : surface.holes)
    for (const int v : hole.loop) {
      const int slot = lid_slots[k];
      if (slot >= 0) {
        const Vec3 x = position(slots[slot].atom, shifts[v]) - Vec3(at[hole.part].origin);
        std::copy(x.data(), x.data() + 3, &mine[3 * k]);
      }
      k++;
    }
  MPI_Allreduce(mine.data(), all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, world);
  k = 0;
  for (const auto &hole : surface.holes) {
    const std::size_t n = hole.loop.size();
    const Eigen::Map<const Eigen::Matrix3Xd> rim(&all[3 * k], 3, static_cast<Eigen::Index>(n));
    const int *slot = &lid_slots[k];
    const Vec3 middle =
        rim * Eigen::VectorXd::Constant(static_cast<Eigen::Index>(n), 1.0 / static_cast<double>(n));
    Vec3 total = Vec3::Zero();
    for (std::size_t i = 0; i < n; i++) {    // the mesh runs from a to b, the lid from b to a
      const std::size_t next = (i + 1) % n;
      const Vec3 a = rim.col(static_cast<Eigen::Index>(i));
      const Vec3 b = rim.col(static_cast<Eigen::Index>(next));
      const Vec3 area = 0.5 * at[hole.part].side * (a - b).cross(middle - b);
      volumes[hole.part] += middle.dot(area) / 3.0;
      if (slot[i] >= 0) gradient[slot[i]] += area / 3.0;
      if (slot[next] >= 0) gradient[slot[next]] += area / 3.0;
      total += area;
    }
    for (std::size_t i = 0; i < n; i++)
      if (slot[i] >= 0) gradient[slot[i]] += total / (3.0 * static_cast<double>(n));
    k += n;
  }
}

std::vector<double> GasChambers::rates() const
{
  std::vector<double> mine(count(), 0.0), all(mine.size());
  for (std::size_t s = 0; s < slots.size(); s++)
    mine[slots[s].chamber] += gradient[s].dot(Vec3(atom->v[slots[s].atom]));
  MPI_Allreduce(mine.data(), all.data(), count(), MPI_DOUBLE, MPI_SUM, world);
  return all;
}

void GasChambers::push(const std::vector<double> &by_chamber) const
{
  for (std::size_t s = 0; s < slots.size(); s++)
    for (int d = 0; d < 3; d++)
      atom->f[slots[s].atom][d] += by_chamber[slots[s].chamber] * gradient[s][d];
}

double GasChambers::bytes() const
{
  return sphcloth::bytes_of(triangles, slots, gradient, shifts, members, corners, slot_of_member);
}
