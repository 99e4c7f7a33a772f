// SPDX-License-Identifier: GPL-2.0-or-later
// Connects the ranks that share a cloth, and sends and adds up the data of their vertices.

#include "cloth/vertex_halo.h"

#include "atom.h"
#include "comm.h"
#include "core/util/bytes.h"
#include "domain.h"
#include "lammps_util/list_guard.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

using namespace LAMMPS_NS;

void VertexHalo::reset(int n_channels, const std::vector<int> &owned_atoms)
{
  owned = static_cast<int>(owned_atoms.size());
  atoms = owned_atoms;
  slot_by_atom.assign(atom->nlocal + atom->nghost, -1);
  for (int s = 0; s < owned; s++) slot_by_atom[atoms[s]] = s;
  asked.assign(n_channels, {});
  channels.assign(n_channels, {});
}

int VertexHalo::slot_of(int atom_index)
{
  int &slot = slot_by_atom[atom_index];
  if (slot < 0) {
    slot = n_slots();
    atoms.push_back(atom_index);
  }
  return slot;
}

void VertexHalo::need(int slot, int channel)
{
  if (is_ghost(slot)) asked[channel].push_back(slot);
}

/* ----------------------------------------------------------------------
   owners of the ghosts, their periodic images, and what is needed of them
------------------------------------------------------------------------- */

void VertexHalo::connect()
{
  const int nlocal = atom->nlocal;
  link_rows.resize(nlocal + atom->nghost);
  link.resize(LINK * link_rows.size());
  for (std::size_t i = 0; i < link_rows.size(); i++) link_rows[i] = &link[LINK * i];
  for (int i = 0; i < nlocal; i++) {
    double *l = link_rows[i];
    l[0] = comm->me;
    l[1] = slot_by_atom[i];
    for (int d = 0; d < 3; d++) l[2 + d] = atom->x[i][d];
  }
  comm->forward_comm_array(LINK, link_rows.data());
  find_images();
  exchange_requests();
  open_lanes();
}

// how many box vectors lie between a ghost and its owner

void VertexHalo::find_images()
{
  image.resize(n_slots() - owned);
  for (int s = owned; s < n_slots(); s++) {
    const double *x = atom->x[atoms[s]], *x_owner = link_rows[atoms[s]] + 2;
    double dx = x[0] - x_owner[0], dy = x[1] - x_owner[1], dz = x[2] - x_owner[2];
    const auto count = [](double distance, double period) {
      return static_cast<int>(std::lround(distance / period));
    };
    std::array<int, 3> &n = image[s - owned];
    n[2] = count(dz, domain->zprd);
    dy -= n[2] * domain->yz;
    dx -= n[2] * domain->xz;
    n[1] = count(dy, domain->yprd);
    dx -= n[1] * domain->xy;
    n[0] = count(dx, domain->xprd);
  }
}

// Images go with the box only where LAMMPS changes the velocity of atoms that cross its faces, too.

VertexHalo::Vec3 VertexHalo::shift(int slot, double vectors, double rates) const
{
  const std::array<int, 3> &n = image[slot - owned];
  const auto between = [&n](const double *h) {
    return Vec3(n[0] * h[0] + n[1] * h[5] + n[2] * h[4], n[1] * h[1] + n[2] * h[3], n[2] * h[2]);
  };
  Vec3 sum = Vec3::Zero();
  if (vectors != 0.0) sum += vectors * between(domain->h);
  if (rates != 0.0 && domain->deform_vremap && atom->mask[atoms[slot]] & domain->deform_groupbit)
    sum += rates * between(domain->h_rate);
  return sum;
}

void VertexHalo::exchange_requests()
{
  const int nprocs = comm->nprocs, me = comm->me, nc = static_cast<int>(channels.size());

  for (std::vector<int> &slots : asked) {
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
  }

  // what I ask of each rank, channel by channel
  std::vector<std::vector<std::vector<int>>> ask(nprocs, std::vector<std::vector<int>>(nc));
  for (int c = 0; c < nc; c++) {
    std::vector<std::vector<int>> mine(nprocs);
    for (int s : asked[c]) {
      const double *l = link_rows[atoms[s]];
      const int rank = static_cast<int>(l[0]);
      mine[rank].push_back(s);
      ask[rank][c].push_back(static_cast<int>(l[1]));
    }
    for (int p = 0; p < nprocs; p++) {
      if (mine[p].empty()) continue;
      if (p == me) {
        channels[c].self_from = ask[p][c];
        channels[c].self_to = mine[p];
      } else
        channels[c].from.push_back(Message{p, std::move(mine[p])});
    }
  }

  // tell them: counts per channel, then the slots
  std::vector<int> send_counts(nprocs * nc, 0), recv_counts(nprocs * nc);
  std::vector<int> send_n(nprocs, 0), recv_n(nprocs, 0), send_at(nprocs, 0), recv_at(nprocs, 0);
  std::vector<int> send_slots;
  for (int p = 0; p < nprocs; p++) {
    send_at[p] = static_cast<int>(send_slots.size());
    if (p == me) continue;
    for (int c = 0; c < nc; c++) {
      send_counts[p * nc + c] = static_cast<int>(ask[p][c].size());
      send_slots.insert(send_slots.end(), ask[p][c].begin(), ask[p][c].end());
    }
    send_n[p] = static_cast<int>(send_slots.size()) - send_at[p];
  }
  MPI_Alltoall(send_counts.data(), nc, MPI_INT, recv_counts.data(), nc, MPI_INT, world);
  for (int p = 0; p < nprocs; p++)
    recv_n[p] = std::accumulate(&recv_counts[p * nc], &recv_counts[p * nc] + nc, 0);
  std::partial_sum(recv_n.begin(), recv_n.end() - 1, recv_at.begin() + 1);
  std::vector<int> recv_slots(recv_at.back() + recv_n.back());
  MPI_Alltoallv(send_slots.data(), send_n.data(), send_at.data(), MPI_INT, recv_slots.data(),
                recv_n.data(), recv_at.data(), MPI_INT, world);

  const int *next = recv_slots.data();
  for (int p = 0; p < nprocs; p++)
    for (int c = 0; c < nc; c++) {
      const int n = recv_counts[p * nc + c];
      if (n) channels[c].to.push_back(Message{p, std::vector<int>(next, next + n)});
      next += n;
    }
}

// What goes one way forward goes the other way back.

void VertexHalo::open_lanes()
{
  std::map<int, std::size_t> needs;
  for (const Channel &c : channels)
    for (const std::vector<Message> *messages : {&c.from, &c.to})
      for (const Message &m : *messages)
        needs[m.rank] = std::max(needs[m.rank], 3 * m.slots.size());
  lanes.connect(needs);
  for (Channel &c : channels)
    for (std::vector<Message> *messages : {&c.from, &c.to})
      for (Message &m : *messages) {
        m.to = lanes.to(m.rank);
        m.from = lanes.from(m.rank);
      }
}

/* ---------------------------------------------------------------------- */

static Eigen::Vector3d vector_of(const Eigen::Vector3d &data) { return data; }
static Eigen::Vector3d vector_of(const sphcloth::Vertex &data) { return {data.x, data.y, data.z}; }

static void put(Eigen::Vector3d &data, const Eigen::Vector3d &value) { data = value; }
static void put(sphcloth::Vertex &data, const Eigen::Vector3d &value)
{
  data.x = value[0];
  data.y = value[1];
  data.z = value[2];
}

// There are channels from the first list build on.

VertexHalo::Channel &VertexHalo::connected(int channel)
{
  if (channels.empty()) error->all(FLERR, "fix pbd/cloth: {}", ListGuard::REMEDY);
  return channels[channel];
}

void VertexHalo::add_to_images(int channel, Vec3 *data, double vectors, double rates)
{
  forward_all(channel, data, vectors, rates);
}

void VertexHalo::add_to_images(int channel, sphcloth::Vertex *data, double vectors, double rates)
{
  forward_all(channel, data, vectors, rates);
}

template <class Data>
void VertexHalo::forward_all(int channel, Data *data, double vectors, double rates)
{
  Channel &c = connected(channel);
  const auto store = [&](int ghost, const Vec3 &value) {
    put(data[ghost], Vec3(value + shift(ghost, vectors, rates)));
  };
  transfer(c, false, data, store);
  for (std::size_t k = 0; k < c.self_to.size(); k++)
    store(c.self_to[k], vector_of(data[c.self_from[k]]));
}

void VertexHalo::forward(int channel, std::vector<double> &data)
{
  scalars.resize(n_slots());
  for (int s = 0; s < n_slots(); s++) scalars[s][0] = data[s];
  forward(channel, scalars.data());
  for (int s = owned; s < n_slots(); s++) data[s] = scalars[s][0];
}

void VertexHalo::reverse_add(int channel, Vec3 *data)
{
  Channel &c = connected(channel);
  transfer(c, true, data, [&](int slot, const Vec3 &value) { data[slot] += value; });
  for (std::size_t k = 0; k < c.self_to.size(); k++) data[c.self_from[k]] += data[c.self_to[k]];
}

template <class Data, class Store>
void VertexHalo::transfer(Channel &c, bool reverse, const Data *data, Store store)
{
  std::vector<Message> &in = receivers(c, reverse), &out = senders(c, reverse);
  std::size_t n_in = 0, n_out = 0;
  for (const Message &m : in) n_in += m.slots.size();
  for (const Message &m : out) n_out += m.slots.size();
  buffer.resize(n_in + n_out);
  requests.clear();

  std::size_t at = 0;
  for (const Message &m : in) {
    if (!m.from) {
      requests.emplace_back();
      MPI_Irecv(buffer[at].data(), static_cast<int>(3 * m.slots.size()), MPI_DOUBLE, m.rank, 0,
                world, &requests.back());
    }
    at += m.slots.size();
  }
  for (const Message &m : out) {
    if (m.to) {
      Eigen::Map<Eigen::Matrix3Xd> lane(m.to->begin_write(), 3, m.slots.size());
      for (std::size_t k = 0; k < m.slots.size(); k++) lane.col(k) = vector_of(data[m.slots[k]]);
      m.to->end_write();
    } else {
      for (std::size_t k = 0; k < m.slots.size(); k++) buffer[at + k] = vector_of(data[m.slots[k]]);
      requests.emplace_back();
      MPI_Isend(buffer[at].data(), static_cast<int>(3 * m.slots.size()), MPI_DOUBLE, m.rank, 0,
                world, &requests.back());
    }
    at += m.slots.size();
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);

  // in the order of ranks, whatever way they take
  at = 0;
  for (const Message &m : in) {
    if (m.from) {
      const Eigen::Map<const Eigen::Matrix3Xd> lane(m.from->begin_read(), 3, m.slots.size());
      for (std::size_t k = 0; k < m.slots.size(); k++) store(m.slots[k], lane.col(k));
      m.from->end_read();
    } else
      for (std::size_t k = 0; k < m.slots.size(); k++) store(m.slots[k], buffer[at + k]);
    at += m.slots.size();
  }
}

double VertexHalo::memory_usage() const
{
  return sphcloth::bytes_of(atoms, slot_by_atom, link, buffer) + lanes.bytes();
}
