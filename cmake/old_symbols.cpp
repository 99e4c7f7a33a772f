// SPDX-License-Identifier: GPL-2.0-or-later
// What libstdc++ 11 added and code compiled with it calls; see old_symbols.h.  LAMMPS may run with an
// older libstdc++.

#include <new>

namespace std {

__attribute__((visibility("hidden"), noreturn)) void __throw_bad_array_new_length();
void __throw_bad_array_new_length() { throw bad_array_new_length(); }

}    // namespace std
