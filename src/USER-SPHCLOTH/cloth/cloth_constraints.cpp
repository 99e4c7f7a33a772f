// SPDX-License-Identifier: GPL-2.0-or-later
// Constraints (4) to (6) of a cloth.
//
// The colors follow from the global IDs alone and every rank projects each constraint that touches
// one of its vertices, so that the result does not depend on the number of ranks.  Nor does it on
// the order within a color, which is that of the vertices in memory.

#include "cloth/cloth_constraints.h"

#include "atom.h"
#include "bond.h"
#include "cloth/pbd_material.h"
#include "core/pbd/coloring.h"
#include "dihedral.h"
#include "error.h"
#include "force.h"
#include "lammps_util/rank_error.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace sphcloth;

// null: another style's

static const PBDMaterial *material_of(const HasPBDMaterials *style, int type)
{
  return style && style->owns(type) ? &style->material(type) : nullptr;
}

const PBDMaterial *ClothConstraints::material_of_edge(int type) const
{
  Bond *bond = force->bond ? force->bond_match("pbd") : nullptr;
  return material_of(dynamic_cast<HasPBDMaterials *>(bond), type);
}

const PBDMaterial *ClothConstraints::material_of_hinge(int type) const
{
  Dihedral *dihedral = force->dihedral ? force->dihedral_match("pbd") : nullptr;
  return material_of(dynamic_cast<HasPBDMaterials *>(dihedral), type);
}

bool ClothConstraints::has_strain(int m) const
{
  const PBDMaterial *material = material_of_edge(mesh.edges.type[m]);
  return material && !material->no_rest && material->n_springs() > 0 && edges.rest[m] > 0.0;
}

/* ----------------------------------------------------------------------
   what follows from the mesh, the same on every rank
------------------------------------------------------------------------- */

// Rest lengths and rest angles from the rest positions, which each vertex carries.

void ClothConstraints::measure_rest(int groupbit, const ParticleColumns &rest_x,
                                    const RestBox &rest_box)
{
  const int n = mesh.n_vertices();
  std::vector<Vec3> mine(n, Vec3::Zero()), rest(n);
  tagint missing = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const Vec3 x(rest_x[0][i], rest_x[1][i], rest_x[2][i]);
    if (!std::isfinite(x[0] + x[1] + x[2])) missing = atom->tag[i];
    mine[mesh.index_of(atom->tag[i])] = x;
  }
  tagint any_missing = 0;
  MPI_Allreduce(&missing, &any_missing, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  if (any_missing)
    error->all(
        FLERR,
        "{}: vertex {} has no rest position, it was added after the fix: define the fix when "
        "the cloth is complete",
        owner, any_missing);
  MPI_Allreduce(mine.data(), rest.data(), 3 * n, MPI_DOUBLE, MPI_SUM, world);

  // nearest images, for cloth that closes over a periodic boundary
  const auto from = [&](int a, int b) { return rest_box.nearest_image(rest[b] - rest[a]); };
  mean = 0.0;
  edges.rest.clear();
  for (const auto &[a, b] : mesh.edges.vertices) {
    edges.rest.push_back(from(a, b).norm());
    mean += edges.rest.back() / static_cast<double>(mesh.edges.size());
  }
  if (mean == 0.0) mean = 1.0;    // nothing has a size: residuals are lengths
  edges.lever.assign(edges.rest.size(), 1.0);
  hinges.rest.clear();
  hinges.lever.clear();
  for (const auto &[a, e1, e2, b] : mesh.hinges.vertices) {
    const double angle = hinge_angle(from(e1, a), Vec3::Zero(), from(e1, e2), from(e1, b));
    hinges.rest.push_back(std::isnan(angle) ? 0.0 : angle);
    double lever = 0.0;
    for (const Vec3 &gradient : hinge_gradients(from(e1, a), from(e1, e2), from(e1, b)))
      lever += 0.25 * gradient.squaredNorm();
    hinges.lever.push_back(std::isnan(angle) ? 0.0 : lever);
  }
}

void ClothConstraints::color(int sweeps, bool at_once)
{
  const auto springs_of = [sweeps](const PBDMaterial *material) {
    return material ? material->springs(1.0, sweeps) : std::vector<Spring>();
  };
  edges.springs.assign(1, {});
  for (int t = 1; t <= atom->nbondtypes; t++)
    edges.springs.push_back(springs_of(material_of_edge(t)));
  hinges.springs.assign(1, {});
  for (int t = 1; t <= atom->ndihedraltypes; t++)
    hinges.springs.push_back(springs_of(material_of_hinge(t)));

  edges.layers = 1;
  for (const std::vector<Spring> &springs : edges.springs)
    edges.layers = std::max(edges.layers, static_cast<int>(springs.size()));
  edges.color = color_constraints(mesh.edges.vertices, mesh.n_vertices(), edges.colors);
  hinges.color = color_constraints(mesh.hinges.vertices, mesh.n_vertices(), hinges.colors);

  known_without_ghosts = false;
  constraints_of.assign(at_once ? mesh.n_vertices() : 0, 0);
  count(edges);
  count(hinges);
}

template <std::size_t N> void ClothConstraints::count(const Kind<N> &kind)
{
  if (constraints_of.empty()) return;
  for (std::size_t m = 0; m < kind.elements.size(); m++)
    for (int vertex : kind.elements.vertices[m])
      constraints_of[vertex] += static_cast<int>(kind.springs[kind.elements.type[m]].size());
}

// What a constraint may do of its projection in a Jacobi sweep: the same for all its vertices, so
// that momentum is kept.

template <std::size_t N> double ClothConstraints::share_of(const std::array<int, N> &vertices) const
{
  if (constraints_of.empty()) return 1.0;
  int max = 1;
  for (int vertex : vertices) max = std::max(max, constraints_of[vertex]);
  return 1.0 / max;
}

// An edge without a length is as long as its load and its compliance make it, and one that is
// welded as others are.

double ClothConstraints::size_of(const Spring &spring, const Kind<2> &) const
{
  if (spring.rest > 0.0) return spring.rest;
  return spring.compliance > 0.0 ? 0.0 : mean;
}

double ClothConstraints::shortest_edge(int i) const
{
  double shortest = std::numeric_limits<double>::infinity();
  const int vertex = mesh.index_of(atom->tag[i]);
  for (int k = mesh.edges.first[vertex]; k < mesh.edges.first[vertex + 1]; k++) {
    const double rest = rest_length(mesh.edges.incident[k]);
    if (rest > 0.0) shortest = std::min(shortest, rest);
  }
  return shortest;
}

bool ClothConstraints::any_soft_k() const
{
  const auto any_in = [](const auto &kind) {
    const auto is_soft = [&](int type) {
      return std::any_of(kind.springs[type].begin(), kind.springs[type].end(),
                         [](const Spring &s) { return s.k > 0.0 && s.k < 1.0; });
    };
    return std::any_of(kind.elements.type.begin(), kind.elements.type.end(), is_soft);
  };
  return any_in(edges) || any_in(hinges);
}

double ClothConstraints::largest_strain(const VertexHalo &halo, int held_bits) const
{
  const auto is_held = [&](int i) { return (atom->mask[i] & held_bits) != 0; };
  double strain = 0.0;
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s), vertex = mesh.index_of(atom->tag[i]);
    for (int k = mesh.edges.first[vertex]; k < mesh.edges.first[vertex + 1]; k++) {
      const int m = mesh.edges.incident[k];
      if (!has_strain(m)) continue;
      const auto &[a, b] = mesh.edges.vertices[m];
      const int j = mesh.image_near(a == vertex ? b : a, i);
      if (j < 0 || (is_held(i) && is_held(j))) continue;
      const Vec3 edge(atom->x[i][0] - atom->x[j][0], atom->x[i][1] - atom->x[j][1],
                      atom->x[i][2] - atom->x[j][2]);
      strain = std::max(strain, std::fabs(edge.norm() / rest_length(m) - 1.0));
    }
  }
  return strain;
}

void ClothConstraints::check_lengths(const ClothVertices &vertices) const
{
  const auto id = [&](int slot) { return atom->tag[vertices.halo.atom_of(slot)]; };
  for (int m = 0; m < distance.size(); m++) {
    if (distance.is_idle(m)) continue;
    const int a = distance.slot[0][m], b = distance.slot[1][m];
    const Vertex &p = vertices.p[a], &q = vertices.p[b];
    const Vec3 edge(p.x - q.x, p.y - q.y, p.z - q.z);
    if (!domain->minimum_image_check(edge[0], edge[1], edge[2])) continue;
    const double length = edge.norm(), rest = distance.rest[m];
    rank_error(lmp, FLERR,
               "{}: the edge of vertices {} and {} is {:.6g} long in step {}, {}, and reaches over "
               "half of the periodic box, where an image would be nearer: lower the time step, or "
               "make the edges stiffer",
               owner, id(a), id(b), length, update->ntimestep,
               rest > 0.0 ? fmt::format("a strain of {:.3g}", length / rest - 1.0) : "a seam");
  }
}

/* ----------------------------------------------------------------------
   this rank's, after each list build
------------------------------------------------------------------------- */

// Without ghosts they are those of the list build before while vertices are in the same order.

void ClothConstraints::collect(VertexHalo &halo)
{
  std::vector<int> vertex_of_slot(halo.n_owned());
  for (int s = 0; s < halo.n_owned(); s++)
    vertex_of_slot[s] = mesh.index_of(atom->tag[halo.atom_of(s)]);
  if (!known_without_ghosts || atom->nghost > 0 || vertex_of_slot != found_for) {
    found_edges = find(edges, halo, vertex_of_slot);
    found_hinges = find(hinges, halo, vertex_of_slot);
    found_for.swap(vertex_of_slot);
  }
  known_without_ghosts = atom->nghost == 0;
  fill(distance, edges, found_edges, halo.n_slots());
  fill(bending, hinges, found_hinges, halo.n_slots());
  ask_for_ghosts(halo);
}

// Every element with at least one owned vertex, once, by color: it is taken from the view of the
// first of its vertices that is owned here.

template <std::size_t N>
ClothConstraints::ByColor<N> ClothConstraints::find(const Kind<N> &kind, VertexHalo &halo,
                                                    const std::vector<int> &vertex_of_slot) const
{
  ByColor<N> found(kind.colors);
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s), vertex = vertex_of_slot[s];
    for (int k = kind.elements.first[vertex]; k < kind.elements.first[vertex + 1]; k++) {
      const int m = kind.elements.incident[k];
      if (kind.springs[kind.elements.type[m]].empty()) continue;
      Found<N> f{m, {}};
      int viewer = -1;
      for (std::size_t q = 0; q < N && (viewer < 0 || viewer == s); q++) {
        f.slots[q] = halo.slot_of(mesh.image_here(kind.elements.vertices[m][q], i));
        if (viewer < 0 && !halo.is_ghost(f.slots[q])) viewer = f.slots[q];
      }
      if (viewer == s) found[kind.color[m]].push_back(f);
    }
  }
  return found;
}

template <std::size_t N>
void ClothConstraints::fill(Constraints<N> &c, const Kind<N> &kind, const ByColor<N> &found,
                            int idle) const
{
  c.clear(kind.colors * kind.layers, idle);
  for (int layer = 0; layer < kind.layers; layer++)
    for (const std::vector<Found<N>> &of_color : found) {
      for (const Found<N> &f : of_color) {
        const std::vector<Spring> &springs = kind.springs[kind.elements.type[f.element]];
        if (layer >= static_cast<int>(springs.size())) continue;
        Spring spring = springs[layer];
        spring.rest *= kind.rest[f.element];
        c.add(f.slots, spring, share_of(kind.elements.vertices[f.element]), size_of(spring, kind),
              kind.lever[f.element]);
      }
      c.close_color();
    }
}

void ClothConstraints::ask_for_ghosts(VertexHalo &halo) const
{
  for (int s = halo.n_owned(); s < halo.n_slots(); s++) {
    const int vertex = mesh.index_of(atom->tag[halo.atom_of(s)]);
    halo.need(s, ALL);
    for (int k = mesh.edges.first[vertex]; k < mesh.edges.first[vertex + 1]; k++)
      for (int layer = 0; layer < edges.layers; layer++)
        halo.need(
            s, channel_of_edge_color(edges.color[mesh.edges.incident[k]] + edges.colors * layer));
    for (int k = mesh.hinges.first[vertex]; k < mesh.hinges.first[vertex + 1]; k++)
      halo.need(s, channel_of_hinge_color(hinges.color[mesh.hinges.incident[k]]));
  }
}
