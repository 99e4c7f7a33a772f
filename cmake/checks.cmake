# sphcloth_checks: what a developer may ask of the compiler.  Warnings are always on, they cost users
# nothing; the rest is off unless asked for.

include_guard()
option(SPHCLOTH_SANITIZE "find bad addresses and undefined behavior while running" OFF)
option(SPHCLOTH_COVERAGE "count which lines run" OFF)
option(SPHCLOTH_GUIDE "count which branches of the styles run, for a fuzzer to follow" OFF)
option(SPHCLOTH_QUICK_BUILD "compile in a fraction of the time what runs slower, for one CPU" OFF)

add_library(sphcloth_checks INTERFACE)
target_compile_options(sphcloth_checks INTERFACE -Wall -Wextra -Wshadow -Wconversion)
if(SPHCLOTH_SANITIZE)
  # null pointers are bad addresses too, and what need not be aligned says so in its type: left out,
  # they make the loops over neighbors compile five times as long
  set(_sanitizers -fsanitize=address,undefined,float-cast-overflow -fno-sanitize=null,alignment
    -fno-sanitize-recover=undefined)
  target_compile_options(sphcloth_checks INTERFACE ${_sanitizers} -O1 -g1 -fno-omit-frame-pointer)
  target_compile_definitions(sphcloth_checks INTERFACE _GLIBCXX_ASSERTIONS)
  target_link_options(sphcloth_checks INTERFACE ${_sanitizers})
endif()
if(SPHCLOTH_COVERAGE)
  target_compile_options(sphcloth_checks INTERFACE --coverage -O1)
  target_link_options(sphcloth_checks INTERFACE --coverage)
endif()
if(SPHCLOTH_QUICK_BUILD)
  target_compile_options(sphcloth_checks INTERFACE -O1)
endif()
