# sphcloth::core: numerics without LAMMPS; the loops over neighbors are compiled once per kernel.

include("${CMAKE_CURRENT_LIST_DIR}/checks.cmake")
file(GLOB_RECURSE _core CONFIGURE_DEPENDS "${CMAKE_CURRENT_LIST_DIR}/../src/USER-SPHCLOTH/core/*.cpp")
add_library(sphcloth_core STATIC ${_core})
add_library(sphcloth::core ALIAS sphcloth_core)
set_target_properties(sphcloth_core PROPERTIES POSITION_INDEPENDENT_CODE ON
  CXX_VISIBILITY_PRESET hidden)
target_compile_features(sphcloth_core PUBLIC cxx_std_17)
target_include_directories(sphcloth_core PUBLIC "${CMAKE_CURRENT_LIST_DIR}/../src/USER-SPHCLOTH")
target_link_libraries(sphcloth_core PUBLIC Eigen3::Eigen)
target_link_libraries(sphcloth_core PRIVATE sphcloth_checks)
option(SPHCLOTH_SINGLE_TARGET "compile for the oldest CPU alone: builds faster, runs slower" OFF)
if(SPHCLOTH_SINGLE_TARGET OR SPHCLOTH_QUICK_BUILD OR SPHCLOTH_SANITIZE OR SPHCLOTH_COVERAGE OR SPHCLOTH_GUIDE)
  # loops compiled for several CPUs take minutes, above all with checks in them
  target_compile_definitions(sphcloth_core PUBLIC SPHCLOTH_SINGLE_TARGET)
endif()
option(SPHCLOTH_OLD_SYMBOLS "call only what the C and C++ libraries of manylinux_2_28 have" OFF)
if(SPHCLOTH_OLD_SYMBOLS)
  target_compile_options(sphcloth_core PUBLIC
    "SHELL:-include ${CMAKE_CURRENT_LIST_DIR}/old_symbols.h")
  target_sources(sphcloth_core PRIVATE "${CMAKE_CURRENT_LIST_DIR}/old_symbols.cpp")
endif()
# Vectors without a second OpenMP runtime; errno and trapping semantics would keep square roots
# and branches out of vectors.  Results stay IEEE: no reassociation beyond `omp simd reduction`.
target_compile_options(sphcloth_core PUBLIC
  -fopenmp-simd -fno-math-errno -fno-trapping-math)
