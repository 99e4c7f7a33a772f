// SPDX-License-Identifier: GPL-2.0-or-later
// The fastest motions that the fluid of an evaluation can make, particle by particle, from which
// the longest stable step follows: core/sph/stiffness.h.

#ifndef SPHCLOTH_FLUID_FLUID_STABILITY_H
#define SPHCLOTH_FLUID_FLUID_STABILITY_H

#include "pointers.h"

#include "core/sph/fluid.h"
#include "core/sph/lattice_modes.h"

#include <functional>
#include <vector>

namespace LAMMPS_NS {

class FluidBoundary;
class FluidLattices;
class FreeSurface;
class SPHMaterials;
class VertexMobility;

// Of an owned fluid particle, as if it were under pressure: squares of the largest frequencies that
// it may have a part in, with the fluid around and with vertices; and the largest rate at which
// friction slows what it has a part in.

struct Frequencies {
  double fluid_sq = 0.0, vertices_sq = 0.0, friction = 0.0;
};

class FluidStability : protected Pointers {
 public:
  static constexpr int GHOST_SIZE = 7;    // numbers of a vertex
  // Fluid in free flight that will be under pressure after as many steps counts as if it were.
  static constexpr double STEPS_AHEAD = 8.0;

  FluidStability(class LAMMPS *lmp_, const SPHMaterials &materials_,
                 const FluidLattices &of_fluids_, const FreeSurface &surface_) :
      Pointers(lmp_), materials(materials_), of_fluids(of_fluids_), surface(surface_)
  {
  }

  // anew for each run; null: no step follows from it
  void forget()
  {
    mobility = nullptr;
    now = true;
    with_shares = false;
  }
  void want(const VertexMobility *of_vertices);
  // whether free flight of neighbors counts, in the evaluations that come next; where all particles
  // are active
  void want_shares(bool whether) { with_shares = whether; }
  bool knows_flight() const { return with_shares; }
  // in the evaluations that come next
  void want_now(bool whether) { now = whether; }
  bool wanted() const { return mobility && now; }
  // of the lattice of a fluid of such particles
  const sphcloth::LatticeModes &modes(int type, double mass);
  // its bend, if wanted
  std::function<double(int, double)> bend_of_lattice()
  {
    if (!wanted()) return {};
    return [this](int type, double mass) { return modes(type, mass).bend; };
  }
  // is any vertex a boundary particle, on any rank?
  bool any_vertices() const { return has_vertices; }
  // Boundary types that have such vertices, [ntypes + 1], once this has been called in an
  // evaluation; collective
  const std::vector<int> &vertex_types()
  {
    if (new_lists) begin_lists();
    return is_vertex;
  }

  void lists_have_changed() { new_lists = true; }
  // Whether fluid is under pressure, or how far it soon is, if that counts: then ghosts have to get
  // it.
  bool find_shares(const sphcloth::Fluid &);
  // Of the active fluid but for those that wait, by atom a number above 0; null: none does.  Then,
  // collective: is a vertex near one of them, on any rank?  If so, of vertices.
  void find_fluid(sphcloth::Fluid &, const sphcloth::Particles &,
                  const std::vector<FluidBoundary *> &, const double *waits);
  bool need_vertices(sphcloth::Fluid &, const sphcloth::Particles &,
                     const std::vector<FluidBoundary *> &, const double *waits);
  void find_vertices(sphcloth::Fluid &, const sphcloth::Particles &,
                     const std::vector<FluidBoundary *> &);
  // Ghosts of vertices have their numbers, unless there are none near; of those that are scaled
  // friction alone counts.
  void find_rows(sphcloth::Fluid &, const sphcloth::Particles &,
                 const std::vector<FluidBoundary *> &, bool scaled);
  const sphcloth::Selection &found_now() const { return due; }
  void set_fluid_sq(int i, double frequency_sq) { found[i].fluid_sq = frequency_sq; }
  // of one that waits, as it was found before
  void set(int i, const Frequencies &before) { found[i] = before; }
  // Is a vertex, as a boundary particle, inside the support of an active one, or a mesh within
  // reach of it?  What a list holds beyond the support depends on the ranks.
  bool is_near_vertices(sphcloth::Fluid &, const sphcloth::Particles &,
                        const std::vector<FluidBoundary *> &, int i) const;

  const Frequencies &operator[](int i) const { return found[i]; }
  double find_sound(int i) const;
  double find_sound(int i, double rho) const;
  double find_sound_under_pressure(int i) const;    // s_k of fluid
  double *pack(int i, double *end) const;    // of a vertex
  const double *unpack(int i, const double *from);
  double share(int i) const { return shares[i]; }
  void set_share(int i, double of_ghost) { shares[i] = of_ghost; }

  double bytes() const;

 private:
  const SPHMaterials &materials;
  const FluidLattices &of_fluids;
  const FreeSurface &surface;
  const VertexMobility *mobility = nullptr;
  bool now = true, with_shares = false;
  bool new_lists = true, has_vertices = false, with_vertices = false;
  sphcloth::Selection due;    // those that do not wait
  std::vector<int> is_vertex;    // [ntypes + 1]
  std::vector<double> sounds;    // s_k, of all atoms, where vertices are particles
  std::vector<double> shares;    // of all atoms, of fluid
  std::vector<sphcloth::Stiffness> stiffness;
  std::vector<sphcloth::VertexStiffness> vertices;    // of all atoms
  std::vector<sphcloth::VertexRow> rows;
  std::vector<Frequencies> found;
  struct Lattice {    // the last one that was asked for, of a type
    double mass = 0.0;
    sphcloth::LatticeModes modes;
  };
  std::vector<Lattice> lattices;

  void begin_lists();
  double find_share(int i) const;
};

}    // namespace LAMMPS_NS

#endif
