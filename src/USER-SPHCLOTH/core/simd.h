// SIMD multiversioning: one portable binary, the widest vectors that the running CPU has.

#ifndef SPHCLOTH_CORE_SIMD_H
#define SPHCLOTH_CORE_SIMD_H

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__) && \
    !defined(SPHCLOTH_SINGLE_TARGET)
#define SPHCLOTH_MULTIVERSION \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define SPHCLOTH_MULTIVERSION
#endif

#include <cstddef>
#include <new>
#include <vector>

namespace sphcloth {

// Vectors that start on a cache line.  A loop over them is cut into SIMD pieces at the same
// places in every run, so that its sums do not depend on where the heap happens to be.

template <class T> struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t LINE{64};

  CacheLineAllocator() = default;
  template <class U> CacheLineAllocator(const CacheLineAllocator<U> &) {}
  T *allocate(std::size_t n) { return static_cast<T *>(::operator new(n * sizeof(T), LINE)); }
  void deallocate(T *p, std::size_t) { ::operator delete(p, LINE); }
  friend bool operator==(const CacheLineAllocator &, const CacheLineAllocator &) { return true; }
  friend bool operator!=(const CacheLineAllocator &, const CacheLineAllocator &) { return false; }
};

template <class T> using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}    // namespace sphcloth

#endif
