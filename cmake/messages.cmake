# sphclothmessages.so: counts what a program sends through MPI, for `sphcloth bench messages`.

add_library(sphclothmessages MODULE src/messages/messages.cpp)
set_target_properties(sphclothmessages PROPERTIES PREFIX "")
target_link_libraries(sphclothmessages PRIVATE lammps_headers)
