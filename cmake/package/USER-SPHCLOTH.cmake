# The package USER-SPHCLOTH inside LAMMPS's own CMake, as cmake/Modules/Packages/USER-SPHCLOTH.cmake of
# its source tree: what the package needs beyond the sources at the top of its folder, which LAMMPS finds
# by itself.  -D Eigen3_DIR=... or -D CMAKE_PREFIX_PATH=... where Eigen is not in a usual place.

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
target_link_libraries(lammps PRIVATE Eigen3::Eigen)

set(_sphcloth "${LAMMPS_SOURCE_DIR}/USER-SPHCLOTH")
file(GLOB_RECURSE _sphcloth_all CONFIGURE_DEPENDS "${_sphcloth}/*.cpp")
set(_sphcloth_below ${_sphcloth_all})
list(FILTER _sphcloth_below EXCLUDE REGEX "/USER-SPHCLOTH/[^/]*[.]cpp$")
target_sources(lammps PRIVATE ${_sphcloth_below})

# headers of styles are included by LAMMPS's own sources
target_compile_definitions(lammps PRIVATE SPHCLOTH_LAMMPS_VERSION=${PROJECT_VERSION})
option(SPHCLOTH_SINGLE_TARGET "compile for the oldest CPU alone: builds faster, runs slower" OFF)
if(SPHCLOTH_SINGLE_TARGET)
  target_compile_definitions(lammps PRIVATE SPHCLOTH_SINGLE_TARGET)
endif()
# see cmake/core.cmake of SPHCLOTH
set_property(SOURCE ${_sphcloth_all} APPEND PROPERTY
  COMPILE_OPTIONS -fopenmp-simd -fno-math-errno -fno-trapping-math)
