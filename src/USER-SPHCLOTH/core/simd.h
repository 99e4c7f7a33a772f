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

#endif
