// SPDX-License-Identifier: GPL-2.0-or-later
// Which mutant is active, and which places have been run: included before every source that is
// compiled for `make mutate-random`, and by nothing else.

#ifndef SPHCLOTH_MUTANT_H
#define SPHCLOTH_MUTANT_H

#include <cstddef>
#include <cstdlib>
#include <fcntl.h>
#include <sys/mman.h>
#include <type_traits>
#include <unistd.h>
#include <utility>

namespace sphcloth_mutant {

constexpr int NONE = -1, UNKNOWN = -2, MOST = 4096;
inline int active = UNKNOWN;
inline unsigned char unseen[MOST] = {};
inline unsigned char *reached = unseen;    // one byte per mutant, in a file that all ranks share

__attribute__((noinline)) inline void start()
{
  const char *number = std::getenv("SPHCLOTH_MUTANT");
  active = number ? std::atoi(number) : NONE;
  const char *file = std::getenv("SPHCLOTH_MUTANTS_REACHED");
  const int opened = file ? open(file, O_RDWR) : -1;
  if (opened < 0) return;
  void *map = mmap(nullptr, MOST, PROT_READ | PROT_WRITE, MAP_SHARED, opened, 0);
  if (map != MAP_FAILED) reached = static_cast<unsigned char *>(map);
  close(opened);
}

__attribute__((always_inline)) inline bool at(int number)
{
  if (__builtin_expect(active == UNKNOWN, 0)) start();
  reached[number] = 1;
  return __builtin_expect(number == active, 0);
}

// An expression as a value: both ways to write it have the same type, also where Eigen would give
// a type to each sum.

template <class T>
__attribute__((always_inline)) inline auto evaluated(T &&x, int) -> std::decay_t<decltype(x.eval())>
{
  return x.eval();
}
template <class T> __attribute__((always_inline)) inline std::decay_t<T> evaluated(T &&x, long)
{
  return std::forward<T>(x);
}
template <class T> __attribute__((always_inline)) inline auto value(T &&x)
{
  return evaluated(std::forward<T>(x), 0);
}

}    // namespace sphcloth_mutant

#define SPHCLOTH_CHOICE(number, right, wrong)                           \
  (sphcloth_mutant::at(number) ? sphcloth_mutant::value(wrong)          \
                               : sphcloth_mutant::value(right))

#endif
