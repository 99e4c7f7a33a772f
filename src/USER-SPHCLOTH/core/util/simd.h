// SPDX-License-Identifier: GPL-2.0-or-later
// SIMD: one portable binary, the widest vectors that the running CPU has.
//
// Loops are plain `omp simd` loops over contiguous columns, compiled several times by
// SPHCLOTH_MULTIVERSION.  Only what no compiler vectorizes is written by hand: records of scattered
// particles turned into columns (hardware gathers are several times slower), and the compaction of
// a list to the entries that pass a test.

#ifndef SPHCLOTH_CORE_UTIL_SIMD_H
#define SPHCLOTH_CORE_UTIL_SIMD_H

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <type_traits>
#include <vector>

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__) && \
    !defined(SPHCLOTH_SINGLE_TARGET)
#define SPHCLOTH_X86_TARGETS
#define SPHCLOTH_MULTIVERSION \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#include <immintrin.h>
#else
#define SPHCLOTH_MULTIVERSION
#endif

// vectors of rows, on any processor
#ifdef __has_builtin
#if __has_builtin(__builtin_shufflevector)
#define SPHCLOTH_SHUFFLES
#endif
#endif

#if defined(__GNUC__)
#define SPHCLOTH_INLINE inline __attribute__((always_inline))
#define SPHCLOTH_LAMBDA __attribute__((always_inline))    // behind the parameters of a lambda
#else
#define SPHCLOTH_INLINE inline
#define SPHCLOTH_LAMBDA
#endif

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

// all lines of a record, which is read soon

template <class Record> void prefetch(const Record &record)
{
#if defined(__GNUC__)
  const char *const at = reinterpret_cast<const char *>(&record);
  for (std::size_t k = 0; k < sizeof(Record); k += 64) __builtin_prefetch(at + k);
#else
  (void) record;
#endif
}

template <class Vector> void give_back(Vector &v) { Vector().swap(v); }

// Loops run over whole groups; what lies past the end must be readable and is ignored.

inline constexpr int LANES = 8;
inline constexpr int whole_groups(int n) { return (n + LANES - 1) / LANES * LANES; }

// A sum kept lane by lane, so that a loop over whole groups adds to it without a reduction

template <int N> struct LaneSum {
  static_assert(N == 4 || N == 8);
  alignas(64) double of[N] = {};
  double total() const
  {
    double sum[4];
    for (int k = 0; k < 4; k++) sum[k] = N == 8 ? of[k] + of[k + N - 4] : of[k];
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
  }
};

// How many records become columns at a time: as many as fill 32 bytes, a vector that most CPUs have

template <class Lane> inline constexpr int GROUP = 32 / sizeof(Lane);

// Columns of GROUP records of four lanes: x[k], y[k], z[k], w[k] are the lanes of record index[k].
// The last lane of a record may be of another type than the first three, or is left out if w is
// null; then records may lie three lanes apart, if there is room for one lane behind the last.

template <int APART = 4, class Lane, class Last>
SPHCLOTH_INLINE void columns(const Lane *records, const int *index, Lane *x, Lane *y, Lane *z,
                             Last *w)
{
  static_assert(sizeof(Lane) == sizeof(Last));
  const auto record = [&](int k) {
    return records + APART * static_cast<std::ptrdiff_t>(index[k]);
  };
#ifdef SPHCLOTH_X86_TARGETS
  // written in whole vectors: a load that spans two recent stores would wait for both
  typedef __int128 Half __attribute__((aligned(sizeof(Lane)), may_alias));
  typedef __int128 Halves __attribute__((vector_size(32)));
  // also of integers: shuffles of numbers have more units that can do them
  using Number = std::conditional_t<sizeof(Lane) == 4, float, double>;
  typedef Number Group __attribute__((vector_size(32), aligned(sizeof(Lane)), may_alias));
  // as two integers: the form of which GCC makes one load and one insertion
  const auto both = [&](Group &g, int k, int l, int first) {
    g = reinterpret_cast<Group>(Halves{*reinterpret_cast<const Half *>(record(k) + first),
                                       *reinterpret_cast<const Half *>(record(l) + first)});
  };
  const auto put = [](auto *column, const Group &g) { *reinterpret_cast<Group *>(column) = g; };
  if constexpr (sizeof(Lane) == 4) {
    Group r[4];
    for (int k = 0; k < 4; k++) both(r[k], k, k + 4, 0);
    const Group xy01 = __builtin_shufflevector(r[0], r[1], 0, 8, 1, 9, 4, 12, 5, 13);
    const Group xy23 = __builtin_shufflevector(r[2], r[3], 0, 8, 1, 9, 4, 12, 5, 13);
    const Group zw01 = __builtin_shufflevector(r[0], r[1], 2, 10, 3, 11, 6, 14, 7, 15);
    const Group zw23 = __builtin_shufflevector(r[2], r[3], 2, 10, 3, 11, 6, 14, 7, 15);
    put(x, __builtin_shufflevector(xy01, xy23, 0, 1, 8, 9, 4, 5, 12, 13));
    put(y, __builtin_shufflevector(xy01, xy23, 2, 3, 10, 11, 6, 7, 14, 15));
    put(z, __builtin_shufflevector(zw01, zw23, 0, 1, 8, 9, 4, 5, 12, 13));
    if (w) put(w, __builtin_shufflevector(zw01, zw23, 2, 3, 10, 11, 6, 7, 14, 15));
  } else {
    Group xy02, xy13, zw02, zw13;
    both(xy02, 0, 2, 0);
    both(xy13, 1, 3, 0);
    both(zw02, 0, 2, 2);
    both(zw13, 1, 3, 2);
    put(x, __builtin_shufflevector(xy02, xy13, 0, 4, 2, 6));
    put(y, __builtin_shufflevector(xy02, xy13, 1, 5, 3, 7));
    put(z, __builtin_shufflevector(zw02, zw13, 0, 4, 2, 6));
    if (w) put(w, __builtin_shufflevector(zw02, zw13, 1, 5, 3, 7));
  }
#else
  for (int k = 0; k < GROUP<Lane>; k++) {
    const Lane *r = record(k);
    x[k] = r[0];
    y[k] = r[1];
    z[k] = r[2];
    if (w) std::memcpy(w + k, r + 3, sizeof(Lane));
  }
#endif
}

// A record of four doubles, whole: one load, one sum, one store.  Rows are combined as they lie,
// and only what a loop over lanes needs of them is turned into columns.

typedef double Row __attribute__((vector_size(32), aligned(8), may_alias));

// columns of four rows

SPHCLOTH_INLINE void to_columns(const Row *rows, double *x, double *y, double *z, double *w)
{
#ifdef SPHCLOTH_SHUFFLES
  const auto put = [](double *column, const Row &r) { *reinterpret_cast<Row *>(column) = r; };
  const Row xy02 = __builtin_shufflevector(rows[0], rows[2], 0, 1, 4, 5);
  const Row xy13 = __builtin_shufflevector(rows[1], rows[3], 0, 1, 4, 5);
  const Row zw02 = __builtin_shufflevector(rows[0], rows[2], 2, 3, 6, 7);
  const Row zw13 = __builtin_shufflevector(rows[1], rows[3], 2, 3, 6, 7);
  put(x, __builtin_shufflevector(xy02, xy13, 0, 4, 2, 6));
  put(y, __builtin_shufflevector(xy02, xy13, 1, 5, 3, 7));
  put(z, __builtin_shufflevector(zw02, zw13, 0, 4, 2, 6));
  put(w, __builtin_shufflevector(zw02, zw13, 1, 5, 3, 7));
#else
  for (int k = 0; k < 4; k++) {
    x[k] = rows[k][0];
    y[k] = rows[k][1];
    z[k] = rows[k][2];
    w[k] = rows[k][3];
  }
#endif
}

// The way back, with 0 in the last lane

SPHCLOTH_INLINE void to_rows(const double *x, const double *y, const double *z, Row *rows)
{
#ifdef SPHCLOTH_SHUFFLES
  const auto get = [](Row &r, const double *column) { r = *reinterpret_cast<const Row *>(column); };
  Row cx, cy, cz;
  get(cx, x);
  get(cy, y);
  get(cz, z);
  const Row none{};
  const Row xy02 = __builtin_shufflevector(cx, cy, 0, 4, 2, 6);
  const Row xy13 = __builtin_shufflevector(cx, cy, 1, 5, 3, 7);
  const Row zw02 = __builtin_shufflevector(cz, none, 0, 4, 2, 6);
  const Row zw13 = __builtin_shufflevector(cz, none, 1, 5, 3, 7);
  rows[0] = __builtin_shufflevector(xy02, zw02, 0, 1, 4, 5);
  rows[1] = __builtin_shufflevector(xy13, zw13, 0, 1, 4, 5);
  rows[2] = __builtin_shufflevector(xy02, zw02, 2, 3, 6, 7);
  rows[3] = __builtin_shufflevector(xy13, zw13, 2, 3, 6, 7);
#else
  for (int k = 0; k < 4; k++) rows[k] = Row{x[k], y[k], z[k], 0.0};
#endif
}

// the first three lanes of one row, the last lane of another

SPHCLOTH_INLINE void take_last(Row &row, const Row &last)
{
#ifdef SPHCLOTH_SHUFFLES
  row = __builtin_shufflevector(row, last, 0, 1, 2, 7);
#else
  row[3] = last[3];
#endif
}

// Compaction: of n pairs (key, index) keeps those with key < limit, in order; returns how many.
// Up to 16 places past the end are read from the input and written to the output.  Keys may be
// compacted in place.

inline int compact_plain(const float *key, const int *index, int n, float limit, float *key_out,
                         int *index_out)
{
  int m = 0;
  for (int k = 0; k < n; k++) {
    const float x = key[k];
    index_out[m] = index[k];
    key_out[m] = x;
    m += x < limit;    // a coin toss that no branch predictor wins
  }
  return m;
}

// Partition: the same as compaction, but the indices stay in place, those kept in front and the
// others, for which `spare` has room, behind them.  Nothing behind index[n - 1] is written.

// the pairs from `k` on, of which m are in front by now
inline int partition_rest(float *key, int *index, int k, int n, float limit, int *spare, int m)
{
  for (; k < n; k++) {
    const float x = key[k];
    const int j = index[k];
    spare[k - m] = j;
    index[m] = j;
    key[m] = x;
    m += x < limit;
  }
  std::memcpy(index + m, spare, (n - m) * sizeof(int));
  return m;
}

inline int partition_plain(float *key, int *index, int n, float limit, int *spare)
{
  return partition_rest(key, index, 0, n, limit, spare, 0);
}

#ifdef SPHCLOTH_X86_TARGETS

inline __mmask16 first_lanes(int n)
{
  return static_cast<__mmask16>(n >= 16 ? 0xffffU : (1U << n) - 1U);
}

__attribute__((target("avx512f,avx512vl"))) inline void append_avx512(const int *from, int n,
                                                                      int *to)
{
  for (int k = 0; k < n; k += 16) {
    const __mmask16 here = first_lanes(n - k);
    _mm512_mask_storeu_epi32(to + k, here, _mm512_loadu_si512(from + k));
  }
}

__attribute__((target("avx512f,avx512vl"))) inline int
partition_avx512(float *key, int *index, int n, float limit, int *spare)
{
  int m = 0;
  for (int k = 0; k < n; k += 16) {
    const __mmask16 here = first_lanes(n - k);
    const __m512 x = _mm512_loadu_ps(key + k);
    const __m512i j = _mm512_maskz_loadu_epi32(here, index + k);
    const __mmask16 keep = _mm512_mask_cmp_ps_mask(here, x, _mm512_set1_ps(limit), _CMP_LT_OQ);
    const int kept = __builtin_popcount(keep);
    _mm512_storeu_ps(key + m, _mm512_maskz_compress_ps(keep, x));
    _mm512_storeu_si512(spare + k - m, _mm512_maskz_compress_epi32(here & ~keep, j));
    _mm512_mask_storeu_epi32(index + m, first_lanes(kept), _mm512_maskz_compress_epi32(keep, j));
    m += kept;
  }
  append_avx512(spare, n - m, index + m);
  return m;
}

__attribute__((target("avx512f,avx512vl"))) inline int compact_avx512(const float *key,
                                                                      const int *index, int n,
                                                                      float limit, float *key_out,
                                                                      int *index_out)
{
  int m = 0;
  for (int k = 0; k < n; k += 16) {
    const __mmask16 here = first_lanes(n - k);
    const __m512 x = _mm512_loadu_ps(key + k);
    const __m512i j = _mm512_loadu_si512(index + k);
    const __mmask16 keep = _mm512_mask_cmp_ps_mask(here, x, _mm512_set1_ps(limit), _CMP_LT_OQ);
    // a compressing store to memory is slow on some CPUs
    _mm512_storeu_ps(key_out + m, _mm512_maskz_compress_ps(keep, x));
    _mm512_storeu_si512(index_out + m, _mm512_maskz_compress_epi32(keep, j));
    m += __builtin_popcount(keep);
  }
  return m;
}

// Without AVX-512 eight at a time, from a table: for each set of eight lanes
// those that are in it, in order.

struct LaneSets {
  alignas(64) std::int32_t of[256][8];
  constexpr LaneSets() : of{}
  {
    for (int set = 0; set < 256; set++)
      for (int lane = 0, m = 0; lane < 8; lane++)
        if (set >> lane & 1) of[set][m++] = lane;
  }
};
inline constexpr LaneSets LANE_SETS;

__attribute__((target("avx2,popcnt"))) inline int
compact_avx2(const float *key, const int *index, int n, float limit, float *key_out, int *index_out)
{
  int m = 0;
  for (int k = 0; k < n; k += 8) {
    const int here = n - k >= 8 ? 0xff : (1 << (n - k)) - 1;
    const __m256 x = _mm256_loadu_ps(key + k);
    const __m256i j = _mm256_loadu_si256(reinterpret_cast<const __m256i *>(index + k));
    const int keep = _mm256_movemask_ps(_mm256_cmp_ps(x, _mm256_set1_ps(limit), _CMP_LT_OQ)) & here;
    const __m256i kept = _mm256_load_si256(reinterpret_cast<const __m256i *>(LANE_SETS.of[keep]));
    _mm256_storeu_ps(key_out + m, _mm256_permutevar8x32_ps(x, kept));
    _mm256_storeu_si256(reinterpret_cast<__m256i *>(index_out + m),
                        _mm256_permutevar8x32_epi32(j, kept));
    m += __builtin_popcount(keep);
  }
  return m;
}

__attribute__((target("avx2,popcnt"))) inline int partition_avx2(float *key, int *index, int n,
                                                                 float limit, int *spare)
{
  int m = 0, k = 0;
  for (; k + 8 <= n; k += 8) {
    const __m256 x = _mm256_loadu_ps(key + k);
    const __m256i j = _mm256_loadu_si256(reinterpret_cast<const __m256i *>(index + k));
    const int keep = _mm256_movemask_ps(_mm256_cmp_ps(x, _mm256_set1_ps(limit), _CMP_LT_OQ));
    const __m256i kept = _mm256_load_si256(reinterpret_cast<const __m256i *>(LANE_SETS.of[keep])),
                  others = _mm256_load_si256(
                      reinterpret_cast<const __m256i *>(LANE_SETS.of[keep ^ 0xff]));
    _mm256_storeu_ps(key + m, _mm256_permutevar8x32_ps(x, kept));
    _mm256_storeu_si256(reinterpret_cast<__m256i *>(spare + k - m),
                        _mm256_permutevar8x32_epi32(j, others));
    _mm256_storeu_si256(reinterpret_cast<__m256i *>(index + m),
                        _mm256_permutevar8x32_epi32(j, kept));
    m += __builtin_popcount(keep);
  }
  return partition_rest(key, index, k, n, limit, spare, m);
}

inline const bool HAVE_AVX512 =
    __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl");
inline const bool HAVE_AVX2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt");

inline int compact(const float *key, const int *index, int n, float limit, float *key_out,
                   int *index_out)
{
  if (HAVE_AVX512) return compact_avx512(key, index, n, limit, key_out, index_out);
  if (HAVE_AVX2) return compact_avx2(key, index, n, limit, key_out, index_out);
  return compact_plain(key, index, n, limit, key_out, index_out);
}

inline int partition(float *key, int *index, int n, float limit, int *spare)
{
  if (HAVE_AVX512) return partition_avx512(key, index, n, limit, spare);
  if (HAVE_AVX2) return partition_avx2(key, index, n, limit, spare);
  return partition_plain(key, index, n, limit, spare);
}

#else

inline int partition(float *key, int *index, int n, float limit, int *spare)
{
  return partition_plain(key, index, n, limit, spare);
}

inline int compact(const float *key, const int *index, int n, float limit, float *key_out,
                   int *index_out)
{
  return compact_plain(key, index, n, limit, key_out, index_out);
}

#endif

}    // namespace sphcloth

#endif
