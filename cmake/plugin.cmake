# sphclothplugin.so: every style of src/USER-SPHCLOTH behind LAMMPS's plugin interface.

file(GLOB_RECURSE _styles CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/USER-SPHCLOTH/*.cpp")
list(FILTER _styles EXCLUDE REGEX "/USER-SPHCLOTH/core/")
add_library(sphclothplugin MODULE src/plugin/sphclothplugin.cpp ${_styles})
set_target_properties(sphclothplugin PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden)
target_link_libraries(sphclothplugin PRIVATE sphcloth::core lammps_headers sphcloth_checks)
if(LAMMPS_VERSION LESS 20250722)
  # LAMMPS knows of no run styles in plugins: it closes the library before it deletes the run style
  target_link_options(sphclothplugin PRIVATE -Wl,-z,nodelete)
endif()
if(SPHCLOTH_GUIDE)
  target_sources(sphclothplugin PRIVATE src/plugin/branch_counts.cpp)
  target_compile_options(sphclothplugin PRIVATE -fsanitize-coverage=trace-pc -O1)
endif()
