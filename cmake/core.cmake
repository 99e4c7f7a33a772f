# sphcloth::core: numerics without LAMMPS; the loops over neighbors are compiled once per kernel.
#
# With LAMMPS_CXX11_ABI its strings are those of that LAMMPS.  Each ABI has objects of its own, so that
# a build folder that makes plugins for several releases compiles them once per ABI.

include("${CMAKE_CURRENT_LIST_DIR}/checks.cmake")
file(GLOB_RECURSE _numerics CONFIGURE_DEPENDS "${CMAKE_CURRENT_LIST_DIR}/../src/USER-SPHCLOTH/core/*.cpp")
set(_core sphcloth_core)
if(NOT "${LAMMPS_CXX11_ABI}" STREQUAL "")
  set(_core sphcloth_core_abi${LAMMPS_CXX11_ABI})
endif()
add_library(${_core} STATIC ${_numerics})
add_library(sphcloth::core ALIAS ${_core})
set_target_properties(${_core} PROPERTIES POSITION_INDEPENDENT_CODE ON
  CXX_VISIBILITY_PRESET hidden)
target_compile_features(${_core} PUBLIC cxx_std_17)
target_include_directories(${_core} PUBLIC "${CMAKE_CURRENT_LIST_DIR}/../src/USER-SPHCLOTH")
target_link_libraries(${_core} PUBLIC Eigen3::Eigen)
target_link_libraries(${_core} PRIVATE sphcloth_checks)
if(NOT "${LAMMPS_CXX11_ABI}" STREQUAL "")
  target_compile_definitions(${_core} PUBLIC _GLIBCXX_USE_CXX11_ABI=${LAMMPS_CXX11_ABI})
endif()
option(SPHCLOTH_SINGLE_TARGET "compile for the oldest CPU alone: builds faster, runs slower" OFF)
if(SPHCLOTH_SINGLE_TARGET OR SPHCLOTH_QUICK_BUILD OR SPHCLOTH_SANITIZE OR SPHCLOTH_COVERAGE OR SPHCLOTH_GUIDE)
  # loops compiled for several CPUs take minutes, above all with checks in them
  target_compile_definitions(${_core} PUBLIC SPHCLOTH_SINGLE_TARGET)
endif()
option(SPHCLOTH_OLD_SYMBOLS "call only what the C and C++ libraries of manylinux_2_28 have" OFF)
if(SPHCLOTH_OLD_SYMBOLS)
  target_compile_options(${_core} PUBLIC
    "SHELL:-include ${CMAKE_CURRENT_LIST_DIR}/old_symbols.h")
  target_sources(${_core} PRIVATE "${CMAKE_CURRENT_LIST_DIR}/old_symbols.cpp")
endif()
# Vectors without a second OpenMP runtime; errno and trapping semantics would keep square roots
# and branches out of vectors.  Results stay IEEE: no reassociation beyond `omp simd reduction`.
target_compile_options(${_core} PUBLIC
  -fopenmp-simd -fno-math-errno -fno-trapping-math)
