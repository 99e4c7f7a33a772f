// SPDX-License-Identifier: GPL-2.0-or-later
// Memory that processes of a machine share, in Linux's /dev/shm.  Elsewhere there is none.

#ifndef SPHCLOTH_LAMMPS_UTIL_SHARED_MEMORY_H
#define SPHCLOTH_LAMMPS_UTIL_SHARED_MEMORY_H

#include <cstddef>
#include <string>

namespace LAMMPS_NS {

class SharedMemory {
 public:
  SharedMemory() = default;
  SharedMemory(SharedMemory &&other) noexcept { *this = static_cast<SharedMemory &&>(other); }
  SharedMemory &operator=(SharedMemory &&) noexcept;
  ~SharedMemory();

  // of so many bytes; not open where the system gives none
  static SharedMemory create(std::size_t bytes);
  // in another process, of the name that it got there
  static SharedMemory open(const std::string &name, std::size_t bytes);

  bool is_open() const { return memory != nullptr; }
  void *address() const { return memory; }
  std::size_t bytes() const { return size; }
  const std::string &name() const { return path; }
  // when all have opened it: it goes with the last of them, however that ends
  void forget_name();

 private:
  void *memory = nullptr;
  std::size_t size = 0;
  std::string path;    // of what was created here

  void map(int file, std::size_t bytes);
};

}    // namespace LAMMPS_NS

#endif
