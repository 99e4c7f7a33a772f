// SPDX-License-Identifier: GPL-2.0-or-later
// Maps files of /dev/shm.

#include "lammps_util/shared_memory.h"

#include <utility>

#ifdef __linux__
#include <atomic>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#endif

using namespace LAMMPS_NS;

SharedMemory &SharedMemory::operator=(SharedMemory &&other) noexcept
{
  std::swap(memory, other.memory);
  std::swap(size, other.size);
  std::swap(path, other.path);
  return *this;
}

#ifdef __linux__

SharedMemory::~SharedMemory()
{
  forget_name();
  if (memory) munmap(memory, size);
}

void SharedMemory::map(int file, std::size_t bytes)
{
  void *at = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (at == MAP_FAILED) return;
  memory = at;
  size = bytes;
}

SharedMemory SharedMemory::create(std::size_t bytes)
{
  static std::atomic<int> count{0};
  SharedMemory created;
  const std::string path =
      "/dev/shm/sphcloth-" + std::to_string(getpid()) + "-" + std::to_string(count++);
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) return created;
  created.path = path;
  // a file system that is full is found here, and not where the memory is written
  if (posix_fallocate(file, 0, static_cast<off_t>(bytes)) == 0) created.map(file, bytes);
  close(file);
  if (!created.is_open()) created.forget_name();
  return created;
}

SharedMemory SharedMemory::open(const std::string &name, std::size_t bytes)
{
  SharedMemory opened;
  const int file = ::open(name.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return opened;
  opened.map(file, bytes);
  close(file);
  return opened;
}

void SharedMemory::forget_name()
{
  if (!path.empty()) unlink(path.c_str());
  path.clear();
}

#else

SharedMemory::~SharedMemory() {}
SharedMemory SharedMemory::create(std::size_t) { return {}; }
SharedMemory SharedMemory::open(const std::string &, std::size_t) { return {}; }
void SharedMemory::forget_name() {}

#endif
