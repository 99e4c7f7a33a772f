# Eigen3::Eigen, from the wheel cmeel-eigen where that is installed, otherwise from the system.

find_package(Python REQUIRED COMPONENTS Interpreter)
execute_process(
  COMMAND "${Python_EXECUTABLE}" "${CMAKE_CURRENT_LIST_DIR}/locate.py" eigen
  OUTPUT_VARIABLE _eigen OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE _missing)
if(NOT _missing)
  list(APPEND CMAKE_PREFIX_PATH "${_eigen}")
endif()
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
