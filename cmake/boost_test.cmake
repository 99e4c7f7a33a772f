# Boost::unit_test_framework, from the wheel cmeel-boost where that is installed, otherwise from the
# system, and add_cases(), which makes CTest know each case of a program by its name.

find_package(Python REQUIRED COMPONENTS Interpreter)
execute_process(
  COMMAND "${Python_EXECUTABLE}" "${CMAKE_CURRENT_LIST_DIR}/locate.py" boost
  OUTPUT_VARIABLE _boost OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE _missing)
if(NOT _missing)
  list(APPEND CMAKE_PREFIX_PATH "${_boost}")
endif()
find_package(Boost 1.74 REQUIRED CONFIG COMPONENTS unit_test_framework)

# A case SUITE/CASE of PROGRAM is the test PREFIXSUITE/CASE.  The program itself tells what it has,
# whenever it has been built, so that no case can be left out.
function(add_cases program prefix)
  set(_tests "${CMAKE_CURRENT_BINARY_DIR}/${program}_cases.cmake")
  add_custom_command(TARGET ${program} POST_BUILD
    COMMAND "${CMAKE_COMMAND}" "-DPROGRAM=$<TARGET_FILE:${program}>" "-DPREFIX=${prefix}"
      "-DEMULATOR=${CMAKE_CROSSCOMPILING_EMULATOR}" "-DTESTS=${_tests}" -P "${SPHCLOTH_ROOT}/cmake/list_cases.cmake"
    VERBATIM)
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${_tests}")
endfunction()
