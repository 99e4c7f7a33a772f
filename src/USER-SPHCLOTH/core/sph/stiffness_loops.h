// SPDX-License-Identifier: GPL-2.0-or-later
// What bounds the step by stability: sums of squared density gradients over the neighbors that
// move, core/sph/stiffness.h.

#ifndef SPHCLOTH_CORE_SPH_STIFFNESS_LOOPS_H
#define SPHCLOTH_CORE_SPH_STIFFNESS_LOOPS_H

#include "core/sph/fluid_loops.h"

namespace sphcloth {

// The neighbors of one type

template <class K, class P>
template <bool BOUNDARY, bool SHARES>
SPHCLOTH_INLINE void FluidLoops<K, P>::add_stiffness(const Neighborhood &of, const PairTerms &whole,
                                                     const double *share, Columns &c,
                                                     Stiffness &s) const
{
  const Terms &t = of.terms;
  const double *mass = nullptr;
  alignas(64) double shares[LANES];
  LaneSum<LANES> x, y, z, squares, pressed, weights;
  records.for_neighbors(
      of, c,
      [&](int from) SPHCLOTH_LAMBDA {
        const int *near = of.near.of + from;
        records.load_positions(c, near);
        if (SHARES)
          for (int m = 0; m < LANES; m++) shares[m] = share[near[m]];
        mass = of.masses.group(from);
      },
      [&](int k, Separation r) SPHCLOTH_LAMBDA {
        const Real r_sq = r.sq();
        const Real slope = (BOUNDARY ? t.rho0 : t.rho0_ratio) * t.f *
            K::slope_over_q(std::sqrt(r_sq) * t.inv_support);
        const double each = mass[k] * slope;    // of a boundary its volume
        x.of[k] += each * r.x;
        y.of[k] += each * r.y;
        z.of[k] += each * r.z;
        const double square = each * (slope * r_sq);
        if (!BOUNDARY) squares.of[k] += square;
        if (SHARES) pressed.of[k] += square * shares[k];
        weights.of[k] -= each;
      });
  const double response = BOUNDARY ? whole.response : 1.0;
  s.gradient[0] += response * f_unit * x.total();
  s.gradient[1] += response * f_unit * y.total();
  s.gradient[2] += response * f_unit * z.total();
  s.fluid += f_unit * f_unit * squares.total();
  s.pressed += f_unit * f_unit * pressed.total();
  s.friction += whole.friction_rate() * f_unit / records.unit * weights.total();
}

template <class K, class P>
template <bool SHARES>
SPHCLOTH_MULTIVERSION void FluidLoops<K, P>::all_stiffness(const Particles &p, const Selection &of,
                                                           const double *share, Stiffness *found)
{
  Columns c;
  for (int t = 1; t <= model.n_types; t++) {
    if (!is_fluid(t)) continue;
    for (const int slot : of.of(t)) {
      const int i = lists.at(slot);
      Stiffness s;
      for (const int other : lists.present_types()) {
        const NeighborSpan near = lists(slot, other);
        if (near.n == 0) continue;
        const PairTerms &whole = model.pair(t, other);
        const Neighborhood of_type{i, near, pair(t, other), masses(p, near, other)};
        if (is_fluid(other))
          add_stiffness<false, SHARES>(of_type, whole, share, c, s);
        else
          add_stiffness<true, false>(of_type, whole, share, c, s);
      }
      s.friction /= p.rho[i];
      found[i] = s;
    }
  }
}

// d rho/d x of a fluid particle i over the volume of the vertex j, as a length along a unit vector

struct Press {
  double x, y, z, size, slope;
};

template <class K> SPHCLOTH_INLINE Press press(const Particles &p, int i, int j, const PairTerms &t)
{
  const double dx = p.x[3 * i] - p.x[3 * j], dy = p.x[3 * i + 1] - p.x[3 * j + 1],
               dz = p.x[3 * i + 2] - p.x[3 * j + 2];
  const double r = std::sqrt(dx * dx + dy * dy + dz * dz);
  const double slope = -t.rho0 * t.kernel.f * K::slope_over_q(r * t.kernel.inv_support);
  const double inv_r = r > 0.0 ? 1.0 / r : 0.0;
  return {dx * inv_r, dy * inv_r, dz * inv_r, t.response * slope * r, slope};
}

// Of the lists: the vertices, and the pairs of vertices and fluid

struct VertexWalk {
  const FluidModel &model;
  const DualLists &lists;
  const int *is_vertex;

  // act(j, type) for every owned one
  template <class Act> SPHCLOTH_INLINE void for_vertices(Act act) const
  {
    for (int t = 1; t <= model.n_types; t++)
      if (is_vertex[t])
        for (int slot = lists.begin(t); slot < lists.begin(t + 1); slot++) act(lists.at(slot), t);
  }
  // act(neighbor, terms)
  template <class Act> SPHCLOTH_INLINE void for_fluid_beside(int vertex, int type, Act act) const
  {
    const auto is_fluid = [this](int t) SPHCLOTH_LAMBDA { return model.role[t] == Role::FLUID; };
    for_pairs(vertex, type, is_fluid, act);
  }
  template <class Act> SPHCLOTH_INLINE void for_vertices_beside(int fluid, int type, Act act) const
  {
    for_pairs(fluid, type, [this](int t) SPHCLOTH_LAMBDA { return is_vertex[t] != 0; }, act);
  }

 private:
  template <class IsPartner, class Act>
  SPHCLOTH_INLINE void for_pairs(int of, int type, IsPartner is_partner, Act act) const
  {
    const int slot = lists.slot(of);
    for (const int other : lists.present_types()) {
      if (!is_partner(other)) continue;
      const PairTerms &terms = model.pair(type, other);
      const NeighborSpan near = lists(slot, other);
      for (int k = 0; k < near.n; k++) act(near.of[k], terms);
    }
  }
};

template <class K, class P>
void FluidLoops<K, P>::vertex_stiffness(const Particles &p, const int *is_vertex,
                                        const double *weight, VertexStiffness *of)
{
  const VertexWalk walk{model, lists, is_vertex};
  walk.for_vertices([&](int j, int type) SPHCLOTH_LAMBDA {
    VertexStiffness v;
    walk.for_fluid_beside(j, type, [&](int i, const PairTerms &t) SPHCLOTH_LAMBDA {
      const Press s = press<K>(p, i, j, t);
      v.friction += t.friction_rate() * p.mass_or_volume[i] * s.slope / p.rho[i];
      v.add(weight[i] * s.size, s.x, s.y, s.z);
    });
    of[j] = v;
  });
}

template <class K, class P>
void FluidLoops<K, P>::vertex_rows(const Particles &p, const int *is_vertex,
                                   const VertexStiffness *vertices, bool scaled, VertexRow *of)
{
  const VertexWalk walk{model, lists, is_vertex};
  for_active_fluid([&](int i, int type) SPHCLOTH_LAMBDA {
    VertexRow row;
    walk.for_vertices_beside(i, type, [&](int j, const PairTerms &t) SPHCLOTH_LAMBDA {
      const Press s = press<K>(p, i, j, t);
      if (s.slope == 0.0) return;
      const VertexStiffness &v = vertices[j];
      if (!scaled) row.sum += s.size * std::sqrt(v.trace() * v.along(s.x, s.y, s.z));
      row.friction = std::max(row.friction, v.friction);
    });
    of[i] = row;
  });
}

template <class K, class P>
void FluidLoops<K, P>::vertex_gradients(const Particles &p, const int *is_vertex,
                                        VertexGradients *of)
{
  const VertexWalk walk{model, lists, is_vertex};
  for_active_fluid([&](int i, int type) SPHCLOTH_LAMBDA {
    VertexGradients sums;
    walk.for_vertices_beside(i, type, [&](int j, const PairTerms &t) SPHCLOTH_LAMBDA {
      const Press s = press<K>(p, i, j, t);
      sums.add(p.mass_or_volume[j] * std::fabs(s.size), s.x, s.y, s.z);
    });
    of[i] = sums;
  });
}

template <class K, class P>
void FluidLoops<K, P>::vertex_pairs(const Particles &p, const int *is_vertex,
                                    const double *strength, const double *normals,
                                    VertexPairs &pairs)
{
  const VertexWalk walk{model, lists, is_vertex};
  pairs.clear();
  walk.for_vertices([&](int j, int type) SPHCLOTH_LAMBDA {
    walk.for_fluid_beside(j, type, [&](int i, const PairTerms &t) SPHCLOTH_LAMBDA {
      if (!(strength[i] > 0.0)) return;
      const Press s = press<K>(p, i, j, t);
      const double stiffness = strength[i] * p.mass_or_volume[j] * std::fabs(s.size);
      if (!(stiffness > 0.0)) return;
      const double *u = p.v + 3 * i, *v = p.v + 3 * j, *n = normals + 3 * i;
      const double motion[3] = {u[0] - v[0], u[1] - v[1], u[2] - v[2]};
      const double met = along_and_across({s.x, s.y, s.z}, n, motion);
      pairs.add({i, s.x, s.y, s.z, stiffness, met});
    });
    pairs.end_vertex(j);
  });
}

}    // namespace sphcloth

#endif
