// SPDX-License-Identifier: GPL-2.0-or-later
// Opens lanes between ranks of one node.

#include "lammps_util/node_lanes.h"

#include "comm.h"

#include <array>
#include <cstdlib>
#include <numeric>
#include <string>
#include <utility>

#ifdef __linux__
#include <sched.h>
#endif

using namespace LAMMPS_NS;
using sphcloth::SharedLane;

// that one of these ranks may run on; 0: unknown

static int cores_of(MPI_Comm ranks)
{
  int n = 0;
#ifdef __linux__
  cpu_set_t mine, all;
  CPU_ZERO(&mine);
  sched_getaffinity(0, sizeof(mine), &mine);
  MPI_Allreduce(&mine, &all, static_cast<int>(sizeof(mine)), MPI_BYTE, MPI_BOR, ranks);
  n = CPU_COUNT(&all);
#endif
  return n;
}

void NodeLanes::find_node()
{
  searched = true;
  shares.assign(comm->nprocs, false);
  if (comm->nprocs == 1) return;
  MPI_Comm node;
  MPI_Comm_split_type(world, MPI_COMM_TYPE_SHARED, comm->me, MPI_INFO_NULL, &node);
  MPI_Group here, all;
  MPI_Comm_group(node, &here);
  MPI_Comm_group(world, &all);
  int n;
  MPI_Group_size(here, &n);
  if (const int cores = cores_of(node); cores > 0 && n > cores) wait = SharedLane::Wait::ASLEEP;
  std::vector<int> of_node(n), ranks(n);
  std::iota(of_node.begin(), of_node.end(), 0);
  MPI_Group_translate_ranks(here, n, of_node.data(), all, ranks.data());
  for (const int rank : ranks) shares[rank] = rank != comm->me;
  MPI_Group_free(&here);
  MPI_Group_free(&all);
  MPI_Comm_free(&node);
}

void NodeLanes::connect(const std::map<int, std::size_t> &needs)
{
  constexpr std::size_t SPARE = 2;    // of what is needed
  if (!searched) find_node();
  std::vector<int> too_short;
  for (const auto &[rank, need] : needs) {
    if (!shares[rank] || need <= pairs[rank].capacity) continue;
    pairs[rank].capacity = SPARE * need;
    too_short.push_back(rank);
  }
  open_lanes(too_short);
}

void NodeLanes::open_lanes(const std::vector<int> &ranks)
{
  constexpr int NAME = 64;    // characters
  const char *said = std::getenv("SPHCLOTH_SHARED_MEMORY");
  const bool refused = said && std::string(said) == "no";
  const std::size_t n = ranks.size();
  std::vector<std::array<char, NAME>> my_names(n), names(n);
  std::vector<int> opened(n), they_opened(n);
  std::vector<MPI_Request> requests(2 * n);
  const auto exchange = [&](auto send, auto receive, int count, MPI_Datatype type) {
    for (std::size_t k = 0; k < n; k++) {
      MPI_Irecv(receive(k), count, type, ranks[k], 0, world, &requests[2 * k]);
      MPI_Isend(send(k), count, type, ranks[k], 0, world, &requests[2 * k + 1]);
    }
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  };

  for (std::size_t k = 0; k < n; k++) {
    Pair &pair = pairs[ranks[k]];
    End &out = pair.out;
    out.lane.reset();
    out.memory = refused ? SharedMemory()
                         : SharedMemory::create(SharedLane::size_of(pair.capacity));
    if (out.memory.is_open()) SharedLane::prepare(out.memory.address());
    my_names[k].fill('\0');
    out.memory.name().copy(my_names[k].data(), NAME - 1);
  }
  exchange([&](std::size_t k) { return my_names[k].data(); },
           [&](std::size_t k) { return names[k].data(); }, NAME, MPI_CHAR);
  for (std::size_t k = 0; k < n; k++) {
    Pair &pair = pairs[ranks[k]];
    const bool is_named = names[k][0] != '\0' && !refused;
    const std::size_t size = SharedLane::size_of(pair.capacity);
    begin_lane(pair.in, is_named ? SharedMemory::open(names[k].data(), size) : SharedMemory(),
               pair.capacity);
    opened[k] = pair.in.memory.is_open();
  }
  exchange([&](std::size_t k) { return &opened[k]; },
           [&](std::size_t k) { return &they_opened[k]; }, 1, MPI_INT);
  for (std::size_t k = 0; k < n; k++) {
    Pair &pair = pairs[ranks[k]];
    pair.out.memory.forget_name();
    begin_lane(pair.out, they_opened[k] ? std::move(pair.out.memory) : SharedMemory(),
               pair.capacity);
  }
}

void NodeLanes::begin_lane(End &end, SharedMemory shared, std::size_t capacity) const
{
  end.lane.reset();
  end.memory = std::move(shared);
  if (end.memory.is_open()) end.lane.emplace(end.memory.address(), capacity, wait);
}

SharedLane *NodeLanes::lane_of(int rank, End Pair::*which)
{
  const auto pair = pairs.find(rank);
  if (pair == pairs.end()) return nullptr;
  std::optional<SharedLane> &lane = (pair->second.*which).lane;
  return lane ? &*lane : nullptr;
}

double NodeLanes::bytes() const
{
  double sum = 0.0;
  for (const auto &[rank, pair] : pairs)
    sum += static_cast<double>(pair.out.memory.bytes() + pair.in.memory.bytes());
  return sum;
}
