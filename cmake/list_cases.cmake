# cmake -DPROGRAM=... -DPREFIX=... -DEMULATOR=... -DTESTS=FILE -P list_cases.cmake: writes what CTest
# includes, one test for each case of a program of Boost.Test, which EMULATOR runs if not empty.

execute_process(COMMAND ${EMULATOR} "${PROGRAM}" --list_content=HRF
  OUTPUT_VARIABLE _out ERROR_VARIABLE _content RESULT_VARIABLE _failed)
if(_failed)
  message(FATAL_ERROR "${PROGRAM} does not list its cases: ${_out}${_content}")
endif()
string(REPLACE "\n" ";" _lines "${_content}")
set(_tests "")
foreach(_line IN LISTS _lines)
  if(_line MATCHES "^([A-Za-z0-9_]+)")
    set(_suite "${CMAKE_MATCH_1}")
  elseif(_line MATCHES "^    ([A-Za-z0-9_]+)")
    set(_case "${_suite}/${CMAKE_MATCH_1}")
    string(APPEND _tests
      "add_test([==[${PREFIX}${_case}]==] ${EMULATOR} [==[${PROGRAM}]==] --run_test=${_case} --color_output=no"
      " --catch_system_errors=no)\n")
  endif()
endforeach()
if(NOT _tests)
  message(FATAL_ERROR "${PROGRAM} has no cases")
endif()
file(WRITE "${TESTS}" "${_tests}")
