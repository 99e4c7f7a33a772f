// SPDX-License-Identifier: GPL-2.0-or-later
// What libstdc++ 11 and the C library 2.32 added, and code compiled with them uses; see old_symbols.h.
// LAMMPS may run with older ones.

#include <new>

// Strings of the old ABI count their owners, atomically unless this is true.
extern "C" __attribute__((visibility("hidden"))) char __libc_single_threaded;
char __libc_single_threaded = 0;

namespace std {

__attribute__((visibility("hidden"), noreturn)) void __throw_bad_array_new_length();
void __throw_bad_array_new_length() { throw bad_array_new_length(); }

}    // namespace std
