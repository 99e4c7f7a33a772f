// SPDX-License-Identifier: GPL-2.0-or-later
// Closed meshes on MPI ranks as chambers of a gas, each the triangles of a group that hang
// together: their volumes by Gauss's theorem, and how those change with their vertices.
//
// Of a closed mesh dV/dx of a vertex is a third of the area vectors of its triangles, and the sum
// over all vertices is zero: a pressure pushes no chamber as a whole.

#ifndef SPHCLOTH_CLOTH_GAS_CHAMBERS_H
#define SPHCLOTH_CLOTH_GAS_CHAMBERS_H

#include "cloth/cloth_topology.h"
#include "core/geometry/oriented_surface.h"
#include "lammps_util/ghost_reach.h"
#include "pointers.h"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class GasChambers : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  // Where the volume of a chamber is measured from, and on which side of its triangles the gas is:
  // 1 where they turn outward, or -1.  Plain, for restart files.
  struct Frame {
    double origin[3], side;
  };
  struct Options {
    bool needs_volume = false;    // chambers must be closed
    bool closes_holes = false;    // by fans of triangles from the middle of each, with a warning
    Vec3 toward = Vec3::Zero();    // to which side gas pushes an open mesh; 0: where triangles turn
  };

  // owner: the style that asks, for messages
  GasChambers(LAMMPS *lmp_, const std::string &owner_, const Options &options_) :
      Pointers(lmp_), owner(owner_), options(options_), mesh(lmp_, owner_), ghosts(lmp_, owner_)
  {
  }

  // Collective: finds the chambers; warns: of holes that are closed
  void gather(int groupbit, bool warns);
  void require_ghosts();    // from init()
  void require_ghosts_in_run();    // from pre_exchange()
  // this rank's part, after each list build; masses are those of then
  void collect(const std::function<double(int)> &inverse_mass);

  int count() const { return static_cast<int>(frames.size()); }
  tagint first_id(int chamber) const { return mesh.ids[surface.first[chamber]]; }
  bool any_open() const { return !surface.holes.empty(); }
  const std::vector<Frame> &new_frames() const { return frames; }    // of where vertices are now

  struct Volume {
    double value, rate;    // the latter by the velocities of the vertices
    double mobility;    // sum of |dV/dx|^2 / m over the vertices that move
  };
  // collective
  std::vector<Volume> measure(const std::vector<Frame> &);
  // those of where vertices were then, by the velocities that they have now
  std::vector<double> rates() const;
  // forces on the vertices, after measure(), each the gradient of a volume times this
  void push(const std::vector<double> &by_chamber) const;
  double bytes() const;

 private:
  struct Triangle {
    int atom[3];    // the first is owned, the others are its nearest images
    int slot[3];    // -1: owned by another rank
    int chamber;
    const std::array<int, 3> *shift;    // of the first one
    double offset[3];    // from where it is to where the surface is, unless the box changes
    bool counted;    // here, and by no other rank
  };
  struct Slot {    // of a vertex that this rank owns, in a chamber
    int chamber, atom;
    double inverse_mass;
  };
  using Member = std::array<int, 2>;    // a chamber, and a vertex of it
  // The direction in which a chamber hangs together with its periodic images, if any
  struct Wrap {
    std::array<int, 3> along{};
    bool several = false;
    bool any() const { return along[0] || along[1] || along[2]; }
  };

  const std::string owner;
  const Options &options;
  ClothTopology mesh;
  GhostReach ghosts;
  sphcloth::OrientedSurface surface{{}};
  std::vector<std::array<int, 3>> shifts;    // of each vertex, in periods of the box
  std::vector<Wrap> wraps;    // of each chamber
  std::vector<Frame> frames;
  std::vector<Member> members;    // ascending
  std::vector<std::array<int, 3>> corners;    // members of each triangle
  std::vector<int> lid_slots;    // of the vertices of all holes, where they are closed

  std::vector<Triangle> triangles;
  std::vector<Slot> slots;    // in the order of members, whatever that of the atoms: sums have it
  std::vector<int> slot_of_member;    // -1: owned by another rank
  std::vector<Vec3> gradient;    // of each slot

  void check_surface(bool warns) const;
  std::string holes_in_words(int chamber) const;
  std::vector<Vec3> unwrapped() const;
  void unwrap(std::vector<Vec3> &);
  void find_frames(const std::vector<Vec3> &);
  Vec3 lattice(const std::array<int, 3> &) const;
  Vec3 position(int atom, const std::array<int, 3> &shift) const;
  int owned(int vertex) const;
  void find_members();
  int member(int chamber, int vertex) const;
  double add_triangle(const Triangle &, const Frame &, const Vec3 &wrap);
  void add_lids(const std::vector<Frame> &, double *volumes);
};

}    // namespace LAMMPS_NS

#endif
