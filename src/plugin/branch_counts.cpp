// SPDX-License-Identifier: GPL-2.0-or-later
/* How often each branch of the styles ran, for a fuzzer to follow; only with -DSPHCLOTH_GUIDE=ON.
   The compiler calls the function below at each branch. */

#include <cstdint>

extern "C" {

/// Counts, by the place of the branch in the code; two of them may share one.
__attribute__((visibility("default"))) unsigned char sphcloth_branch_counts[1 << 16];

__attribute__((no_sanitize_coverage)) void __sanitizer_cov_trace_pc()
{
  // the same in every process: where the code lies is not, how far it lies from the counts is
  const auto offset = reinterpret_cast<std::uintptr_t>(__builtin_return_address(0)) -
      reinterpret_cast<std::uintptr_t>(sphcloth_branch_counts);
  const auto mixed = static_cast<std::uint32_t>(offset) * 2654435761u;
  ++sphcloth_branch_counts[mixed >> 16];
}
}
