// SPDX-License-Identifier: GPL-2.0-or-later
// Counts what a program sends through MPI: preloaded before it, by `sphcloth bench messages`.
//
// Every call is passed on to MPI's profiling interface.  When MPI ends, each rank writes one line
// of numbers to the file that SPHCLOTH_MESSAGES names, with its rank behind the name: messages,
// their bytes, collective calls, the bytes that this rank contributes to them. A message of a rank
// to itself counts as none.

#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

struct Count {
  long long calls = 0, bytes = 0;

  void add(int n, MPI_Datatype type)
  {
    int size = 0;
    PMPI_Type_size(type, &size);
    calls++;
    bytes += static_cast<long long>(n) * size;
  }
};

Count messages, collectives;

void note_message(int n, MPI_Datatype type, int to, MPI_Comm comm)
{
  int me = 0;
  PMPI_Comm_rank(comm, &me);
  if (to != me && to != MPI_PROC_NULL) messages.add(n, type);
}

void report()
{
  const char *file = std::getenv("SPHCLOTH_MESSAGES");
  if (!file) return;
  int me = 0;
  PMPI_Comm_rank(MPI_COMM_WORLD, &me);
  FILE *out = std::fopen((std::string(file) + "." + std::to_string(me)).c_str(), "w");
  if (!out) return;
  std::fprintf(out, "%lld %lld %lld %lld\n", messages.calls, messages.bytes, collectives.calls,
               collectives.bytes);
  std::fclose(out);
}

}    // namespace

extern "C" {

int MPI_Send(const void *buf, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm)
{
  note_message(n, type, to, comm);
  return PMPI_Send(buf, n, type, to, tag, comm);
}

int MPI_Rsend(const void *buf, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm)
{
  note_message(n, type, to, comm);
  return PMPI_Rsend(buf, n, type, to, tag, comm);
}

int MPI_Isend(const void *buf, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm,
              MPI_Request *request)
{
  note_message(n, type, to, comm);
  return PMPI_Isend(buf, n, type, to, tag, comm, request);
}

int MPI_Sendrecv(const void *buf, int n, MPI_Datatype type, int to, int tag, void *into,
                 int max_count, MPI_Datatype type_in, int from, int tag_in, MPI_Comm comm,
                 MPI_Status *status)
{
  note_message(n, type, to, comm);
  return PMPI_Sendrecv(buf, n, type, to, tag, into, max_count, type_in, from, tag_in, comm, status);
}

int MPI_Allreduce(const void *buf, void *into, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm)
{
  collectives.add(n, type);
  return PMPI_Allreduce(buf, into, n, type, op, comm);
}

int MPI_Reduce(const void *buf, void *into, int n, MPI_Datatype type, MPI_Op op, int root,
               MPI_Comm comm)
{
  collectives.add(n, type);
  return PMPI_Reduce(buf, into, n, type, op, root, comm);
}

int MPI_Reduce_scatter(const void *buf, void *into, const int *n, MPI_Datatype type, MPI_Op op,
                       MPI_Comm comm)
{
  int size = 0, all = 0;
  PMPI_Comm_size(comm, &size);
  for (int k = 0; k < size; k++) all += n[k];
  collectives.add(all, type);
  return PMPI_Reduce_scatter(buf, into, n, type, op, comm);
}

int MPI_Scan(const void *buf, void *into, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm)
{
  collectives.add(n, type);
  return PMPI_Scan(buf, into, n, type, op, comm);
}

int MPI_Bcast(void *buf, int n, MPI_Datatype type, int root, MPI_Comm comm)
{
  collectives.add(n, type);
  return PMPI_Bcast(buf, n, type, root, comm);
}

int MPI_Allgather(const void *buf, int n, MPI_Datatype type, void *into, int each,
                  MPI_Datatype type_in, MPI_Comm comm)
{
  collectives.add(n, type);
  return PMPI_Allgather(buf, n, type, into, each, type_in, comm);
}

int MPI_Allgatherv(const void *buf, int n, MPI_Datatype type, void *into, const int *each,
                   const int *at, MPI_Datatype type_in, MPI_Comm comm)
{
  collectives.add(n, type);
  return PMPI_Allgatherv(buf, n, type, into, each, at, type_in, comm);
}

int MPI_Alltoall(const void *buf, int n, MPI_Datatype type, void *into, int each,
                 MPI_Datatype type_in, MPI_Comm comm)
{
  int size = 0;
  PMPI_Comm_size(comm, &size);
  collectives.add(n * size, type);
  return PMPI_Alltoall(buf, n, type, into, each, type_in, comm);
}

int MPI_Barrier(MPI_Comm comm)
{
  collectives.add(0, MPI_BYTE);
  return PMPI_Barrier(comm);
}

int MPI_Finalize()
{
  report();
  return PMPI_Finalize();
}

}    // extern "C"
