// SPDX-License-Identifier: GPL-2.0-or-later
// A rank's vertices of a cloth in one compact numbering, and the exchange of their data.
//
// Slots 0 .. n_owned-1 are owned vertices, the slots behind are those ghost images that the rank
// asked for.  Data travels in channels: a channel forwards only the vertices that were asked for
// in it, so that one color of constraints costs one small message per neighboring rank.
// Comm::forward_comm() would send all ghosts for each color, the fluid among them.

#ifndef SPHCLOTH_CLOTH_VERTEX_HALO_H
#define SPHCLOTH_CLOTH_VERTEX_HALO_H

#include "core/pbd/cloth_solver.h"
#include "lammps_util/node_lanes.h"
#include "pointers.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace LAMMPS_NS {

class VertexHalo : protected Pointers {
 public:
  using Vec3 = Eigen::Vector3d;

  explicit VertexHalo(LAMMPS *lmp_) : Pointers(lmp_), lanes(lmp_) {}

  // 1. start anew after a list build, with the owned vertices
  void reset(int n_channels, const std::vector<int> &owned_atoms);

  // 2. ask: the slot of an atom index (a new one for a ghost that has none), and the channels in
  // which it must be kept current
  int slot_of(int atom_index);
  void need(int slot, int channel);

  // 3. collective: tell the owners
  void connect();

  int n_owned() const { return owned; }
  int n_slots() const { return static_cast<int>(atoms.size()); }
  int atom_of(int slot) const { return atoms[slot]; }
  bool is_ghost(int slot) const { return slot >= owned; }

  // Owners to ghosts: what is the same for all images, and what is not.  Positions get the box
  // vectors between owner and image, as they were `ago`; displacements in a time get how far these
  // moved, velocities how fast they do.
  void forward(int channel, Vec3 *data) { add_to_images(channel, data, 0.0, 0.0); }
  void forward(int channel, std::vector<double> &data);
  template <class Data> void forward_positions(int channel, Data *data, double ago = 0.0)
  {
    add_to_images(channel, data, 1.0, -ago);
  }
  template <class Data> void forward_displacements(int channel, Data *data, double dt)
  {
    add_to_images(channel, data, 0.0, dt);
  }
  template <class Data> void forward_velocities(int channel, Data *data)
  {
    add_to_images(channel, data, 0.0, 1.0);
  }
  // sums of ghosts to owners; the ghosts' own entries stay
  void reverse_add(int channel, Vec3 *data);

  double memory_usage() const;

 private:
  struct Message {    // with one other rank, in one channel
    int rank;
    std::vector<int> slots;
    sphcloth::SharedLane *to = nullptr, *from = nullptr;    // of ranks that share memory
  };
  struct Channel {
    std::vector<Message> from, to;    // ghosts filled here, owned vertices sent
    std::vector<int> self_from, self_to;    // images of this rank's own vertices
  };

  int owned = 0;
  std::vector<int> atoms;    // atom index of a slot
  std::vector<int> slot_by_atom;    // -1: none
  std::vector<std::vector<int>> asked;    // ghost slots by channel
  std::vector<std::array<int, 3>> image;    // of a ghost slot, by slot - owned
  static constexpr int LINK = 5;
  std::vector<double> link;    // of each atom, ghosts have that of their owner: rank, slot, x, y, z
  std::vector<double *> link_rows;
  std::vector<Channel> channels;
  NodeLanes lanes;
  std::vector<Vec3> buffer, scalars;
  std::vector<MPI_Request> requests;

  Channel &connected(int channel);
  void find_images();
  void exchange_requests();
  void open_lanes();
  Vec3 shift(int slot, double vectors, double rates) const;
  std::vector<Message> &receivers(Channel &c, bool reverse) { return reverse ? c.to : c.from; }
  std::vector<Message> &senders(Channel &c, bool reverse) { return reverse ? c.from : c.to; }
  // box vectors, and their rates of change, times these; of vertices x, y and z
  void add_to_images(int channel, Vec3 *, double vectors, double rates);
  void add_to_images(int channel, sphcloth::Vertex *, double vectors, double rates);
  template <class Data> void forward_all(int channel, Data *, double vectors, double rates);
  template <class Data, class Store> void transfer(Channel &, bool reverse, const Data *, Store);
};

}    // namespace LAMMPS_NS

#endif
